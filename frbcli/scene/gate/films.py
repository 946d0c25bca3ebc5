"""Rules of films: supplies, openings and ends, whatever is asked of them; and rough surfaces.

Rules of squeeze film dampers and magnetic pulls.

The films of dampers carry by squeezing alone: at rest they carry nothing. Pulls are limited by what holds the rotor.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from frbcli.arrays import Array
from frbcli.case.film import FilmGeometry
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.case.surroundings import Damper
from frbcli.elements.forces import MagneticPullElement
from frbcli.elements.supports import DamperElement
from frbcli.errors import Fault
from frbcli.film.cavitation.barotropic import Barotropic
from frbcli.film.cavitation.law import FilmOil
from frbcli.film.cavitation.table import law_named
from frbcli.film.gap import NO_BATH, ends_at_ambient
from frbcli.film.section_faults import runs_dry, section_faults
from frbcli.rotor.assembly import LinearRotor
from frbcli.scene.coupling import coupling_of
from frbcli.scene.films import (
    HOUSING,
    FilmPlace,
    coupling_faults,
    film_keys,
    film_places,
    film_section,
    is_published,
    misaligned,
    tilt_key,
    tilts,
)
from frbcli.scene.forms import CLIPPED
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.planning.film_choice import film_form, form_of
from frbcli.scene.tilted import CELLS, INCLINED, TILTED
from frbcli.units import display

SMOOTH = 'Write contact.model = "spring"'
HENRY = 1e7  # Pa, saturation pressure
ENCLOSED = 0.01  # share of the flow of an open end below which the oil of a film that nothing feeds is enclosed in it


def supply_faults(case: Case) -> Iterator[Fault]:
    """Faults of each film without its neighbours: its supply, its openings, its ends."""
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        supply = place.geometry.supply
        if own := supply.faults(f"{key}.supply"):
            yield from own
            continue
        section = film_section(case, place.geometry, place.feed_holes)
        if not law_named(case.cavitation(place.geometry)).keeps_oil:  # it makes its oil, and cannot run dry
            section = ends_at_ambient(section)
        at, value = (f"{key}.supply.kind", supply.kind) if runs_dry(section) else (key, place.name)
        for fault in section_faults(section):
            yield Fault(at, value, None, f"cannot be solved: {fault.problem}.", fault.remedy)


def limited_supply_faults(case: Case) -> Iterator[Fault]:
    """Flow-limited supplies of films that do not support them."""
    for at, place in _limited_films(case):
        form, oil = form_of(case), case.oil
        supply, law = place.geometry.supply, law_named(case.cavitation(place.geometry))
        least = max(oil.ambient_pressure, oil.cavitation_pressure)
        if not (form.by_cells and form.follows_supply) or tilts(case) or any(True for _ in misaligned(case)):
            problem = "is given, which only finite-volume films without tilt support."
            remedy = 'Write film.cavitation = "elrod" and no tilt; or leave it out.'
        elif not law.keeps_oil or law.carries_gas:
            problem = f"is given, and {law.name} does not conserve the oil, or has its gas to follow."
            remedy = 'Write "elrod", "peeken" or "two-phase" for the cavitation model; or leave it out.'
        elif place.grid_body != HOUSING or place.feed_holes is not None:
            problem = "is given to openings that turn, or to channels of a ring."
            remedy = "Give it to openings that stand still: of the outer film, or of a shell; or leave it out."
        elif supply.absolute(oil.ambient_pressure) <= least:
            problem = f"is given at a pressure that is not above {display(least, 'Pa')}, to which it is to fall."
            remedy = "Raise the pressure of the supply, which is the largest one; or leave it out."
        else:
            continue
        yield Fault(at, display(supply.largest_flow, "m^3/s"), None, problem, remedy)


def bath_faults(case: Case) -> Iterator[Fault]:
    """Films with ends that lie in a bath in part, which are not solved so."""
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        film, oil = place.geometry, case.oil
        if film.bath <= NO_BATH:
            continue
        law, form = law_named(case.cavitation(film)), form_of(case)
        remedy = 'Write ends = "oil-bath" or "free-to-air".'
        followed = form.by_cells and form.follows_supply and law.keeps_oil
        if not followed or law.carries_gas:
            why = "is not modelled with oil that carries free gas"
            problem = f"parts the ends, which {why if followed else 'only mass-conserving finite volumes support'}."
            remedy = f'Write film.cavitation = "peeken"; or {remedy[0].lower()}{remedy[1:]}'
        elif tilts(case) or any(True for _ in misaligned(case)):
            problem = "parts the ends, which is not modelled with a tilt."
        elif place.grid_body != HOUSING or place.feed_holes is not None:
            problem = "parts the ends, and the openings of the film turn against the bath."
        elif law.empties and oil.cavitation_pressure >= oil.ambient_pressure:
            problem = "has no effect: the pressure is nowhere below the bath's, so that no oil comes in."
        else:
            continue
        yield Fault(f"{key}.ends.bath_level", f"{film.bath:.3g} radii", None, problem, remedy)


def _limited_films(case: Case) -> Iterator[tuple[str, FilmPlace]]:
    """Keys of the flow of the supplies that give one at most, and the films."""
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        if math.isfinite(place.geometry.supply.largest_flow):
            yield f"{key}.supply.flow", place


def saturation_faults(case: Case) -> Iterator[Fault]:
    """Gas that dissolves in proportion to its pressure, by Henry's law."""
    pressure = case.film.bubbly.saturation_pressure if "bubbly" in case.cavitations else None
    if pressure is not None and pressure > HENRY:
        problem = f"is above {display(HENRY, 'Pa')}, up to which gas dissolves in proportion to its pressure."
        remedy = "Give the pressure of the air over the oil in its tank."
        yield Fault("film.bubbly.saturation_pressure", display(pressure, "Pa"), None, problem, remedy)


