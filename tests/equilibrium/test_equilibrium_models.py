"""Resting positions with every cavitation model against an independent program, through the library.

With the Reynolds condition the films here differ from that program's forces by 4e-4 at most, but rest further out than
it says by up to 0.7 %, with 48 x 12 to 240 x 60 cells alike: its positions are the less accurate of the two.
"""

import math

import numpy as np
import pytest
from paths import rows_of

from frbcli import load_case, rotation
from frbcli.bearing_tests import steady_film as resting
from frbcli.bearing_tests.steady_film import film_force, resting_displacement
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.cells.film import Motion
from frbcli.scene.planning.kinematic_plan import kinematic_plan

CASES = {("40", "10"): "jeffcott-table-4-1", ("35", "12"): "jeffcott"}
WEIGHT = 6.1 * 9.81 / 2  # N per bearing
MESH = "accuracy.mesh=[24, 96]"
ECCENTRICITY, ATTITUDE_DEG, PRESSURE = 1e-2, 0.2, 1e-2


POSITIONS = [
    row
    for row in rows_of("equilibrium-models.csv")
    if (row["clearance_um"], row["speed_Hz"]) in {("40", "10"), ("40", "60"), ("35", "120")}
]


def model_of(row: dict[str, str]) -> tuple[str, list[str]]:
    """Its name in a case, and the settings for its parameters."""
    words = row["cavitation"]
    if words.startswith("penalty"):
        return "penalty", [f"film.penalty.pressure={'absolute' if 'p/p0' in words else 'dimensionless'}"]
    if words.startswith("two-phase"):
        return "two-phase", [f"film.two-phase.steepness={words.split('x1=')[1].split(',')[0]}"]
    return words, []


def case_of(row: dict[str, str], settings: list[str]) -> Case:
    motion = f"motion={{load='{WEIGHT} N', speed='{row['speed_Hz']} Hz'}}"
    name = CASES[row["clearance_um"], row["viscosity_mPas"]]
    return load_case(name, [motion, f"bearing.ends={row['ends']}", MESH, *settings])


def name_of(row: dict[str, str]) -> str:
    return " ".join((row["clearance_um"], row["cavitation"], row["ends"], row["speed_Hz"]))


@pytest.mark.parametrize("row", POSITIONS, ids=name_of)
def test_journal_rests_where_an_independent_program_says(row: dict[str, str]) -> None:
    model, settings = model_of(row)
    found = rotation(case_of(row, settings), [model]).results[0]
    assert found.loads is not None
    assert found.loads.force == pytest.approx((0.0, WEIGHT), abs=1e-3 * WEIGHT)
    x, y = found.displacement
    assert math.hypot(x, y) == pytest.approx(float(row["eccentricity"]), rel=ECCENTRICITY)
    assert math.degrees(math.atan2(x, -y)) == pytest.approx(float(row["attitude_deg"]), abs=ATTITUDE_DEG)
    assert found.loads.p_max == pytest.approx(1e5 * float(row["pmax_bar"]), rel=PRESSURE)


def test_elrods_film_without_supply_carries_nothing_and_says_so() -> None:
    case = load_case("bearing", ["bearing.ends=free-to-air"])
    with pytest.raises(NotConverged, match="carries 0 N, at any eccentricity"):
        resting_displacement(case, kinematic_plan(case, "elrod"), 29.9, 40.0 * math.pi)


def test_elrods_load_falls_with_the_supply_pressure_to_nothing() -> None:
    """Flow through the edges is what feeds the film, and it goes with the excess of the supply over p_cav: a tenth of
    it leaves about a tenth of the load, once the film is mostly empty."""
    sizes = []
    for supply in ("1.001 bar", "1.0001 bar"):
        settings = ["bearing.ends=oil-bath", f"bearing.supply.pressure={supply}"]
        case = load_case("bearing", settings)
        plan = kinematic_plan(case, "elrod")
        force = film_force(case, plan, (64, 16), Motion((0.2, -0.56), (0.0, 0.0), 40.0 * math.pi), None).force
        sizes.append(float(np.linalg.norm(force)))
    assert sizes[0] < 2.0  # N; 60 N if it is full
    assert sizes[1] == pytest.approx(0.1 * sizes[0], rel=0.3)


def test_load_beyond_all_that_the_film_carries_names_the_largest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resting, "COARSE_CELLS", (24, 8))
    monkeypatch.setattr(resting, "STARTS", (0.6, 0.95))
    case = load_case("bearing-axial-groove", ["accuracy.mesh=[8, 24]"])
    with pytest.raises(NotConverged, match=r"largest film force found is .* N, at an eccentricity of 0\.95"):
        resting_displacement(case, kinematic_plan(case, "reynolds"), 1e9, 40.0 * math.pi)
