"""What is wrong with the housing of a case."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from frbcli.case.reading.lines import Path
from frbcli.case.reading.tables import Breach
from frbcli.case.surroundings.housing import Housing, HousingMode, modal_products, shape
from frbcli.nearest import did_you_mean

if TYPE_CHECKING:
    from frbcli.case.schema import Case

KEY = "housing"
ORTHONORMAL = 0.01  # of 1: modes that are written with two digits
RIGID = ("mass", "inertia", "position", "mounts")
SYMMETRIC_PLACE = "bearing"  # of a symmetric rotor, whose bearings move alike


def housing_places(case: Case) -> tuple[str, ...]:
    """The places at which a housing carries bearings."""
    return (SYMMETRIC_PLACE,) if case.rotor.symmetric else tuple(bearing.name for bearing in case.placed_bearings)


def housing_breaches(case: Case) -> Iterator[Breach]:
    """Every broken rule of the housing of a case."""
    housing = case.housing
    if housing is None:
        return
    if case.given_rotor is None:
        yield Breach((KEY,), "has no effect: a kinematic test moves the journal against its shell.", "Remove it.")
    elif housing.modes:
        yield from _modal(case, housing)
    else:
        yield from _rigid(case, housing)


def _rigid(case: Case, housing: Housing) -> Iterator[Breach]:
    if housing.masses:
        yield Breach((KEY, "masses"), "has no effect without modes.", "Remove it, or give the housing by its modes.")
    if not housing.mass:
        problem = "is 0, and the housing is a body" if housing.mass == 0.0 else "is missing, and there are no modes"
        yield Breach((KEY, "mass"), f"{problem}.", 'Write e.g. mass = "50 kg".')
    if not housing.mounts:
        remedy = 'Add e.g. mounts = [{ stiffness = "1e8 N/m" }].'
        yield Breach((KEY, "mounts"), "is missing: nothing holds the housing.", remedy)
    if case.rotor.symmetric:
        problem = "has no effect: both ends of a symmetric rotor move alike, and the housing does not tilt."
        places: list[tuple[Path, object]] = [((KEY, key), getattr(housing, key)) for key in ("inertia", "position")]
        places += [((KEY, "mounts", i, "position"), mount.position) for i, mount in enumerate(housing.mounts)]
        yield from (Breach(path, problem, "Remove it.") for path, value in places if value is not None)
        return
    for key, example in (("inertia", "2 kg*m^2"), ("position", "80 mm")):
        if getattr(housing, key) is None:
            yield Breach((KEY, key), "is missing: a rigid housing tilts.", f'Write e.g. {key} = "{example}".')
    for number, mount in enumerate(housing.mounts):
        if mount.position is None:
            yield Breach((KEY, "mounts", number, "position"), "is missing.", 'Write e.g. position = "20 mm".')
    if housing.mounts and len({mount.position for mount in housing.mounts}) == 1:
        yield Breach((KEY, "mounts"), "are at one position, about which the housing tilts freely.", "Add another one.")


def _modal(case: Case, housing: Housing) -> Iterator[Breach]:
    for key in RIGID:
        if getattr(housing, key) not in (None, ()):
            yield Breach((KEY, key), "is given beside modes.", "Keep the keys of a rigid housing, or its modes.")
    carried, known = housing_places(case), {each.place for each in housing.masses}
    for number, mode in enumerate(housing.modes):
        yield from _at((KEY, "modes", number, "at"), mode, carried, known)
    if not housing.masses:
        return
    for j, k, product in modal_products(housing):
        wanted = float(j == k)
        if abs(product - wanted) > ORTHONORMAL:
            which = "with itself" if j == k else f"with mode {k + 1}"
            problem = f"has a sum of masses times displacements {which} of {product:.4g} in place of {wanted:g}."
            remedy = "Give orthonormal modes, each divided by the root of its modal mass, and all masses."
            yield Breach((KEY, "modes", j, "at"), problem, remedy)


def _at(path: Path, mode: HousingMode, carried: tuple[str, ...], known: set[str]) -> Iterator[Breach]:
    places = [each.place for each in mode.at]
    for place in carried:
        if place not in places:
            yield Breach(path, f"has no displacement at {place}.", f"Write e.g. {place} = [0.3, 0].")
    for place in dict.fromkeys(places):
        if place not in carried and place not in known:
            problem = f"has a displacement at {place}, which is neither a bearing nor a place of housing.masses."
            yield Breach(path, problem, did_you_mean(place, (*carried, *known)))
        if places.count(place) > 1:
            yield Breach(path, f"has {places.count(place)} displacements at {place}.", "Keep one.")
    if not any(any(displacement) for displacement in shape(mode).values()):
        yield Breach(path, "is zero everywhere: no mode.", "Give its displacements.")