def sound_faults(case: Case) -> Iterator[Fault]:
    """Speeds of sound with which no vapour is in balance with the oil at the pressure of the cavities."""
    if Barotropic.name not in case.cavitations:
        return
    given, oil = case.film.barotropic, case.oil
    try:
        Barotropic.scaled(given, FilmOil(1.0, oil.ambient_pressure, oil.cavitation_pressure, oil.density))
    except ValueError:
        speed = display(given.vapour_sound_speed, "m/s")
        problem = f"leaves no vapour that is lighter than the oil at {display(oil.cavitation_pressure, 'Pa')}."
        remedy = "Correct it, film.barotropic.liquid_sound_speed, which is larger, or oil.cavitation_pressure."
        yield Fault("film.barotropic.vapour_sound_speed", speed, None, problem, remedy)


def moved_gas_faults(case: Case) -> Iterator[Fault]:
    """What runs do not follow free gas in: channels, films with steps of their own."""
    if not form_of(case).solved or not any(law_named(name).carries_gas for name in case.cavitations):
        return
    problem = "is not modelled with oil that carries free gas."
    peeken = 'or film.cavitation = "peeken", its limit of fast exchange'
    if coupling_of(case).in_turn:
        remedy = f'Write film.coupling = "monolithic", {peeken}.'
        yield Fault("film.coupling", case.film.coupling, None, problem, remedy)
    yield from coupling_faults(case, problem, f'Write channels = "pressure" here, {peeken}.')


def sealed_faults(case: Case) -> Iterator[Fault]:
    """Films with sealed ends that are not solved so."""
    form = form_of(case)
    for key, film in _sealed_films(case):
        at = f"{key}.ends"
        if case.film.theory == "short" and film_form(case, film, "short") is CLIPPED:
            problem = "lets a cavity reach the ends, where a short bearing clips between the pressures of open ends."
            yield Fault(at, _shown(film), None, problem, 'Write film.theory = "finite".')
        elif form.by_cells:
            yield from _enclosed(key, film)


def published_faults(case: Case) -> Iterator[Fault]:
    """What does not go with the published form of the two-phase model, which its artificial diffusion (4.42) makes."""
    if not is_published(case):
        return
    key, form, remedy = "film.two-phase.form", "published", 'Write form = "conservative".'
    if case.heat is not None:
        problem = "creates oil, which would carry away heat that no film has received: [thermal] would not balance."
        yield Fault(key, form, None, problem, remedy)
    if case.film.grid == "half-speed":
        problem = "turns the cells with the oil, which no longer passes them, so that the diffusion (4.42) vanishes."
        yield Fault("film.grid", case.film.grid, None, problem, 'Write "auto".')


def published_tilt_faults(case: Case, tilted: bool) -> Iterator[Fault]:
    """Films in the published form whose gap is not even along the axis. tilted: whether it is not."""
    if is_published(case) and tilted:
        problem = "spreads oil in gaps that are even along the axis alone."
        remedy = 'Write form = "conservative", or leave the tilt out.'
        yield Fault("film.two-phase.form", "published", None, problem, remedy)


