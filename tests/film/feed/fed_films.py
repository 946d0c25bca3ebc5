"""Films of the rigid rotor whose supply gives a flow at the most."""

import pytest

from frbcli import load_case
from frbcli.case.schema import Case
from frbcli.film.cells.film import Motion, VolumeFilm
from frbcli.scene.films import film_places, volume_film

OMEGA, PLACE = 300.0, (0.3, -0.5)
AT_REST = Motion(PLACE, (0.0, 0.0), OMEGA)
GROOVE = 'kind = "circumferential-groove", pressure = "3 bar"'
AXIAL = 'kind = "axial-grooves", opening_angle = "20 deg", pressure = "3 bar"'
BORES = 'kind = "bores", count = 2, diameter = "4 mm", pressure = "3 bar"'
by_grooves = pytest.mark.parametrize("supply", [GROOVE, AXIAL], ids=["groove", "axial"])


def fed_case(supply: str, flow: float | None, law: str = "elrod", *settings: str) -> Case:
    """The rotor with a supply that gives a flow in m^3/s, or any flow."""
    limit = "" if flow is None else f", flow = {flow!r}"
    return load_case("rigid", [f"film.cavitation={law}", f"bearing.supply={{ {supply}{limit} }}", *settings])


def fed_film(case: Case, cells: tuple[int, int]) -> VolumeFilm:
    """Its film on cells."""
    return volume_film(case, film_places(case)[0], cells)
