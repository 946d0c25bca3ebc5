"""Rules of bearing sheets, heat, stability and response: of machines at rest."""

from __future__ import annotations

from collections.abc import Iterator

from frbcli.case.bearing import FloatingRingBearing
from frbcli.case.schema import Case
from frbcli.elements.pin import PinElement, has_pins
from frbcli.errors import Fault
from frbcli.film.cavitation.table import law_named
from frbcli.scene.channels import coupled
from frbcli.scene.films import HOUSING, FilmPlace, film_places, is_plain
from frbcli.scene.keys import bearing_key, cavitation_keys
from frbcli.scene.speeds import default_speeds, keeps_oil
from frbcli.scene.tilt import as_text


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
    for index, bearing in enumerate(case.bearings):
        if isinstance(bearing, FloatingRingBearing) and coupled(bearing):
            problem = "couples the two films of a ring: neither has coefficients of its own."
            key = f"{bearing_key(case, index)}.channels"
            yield Fault(key, "coupled", None, problem, 'Write channels = "pressure" here.')
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
        elif law.keeps_oil and any(_opens_in_turning(place) for place in film_places(case)):
            problem = "conserves the mass of the oil in a film whose openings turn, so that the oil is never at rest."
            remedy = "Supply it by a circumferential groove or by openings in the shell, or take half-sommerfeld."
            yield Fault(key, name, None, problem, remedy)


def _opens_in_turning(place: FilmPlace) -> bool:
    """Whether a film has openings in a body that turns."""
    return place.feed_holes is not None or (not is_plain(place.geometry) and place.grid_body != HOUSING)


def still_ring_faults(case: Case) -> Iterator[Fault]:
    """Rings that do not turn and are loaded rest nowhere: between them and the housing nothing turns that carries."""
    problem = "keeps the ring from turning; its outer film then carries no weight, and the ring rests on its shell."
    remedy = 'Write spin = "free".'
    if case.given_rotor is None or case.rotor.gravity <= 0.0:
        return
    for index, bearing in enumerate(case.bearings):
        if isinstance(bearing, FloatingRingBearing) and bearing.ring.spin == "blocked":
            yield Fault(f"{bearing_key(case, index)}.ring.spin", "blocked", None, problem, remedy)


def pin_faults(case: Case) -> Iterator[Fault]:
    """A ring at its pin neither turns with the balance of its torques nor is it held without a spring."""
    problem = "holds a ring that turns within its play: no position of rest is found with it."
    remedy = 'Take a run, which follows it; or remove it and write ring.spin = "blocked".'
    for each in PinElement.of(case):
        yield Fault(each.key, "", None, problem, remedy)


def pinned_start_faults(case: Case) -> Iterator[Fault]:
    """A run does not begin at rest with a pin."""
    if case.start.position == "resting" and has_pins(case):
        problem = "is not known of a ring with a pin."
        yield Fault("start.position", "resting", None, problem, 'Write "centre", or remove the pin.')


def loaded_heat_faults(case: Case) -> Iterator[Fault]:
    """Heat belongs to the load of a rotor."""
    if case.heat is not None:
        problem = "needs the load of a [rotor], and takes no other."
        remedy = 'Leave --load out and add [rotor] and [speed], or write thermal.model = "none".'
        yield Fault("thermal.model", "lumped", None, problem, remedy)


def chart_heat_faults(case: Case) -> Iterator[Fault]:
    """Heat belongs to the load of a rotor, not to an eccentricity."""
    if case.heat is not None:
        remedy = 'Choose --over speed, or write thermal.model = "none": films then have oil.temperature.'
        problem = "is not modelled over eccentricity: the temperatures belong to the load of the rotor."
        yield Fault("thermal.model", "lumped", None, problem, remedy)


def missing_heat_faults(case: Case) -> Iterator[Fault]:
    """The fault of a case whose static results need heat that it has not."""
    if case.heat is None:
        yield Fault("thermal", "", None, "is missing.", 'Add the table [thermal] with model = "lumped".')


def range_faults(case: Case) -> Iterator[Fault]:
    """A machine at rest turns forwards."""
    if not default_speeds(case):
        remedy = 'Write e.g. speed.to = "300 Hz", or ask for a speed, "25 Hz".'
        yield Fault("speed.to", f"{case.speed.end:g} Hz", None, "leaves no speed above zero.", remedy)