def enclosed_faults(case: Case) -> Iterator[Fault]:
    """Films whose oil is enclosed, in tests, which show their pressure on cells."""
    return (fault for key, film in _sealed_films(case) for fault in _enclosed(key, film))


def _sealed_films(case: Case) -> Iterator[tuple[str, FilmGeometry]]:
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        if place.geometry.sealed < 1.0:
            yield key, place.geometry


def _enclosed(key: str, film: FilmGeometry) -> Iterator[Fault]:
    """Oil that does not come in or leave has the pressure that it was enclosed with."""
    if film.sealed < ENCLOSED and not film.supply.feeds:
        problem = "encloses the oil, for nothing feeds the film: the level of its pressure is that of its filling."
        remedy = f"Give it a supply, or a share of at least {ENCLOSED:g}; runs with half-sommerfeld take any."
        yield Fault(f"{key}.ends", _shown(film), None, problem, remedy)


def _shown(film: FilmGeometry) -> str:
    return f"sealed = {film.sealed:g}"


def mesh_faults(case: Case) -> Iterator[Fault]:
    """A mesh with more elements along than around has its two numbers the wrong way round."""
    along, around = case.accuracy.mesh or (0, 0)
    if along > around:
        problem = "has more elements along the axis than around, where the gap changes."
        remedy = f"Write [{around}, {along}], along first, or at least as many around as along."
        yield Fault("accuracy.mesh", f"[{along}, {around}]", None, problem, remedy)


def rough_faults(case: Case) -> Iterator[Fault]:
    """The gap between rough surfaces has to be between plain cylinders."""
    contact = case.contact
    if contact.roughness is None:
        return
    from frbcli.film.roughness.asperities import LAST  # with its compiler, which other cases do not need

    for key, place in zip(film_keys(case), film_places(case), strict=True):
        film = place.geometry
        if film.shell is not None:
            problem = "is not modelled with asperities, which need the gap of a plain cylinder."
            yield Fault(f"{key}.{film.shell.key}", film.shell.words, None, problem, f"{SMOOTH}, or leave it out.")
        problem = f"is so large that summits meet all around a clearance of {display(film.clearance, 'm')}."
        if LAST * contact.roughness >= film.clearance:
            remedy = f"Give less than {display(film.clearance / LAST, 'm')}."
            yield Fault("contact.roughness", display(contact.roughness, "m"), None, problem, remedy)
        elif (room := film.clearance - LAST * contact.roughness) <= contact.mean_height:
            remedy = f"Give less than {display(room, 'm')}."
            yield Fault("contact.mean_height", display(contact.mean_height, "m"), None, problem, remedy)
    if contact.flow_factors and (form := form_of(case)) not in (CELLS, TILTED, INCLINED):
        problem = f"changes the flow of finite-volume films, and this film is: {form}."
        yield Fault("contact.flow_factors", "true", None, problem, "Write false.")
    if contact.shear != 0.0 and any((each.outside, each.grid_body) != (HOUSING,) * 2 for each in film_places(case)):
        problem = "lets a surface carry more oil than the other, which needs shells and openings at rest."
        value = display(contact.journal_roughness or 0.0, "m")
        yield Fault("contact.journal_roughness", value, None, problem, "Leave it out: both surfaces are equal then.")
    for key, value in misaligned(case):
        problem = "is not modelled with asperities, whose gap is the same along the axis."
        yield Fault(key, value, None, problem, f"{SMOOTH}, or leave it out.")


def rough_tilt_faults(case: Case) -> Iterator[Fault]:
    """Tests with a journal that tilts in a shell that is in line."""
    given = case.motion is not None and len(case.bearings) == 1 and tilts(case)
    if case.contact.rough and given and not any(misaligned(case)):
        problem = "is not modelled with asperities, whose gap is the same along the axis."
        yield Fault(*tilt_key(case), None, problem, f"{SMOOTH}, or leave the tilt out.")


def rough_coupling_faults(case: Case) -> Iterator[Fault]:
    """Summits are far stiffer than a film: they are solved with the rotor, until nothing is left over."""
    coupling = coupling_of(case)
    if case.contact.rough and (coupling.in_turn or coupling.once):
        problem = "solves rotor and films once per step, and summits are too stiff for that."
        yield Fault("film.coupling", case.film.coupling, None, problem, f'{SMOOTH}, or film.coupling = "auto".')


