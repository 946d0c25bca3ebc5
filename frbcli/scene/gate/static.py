"""Rules of machines at rest: bearing sheets, heat, stability and response; of limit cycles, and of whirls with the
unbalance."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from frbcli.case.film import FilmGeometry
from frbcli.case.schema import Case
from frbcli.elements.pin import PinElement
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.film.pad_geometry import LAWS
from frbcli.scene.coupling import coupling_of
from frbcli.scene.course import default_speeds, keeps_oil
from frbcli.scene.films import (
    HOUSING,
    FilmPlace,
    as_text,
    cavitation_keys,
    coupled_rings,
    coupling_faults,
    film_places,
    is_plain,
    turning_cartridges,
    turns_with_oil,
)
from frbcli.scene.machine.rotor import (
    element_parts,
    harmonics_of,
    port_faults,
    speed_dependent,
    without_film,
)
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.scene.planning.film_choice import all_clipped, form_of
from frbcli.units import display


def sheet_faults(case: Case) -> Iterator[Fault]:
    """Films whose loads are not known."""
    if case.given_rotor is None and len(film_places(case)) != 1:
        problem = "has more than one film; the loads of several films follow from a rotor, which is missing."
        yield Fault("bearing", f"{len(film_places(case))} films", None, problem, "Add [rotor] and [speed].")


def tilted_sheet_faults(case: Case) -> Iterator[Fault]:
    """A sheet is of a journal that is parallel to its shell, whatever [motion] says."""
    for key in ("tilt", "tilt_rate"):
        given = getattr(case.motion, key, None)
        if given is not None and any(given):
            problem = "is of a rotation: the films of a sheet have one gap along the axis."
            yield Fault(f"motion.{key}", as_text(given), None, problem, "Leave it out here; frb rotation follows it.")


def coefficient_faults(case: Case) -> Iterator[Fault]:
    """Films that eight coefficients do not describe."""
    problem = "couples the two films of a ring: neither has coefficients of its own."
    yield from coupling_faults(case, problem, 'Write channels = "pressure" here.')
    if keeps_oil(case):
        yield from _memory_faults(case)


def _memory_faults(case: Case) -> Iterator[Fault]:
    """Films that keep oil and are not at rest in any frame, or whose oil cannot be linearised."""
    for key, name in dict(cavitation_keys(case)).items():
        law = law_named(name)
        if law.keeps_oil and law.clips:
            problem = (
                "clips the pressures of its forces and keeps oil: forces do not follow from the pressures of cells."
            )
            yield Fault(key, name, None, problem, "Take a law that does not clip.")
        elif law.keeps_oil and any(
            place.feed_holes is not None or (not is_plain(place.geometry) and place.grid_body != HOUSING)
            for place in film_places(case)
        ):
            problem = "conserves the mass of the oil in a film whose openings turn, so that the oil is never at rest."
            remedy = "Supply it by a circumferential groove or by openings in the shell, or take half-sommerfeld."
            yield Fault(key, name, None, problem, remedy)


ELASTIC_SHELL = 'let its shell give way, contact = {policy = "elastic", stiffness = "1e8 N/m"}, on which it rests'


def held_ring_faults(case: Case) -> Iterator[Fault]:
    """Between a ring that does not turn and the housing there is no wedge: the film carries no weight. The ring rests
    where it touches, on a shell that gives way or on the summits of rough surfaces."""
    sinks = "its outer film has no wedge and carries no weight, and the ring sinks until it touches its shell."
    for held in _held_rings(case) if not case.contact.gives_way else ():
        problem = f"{held.what}: {sinks}"
        yield Fault(held.key, held.value, None, problem, f"{held.remedy}, or {ELASTIC_SHELL}.")


def held_film_faults(case: Case) -> Iterator[Fault]:
    """The film between a ring that does not turn and its shell has no coefficients where it cavitates at once, and no
    static equilibrium where it is mass-conserving."""
    for held in _held_rings(case):
        for film in held.outer:
            law = law_named(case.cavitation(film))
            if law.keeps_oil:
                problem = (
                    f"{held.what}, and {law.name} conserves the mass of the oil in its outer film: there it lies as "
                    "the motion before has left it, and no rest is the only one."
                )
                yield Fault(held.key, held.value, None, problem, f"{held.remedy}, or take a law without memory there.")
            elif law.cavitates and not _is_full(case, film):
                problem = (
                    f"{held.what}, and its outer film cavitates as soon as it moves. It has no linear damping then."
                )
                remedy = f'{held.remedy}, or feed the film above oil.cavitation_pressure, or write "sommerfeld".'
                yield Fault(held.key, held.value, None, problem, remedy)


def held_cycle_faults(case: Case) -> Iterator[Fault]:
    """Limit cycles are followed within the gaps of all films."""
    problem = "its outer film carries no weight, the ring rests on its shell, and limit cycles stay within the gaps."
    for held in _held_rings(case):
        yield Fault(held.key, held.value, None, f"{held.what}: {problem}", f"{held.remedy}, or take a run-up.")


@dataclass(frozen=True)
class _HeldRing:
    """A ring under its weight that does not turn. key, value: what holds it, and what it does, in words; remedy: how it
    turns; outer: films between it and its shells."""

    key: str
    value: str
    what: str
    remedy: str
    outer: tuple[FilmGeometry, ...]


def _held_rings(case: Case) -> Iterator[_HeldRing]:
    if case.given_rotor is None or case.rotor.gravity <= 0.0:
        return
    for key, given in zip(case.given_keys, case.given_bearings, strict=True):
        around = [part for part in given.parts if part.kind == "floating-ring"]
        outer = tuple(part.outer for part in around)
        if around and around[0].ring.spin == "blocked":
            what = "keeps the ring from turning"
            yield _HeldRing(f"{key}.ring.spin", "blocked", what, 'Write spin = "free"', outer)
        elif given.pin is not None:
            yield _HeldRing(f"{key}.pin", "", "holds the ring at rest", "Remove it", outer)


def _is_full(case: Case, film: FilmGeometry) -> bool:
    """Whether the pressure of a film at rest lies above that at which it cavitates, but at its ends."""
    ambient, supply = case.oil.ambient_pressure, film.supply
    fed = supply.absolute(ambient) if supply.feeds else ambient
    return ambient >= case.oil.cavitation_pressure and max(ambient, fed) > case.oil.cavitation_pressure


def pin_cycle_faults(case: Case) -> Iterator[Fault]:
    """A pin is a stop to one side."""
    for each in PinElement.of(case):
        problem = "pushes at its ring to one side alone: where the ring leaves it, the motion of a cycle has corners."
        yield Fault(each.key, "", None, problem, 'Take a run; or remove it and write ring.spin = "blocked".')


def port_coupling_faults(case: Case) -> Iterator[Fault]:
    """Forces that are not linear are solved with the rotor, until nothing is left over."""
    coupling = coupling_of(case)
    if coupling.in_turn or coupling.once:
        yield from port_faults(
            case, f'is not linear, and film.coupling = "{case.film.coupling}" solves no such force.',
            'Write film.coupling = "auto".',
        )  # fmt: skip


def lumped(case: Case) -> str | None:
    """The model of heat of a case, None without one, see refusal."""
    return None if case.heat is None else "lumped"


def range_faults(case: Case) -> Iterator[Fault]:
    """A machine at rest turns forwards."""
    if not default_speeds(case):
        remedy = 'Write e.g. speed.to = "300 Hz", or ask for a speed, "25 Hz".'
        yield Fault("speed.to", f"{case.speed.end:g} Hz", None, "leaves no speed above zero.", remedy)


CONSTANT = "these limit cycles are computed for one rotor with constant coefficients"
HEAT_REMEDY = 'Write thermal.model = "none", and as temperature of each film the one of frb check or frb stability.'


def given_coefficient_faults(case: Case) -> Iterator[Fault]:
    """Coefficients of bearings that depend on the speed are followed but by harmonic balance with heat."""
    if case.heat is not None and not by_shooting(case):
        yield from speed_dependent(case, CONSTANT)


def linear_faults(case: Case) -> Iterator[Fault]:
    """A machine has a film, or another force that is not linear."""
    if not element_parts(case).ports:
        yield from without_film(case, "a linear machine has no limit cycles")


def cartridge_faults(case: Case) -> Iterator[Fault]:
    """The gyroscopic moments of a cartridge go by its tilt, which its films see where their shells are fixed."""
    if case.housing is None or by_shooting(case):
        return
    for key in turning_cartridges(case):
        problem = (
            "turns a cartridge in a housing that moves: its films see its tilt against the housing, and its gyroscopic "
            "moments go by its own."
        )
        yield Fault(f"{key}.ring.spin", "free", None, problem, "Leave the housing out, or take a run-up.")


def cycle_heat_faults(case: Case) -> Iterator[Fault]:
    """Cycles over the speed have temperatures that stay over a period, of films whose force follows from the motion."""
    if case.heat is None:
        return
    if by_shooting(case):
        problem = "settles over many periods, and cycles of this case are found from one period of a run."
        yield Fault("thermal.model", "lumped", None, problem, HEAT_REMEDY)
    for key in ("clearance", "centrifugal_growth"):
        if getattr(case.heat, key) == "follows":
            problem = "changes the clearances over which the motions of a branch are measured."
            yield Fault(f"thermal.{key}", "follows", None, problem, 'Write "fixed".')


def turning_port_faults(case: Case) -> Iterator[Fault]:
    """Forces that follow the angle of the rotor: balls that pass shake the machine at their own frequency, and a cage
    turns by no rational share of the revolutions of the rotor, so that nothing repeats, with unbalance neither."""
    problem = (
        "follows the angle of the rotor: balls that pass shake it at the ball pass frequency, so that there is no "
        "limit cycle; with unbalance, no period holds both frequencies."
    )
    remedy = 'Write cage = "mean", the mean over the angles of the cage, or take a run.'
    yield from port_faults(case, problem, remedy, lambda law: law.turns)


def smooth_faults(case: Case) -> Iterator[Fault]:
    """Films whose force does not follow smoothly from the motion alone, and other forces that are not linear."""
    yield from port_faults(case, "is not linear.", "Go over the speed alone.")
    named = dict(cavitation_keys(case)) if form_of(case).solved else {}
    keeping = {key: name for key, name in named.items() if law_named(name).keeps_oil}
    if keeping:
        problem = "is mass-conserving: the force depends on the oil that the film keeps, not on the motion alone."
        remedy = "Take half-sommerfeld or penalty here, and a run-up for this model."
        yield from (Fault(key, name, None, problem, remedy) for key, name in keeping.items())
    elif form_of(case).by_cells and not turning_openings(case):
        problem = "is solved on cells, where the force has no continuous derivative."
        remedy = "Go over the speed alone, or take half-sommerfeld, with grooves or feed holes that turn only."
        yield from (Fault(key, name, None, problem, remedy) for key, name in named.items())


def speed_cycle_faults(case: Case) -> Iterator[Fault]:
    """Films whose map over a period is not the same at each start, since their openings turn."""
    yield from turning_port_faults(case)
    if not by_shooting(case):
        yield from smooth_faults(case)
    elif form_of(case).by_cells and any(
        place.feed_holes is not None or (not is_plain(place.geometry) and _turns(case, place))
        for place in film_places(case)
    ):
        problem = "has openings that turn: the force depends on their angle, and no whirl returns after one period."
        remedy = "Leave feed holes that turn out, or take a run-up."
        yield from (Fault(key, name, None, problem, remedy) for key, name in cavitation_keys(case))


def speed_range_faults(case: Case) -> Iterator[Fault]:
    """Cycles are followed over speeds above zero."""
    speeds = default_speeds(case)
    if not speeds or not speeds[-1] > speeds[0]:
        key, remedy = "speed.to", 'Write e.g. speed.to = "300 Hz".'
        if case.speed.end > 0.0:
            key, remedy = "speed.from", 'Write a lower one, e.g. speed.from = "0 Hz".'
        at = case.speed.start if key == "speed.from" else case.speed.end
        yield Fault(key, f"{at:g} Hz", None, "leaves no range of speeds above zero.", remedy)


def unbalance_faults(case: Case) -> Iterator[Fault]:
    """Whirls with unbalance need a rotor with unbalance."""
    if not drives(case):
        problem, remedy = "is zero: no whirl can lock in with it.", 'Write e.g. rotor.unbalance = "3 g*mm".'
        yield Fault("disk.unbalance" if case.disks else "rotor.unbalance", "0 g*mm", None, problem, remedy)


def drives(case: Case) -> list[str]:
    """What shakes the rotor of a case once or several times in a revolution, in words."""
    shaft = shaft_of(case)
    own = [name for name, size in (("unbalance", shaft.eccentricity), ("bow", shaft.bow)) if size != 0.0]
    return own + (["harmonic forces"] if harmonics_of(case) else [])


def by_shooting(case: Case) -> bool:
    """Whether limit cycles are found by shooting on the time loop: films are mass-conserving, or are on cells, where
    their force has kinks, or forces besides theirs are not linear."""
    kinked = form_of(case).by_cells and not turning_openings(case)
    return keeps_oil(case) or kinked or bool(element_parts(case).ports)


def turning_openings(case: Case) -> bool:
    """Whether finite-volume films are tabulated as the mean over the angle of their openings: their gaps are even along
    the axis, all solve a linear equation, and all openings turn."""
    if form_of(case).inclines or not all_clipped(case) or any(coupled_rings(case)):
        return False
    return all(
        is_plain(place.geometry) or (place.geometry.shell is None and place.grid_body != HOUSING)
        for place in film_places(case)
    )


def _turns(case: Case, place: FilmPlace) -> bool:
    return place.grid_body != HOUSING or turns_with_oil(case, place)


def require_thrust_sheet(case: Case, gaps: Sequence[float] = ()) -> None:
    """Raises InputError with every reason why thrust bearings of a case have no sheet at some gaps in m."""
    if reasons := [*_thrust_faults(case), *_beyond_play(case, gaps)]:
        raise case.refused(*reasons)


def _thrust_faults(case: Case) -> Iterator[Fault]:
    if not case.thrust_bearings:
        yield Fault("thrust_bearing", "", None, "is missing.", "Add a table [[thrust_bearing]]; see docs/thrust.md.")
    if case.film.cavitation not in LAWS:
        problem = "is not modelled in thrust bearings, whose pressure is found without oil fractions and history."
        remedy = f"Write film.cavitation = {' or '.join(LAWS)}; in converging pads they agree."
        yield Fault("film.cavitation", case.film.cavitation, None, problem, remedy)


def _beyond_play(case: Case, gaps: Sequence[float]) -> Iterator[Fault]:
    for bearing in case.thrust_bearings:
        play = bearing.end_play
        for gap in gaps if bearing.side == "both" and play is not None else ():
            if play is not None and gap >= play:
                problem = f"leaves no gap on the other side: the end play is {display(play, 'm')}."
                yield Fault("--gap", display(gap, "m"), None, problem, "Give a gap below it, up to half for a load.")