def sheet_faults(case: Case) -> Iterator[Fault]:
    """A sheet has the films between surfaces that turn against each other."""
    if not case.bearings:
        for each in DamperElement.of(case):
            problem = "has the only films of the case, which do not turn: a film of a damper carries nothing at rest."
            yield Fault(each.key, "", None, problem, "Add a bearing with a film.")


def loaded_faults(case: Case) -> Iterator[Fault]:
    """A given load acts on one film."""
    for each in DamperElement.of(case):
        problem = "adds a film to the bearing's, and a given load is the load of a single film."
        yield Fault(each.key, "", None, problem, "Leave the damper out: the sheet is of the film in its shell.")


def rest_faults(case: Case) -> Iterator[Fault]:
    """Where nothing but a film that does not turn holds a shell, a load sinks it."""
    for each in DamperElement.of(case):
        if not all(each.given.spring) and _loaded(case):
            problem = "is missing: the film does not turn and carries no static load, and the shell sinks."
            yield Fault(f"{each.key}.spring", "", None, problem, 'Write e.g. spring = "5e6 N/m", or take a run.')


def linear_faults(case: Case) -> Iterator[Fault]:
    """Films that cavitate as soon as their shell moves have no damping, but in the centre."""
    if not _loaded(case):
        return
    for each in DamperElement.of(case):
        if all(each.given.spring) and not each.given.centred and cavitates_at_once(case, each.given):
            problem = "cavitates as soon as its shell moves. A cavitating damper off its centre has no linear damping."
            remedy = (
                "Take a run; or write centred = true; or raise oil.ambient_pressure, and a supply, above "
                "oil.cavitation_pressure, take "
                "sommerfeld, or leave the weight out, for the damper in its centre."
            )
            yield Fault(f"{each.key}.cavitation", case.cavitation(each.given), None, problem, remedy)


def cavitates_at_once(case: Case, damper: Damper) -> bool:
    """Whether some part of a film at rest has the pressure at which it cavitates."""
    oil, supply = case.oil, damper.supply
    pressures = [oil.ambient_pressure, *([supply.absolute(oil.ambient_pressure)] if supply.feeds else [])]
    return law_named(case.cavitation(damper)).cavitates and min(pressures) <= oil.cavitation_pressure


def _loaded(case: Case) -> bool:
    pushed = any(force.constant for force in case.forces)
    return case.given_rotor is not None and (case.rotor.gravity > 0.0 or pushed)


NEARLY = 0.99  # of the pull at which the rotor has no stiffness: what the remedy says


def pull_faults(case: Case) -> Iterator[Fault]:
    """Pulls that the shaft and what else holds the rotor do not resist, also if the films were rigid."""
    if not case.magnetic_pulls or case.given_rotor is None:
        return
    pulled = make_rotor(case)
    free = make_rotor(altered(case, {"magnetic_pulls": ()}))
    share = _share(free, free.stiffness - pulled.stiffness)
    if share >= 1.0:
        for each in MagneticPullElement.of(case):
            films = ", with films that do not give way" if case.films else ""
            problem = f"is {share:.3g} times what shaft and bearings hold{films}: the rotor is statically unstable."
            remedy = f"Give at most {display(NEARLY * each.given.pull / share, 'N/m')}, or a stiffer rotor."
            yield Fault(f"{each.key}.pull", display(each.given.pull, "N/m"), None, problem, remedy)


def _share(rotor: LinearRotor, pulls: Array) -> float:
    """All pulls (n, n) over those at which the rotor at rest has a motion without stiffness, 0 where they have none."""
    k = rotor.at(0.0).stiffness
    moving = k.any(axis=1) | pulls.any(axis=1)  # without the angles of rings
    held = rotor.journals.reshape(-1, rotor.size)[:, moving]
    _, sizes, right = np.linalg.svd(held) if len(held) else (None, np.zeros(0), np.eye(int(moving.sum())))
    free = right[int(np.sum(sizes > 1e-9 * sizes.max(initial=0.0))) :].T
    if not free.size:
        return 0.0
    k, pulls = (free.T @ each[np.ix_(moving, moving)] @ free for each in (k, pulls))
    shares = np.linalg.eigvals(np.linalg.lstsq(k, pulls, rcond=None)[0])
    return float(max((each.real for each in shares if abs(each.imag) < 1e-9), default=0.0))
