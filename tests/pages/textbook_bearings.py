"""Bearings and dampers of textbooks, against printed tables and closed forms. FORMS take a second, TABLES minutes."""

import math
import tomllib
from functools import partial

import numpy as np
from cycle_machines import UNIT_Hz, rigid
from numpy.typing import NDArray
from paths import rows_of
from printed_sheets import CASE, OMEGA, grooves, printed

import frbcli
from frbcli.linear.sheets.bearing import bearing_sheet, sommerfeld_chart
from frbcli.linear.sheets.film_state import FilmState
from frbcli.linear.stability import stability
from pages.textbook_rows import CLOSED, PRINTED, PROGRAM, Bench, Row

Matrix = NDArray[np.float64]
TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # to the frame of tables: x along the load
VISCOSITY = 0.02  # Pa s
NAMES = ("xx", "xy", "yx", "yy")
KYX = "K_yx C/W"
SOMEYA = "Someya 1989, p. {}"
BOOK = (
    "The stiffness of the book differs more at small eccentricities; S, attitude and damping agree to 1 % at L/D 0.5 "
    "and eccentricity 0.2. An independent finite-difference solution agrees with frb, and Lund and Thomsen's table "
    "with grooves of 20 deg to 1.6 %. The cause is not known."
)
LOBED = (
    "The tables of two lobes agree to 3 % with a preload of 2/3 and to 10 % with one of 1/2. The cause is not known."
)
RIGID = (
    "The shells of the source are elastic, in frb rigid: at 10 MPa and 150 rpm its thinnest film has 0.7 um, in frb "
    "0.5 um. Without the mean height of the summits, 0.6 um, frb has 0.46 N m there."
)
SHORT = (
    "The closed form is met to round-off. The stated error is the difference between short theory and finite length."
)


def film(
    width: float, diameter: float, clearance: float, supply: str, load: float = 1.0, lobes: str = ""
) -> frbcli.Case:
    """A bearing under Reynolds' condition at 50 Hz with 20 mPa s; lengths in m."""
    text = CASE.format(viscosity=1e3 * VISCOSITY, width=1e3 * width, diameter=1e3 * diameter, clearance=1e6 * clearance,
                       supply=supply, load=load)  # fmt: skip
    return frbcli.load_case_text(text.replace("[film]", f"{lobes}\n[film]"), name="textbook")


def chart(case: frbcli.Case, eccentricity: float, *settings: str) -> FilmState:
    case = frbcli.load_case_text(case.source_text, settings=settings, name="textbook") if settings else case
    return sommerfeld_chart(case, [eccentricity], 50.0).points[0]


def load_of(state: FilmState) -> float:
    return math.hypot(*state.load)


def petroff() -> list[Row]:
    """A centred journal shears its whole film."""
    radius, width, clearance = 0.05, 0.1, 1e-4
    case = film(width, 2 * radius, clearance, '{ kind = "none" }')
    state = chart(case, 1e-3, "film.cavitation=sommerfeld")
    expected = math.tau * VISCOSITY * radius**3 * width * OMEGA / clearance
    error = state.power_error / state.power
    return [Row("centred journal", "Petroff 1883", CLOSED, "torque, N m", expected, abs(state.torque), error, 1e-4)]


def ocvirk() -> list[Row]:
    radius, width, clearance = 0.05, 0.025, 1e-4
    rows = []
    for eps in (0.2, 0.5, 0.8):
        case = film(width, 2 * radius, clearance, '{ kind = "none" }')
        state = chart(case, eps, "film.theory=short", "film.cavitation=half-sommerfeld")
        rest = 1.0 - eps**2
        load = VISCOSITY * OMEGA * radius * width**3 / (4 * clearance**2) * eps / rest**2
        load *= math.sqrt(math.pi**2 * rest + 16 * eps**2)
        attitude = math.degrees(math.atan(math.pi * math.sqrt(rest) / (4 * eps)))
        row = partial(Row, f"short bearing, eccentricity {eps:g}", "DuBois, Ocvirk 1953", CLOSED)
        rows.append(row("load, N", load, load_of(state), state.force_error, 1e-6, SHORT))
        rows.append(row("attitude, deg", attitude, state.attitude_deg, math.nan, 1e-6))
    return rows


def short_thresholds() -> list[Row]:
    """Gamma = 1 / (w f) with the load f(eps) of the short bearing."""
    rows = []
    for eps, expected in ((0.05, 2.7582), (0.1, 2.7413), (0.3, 2.6058)):
        rest = 1.0 - eps**2
        gamma = 1.0 / (expected * eps * math.sqrt(math.pi**2 * rest + 16 * eps**2) / (4 * rest**2))
        found = stability(rigid(gamma, 0.8 * expected, 1.2 * expected)).threshold
        assert found is not None
        error = found.speed_uncertainty_Hz / found.speed_Hz
        row = partial(Row, f"rigid rotor in short bearings, eccentricity {eps:g}", "independent program", PROGRAM)
        rows.append(row("threshold sqrt(C/g)", expected, found.speed_Hz / UNIT_Hz, error, 1e-4, SHORT))
    return rows


def squeeze_film_damper() -> list[Row]:
    """A circle about the centre: half of the film cavitates."""
    inch, viscosity, omega, eps = 0.0254, 0.02797, 1947.787, 0.5
    radius, width, clearance = 0.5 * 5.1 * inch, 0.9 * inch, 0.003 * inch
    text = CASE.format(viscosity=1e3 * viscosity, width=1e3 * width, diameter=2e3 * radius, clearance=1e6 * clearance,
                       supply='{ kind = "none" }', load=1)  # fmt: skip
    settings = ["film.theory=short", "film.cavitation=half-sommerfeld"]
    text = text[: text.index("[motion]")] + (
        f'[motion]\neccentricity = {eps}\nspeed = "0 Hz"\nwhirl_speed = "{omega / math.tau!r} Hz"\n'
    )
    (result,) = frbcli.rotation(frbcli.load_case_text(text, settings, name="damper")).results
    assert result.loads is not None
    force = np.asarray(result.loads.force)
    e = eps * clearance
    size = viscosity * radius * (width / clearance) ** 3
    found = -force[0] / e, -force[1] / (e * omega)
    closed = 2 * size * omega * eps / (1 - eps**2) ** 2, 0.5 * math.pi * size / (1 - eps**2) ** 1.5
    name, rows = "short damper on a circle, eccentricity 0.5", []
    for quantity, value, own, ross in zip(
        ("stiffness, N/m", "damping, N s/m"), found, closed, (1.69362187e8, 118283.8359), strict=True
    ):
        for source, kind, expected, bound, why in (
            ("San Andres, notes; Childs 1993", CLOSED, own, 1e-6, SHORT),
            ("ROSS, damper test", PROGRAM, ross, 2e-4, "Its viscosity has four digits."),
        ):
            rows.append(Row(name, source, kind, quantity, expected, value, result.force_error, bound, why))
    return rows


def sommerfeld() -> list[Row]:
    """The long bearing has W = eta omega R B (R / C)^2 12 pi eps / ((2 + eps^2) sqrt(1 - eps^2)), across the load: what
    a longer bearing carries more is free of its ends."""
    radius, clearance, eps = 0.05, 1e-4, 0.5
    width = 40 * radius
    films = (film(each, 2 * radius, clearance, '{ kind = "none" }') for each in (width, 2 * width))
    state, longer = (chart(each, eps, "film.theory=finite", "film.cavitation=sommerfeld") for each in films)
    found = load_of(longer) - load_of(state)
    error = (load_of(longer) + load_of(state)) / found * longer.force_error
    load = VISCOSITY * OMEGA * radius * width * (radius / clearance) ** 2
    load *= 12 * math.pi * eps / ((2 + eps**2) * math.sqrt(1 - eps**2))
    row = partial(Row, "long bearing: 40 diameters less 20, eccentricity 0.5", "Sommerfeld 1904", CLOSED)
    return [
        row("load, kN", load / 1e3, found / 1e3, error, 2e-3),
        row("attitude, deg", 90.0, state.attitude_deg, math.nan, 1e-4),
    ]


def dimensionless(state: FilmState, clearance: float) -> tuple[Matrix, Matrix]:
    """Stiffness over W / C and damping over W / (C omega) in the frame of tables."""
    assert state.stiffness is not None
    assert state.damping is not None
    share = clearance / load_of(state)
    return TURN @ state.stiffness @ TURN.T * share, TURN @ state.damping @ TURN.T * share * OMEGA


def under(
    number: float, width: float, clearance: float, supply: str, lobes: str = "", preload: float = 0.5
) -> FilmState:
    """A bearing of 100 mm under the load of a Sommerfeld number eta N L D (R / C)^2 / W on `clearance`."""
    load = VISCOSITY * 50.0 * width * 0.1 * (0.05 / clearance) ** 2 / number
    preloaded = 1.0 - preload if lobes else 1.0
    return bearing_sheet(film(width, 0.1, clearance * preloaded, supply, load, lobes)).points[0]


def eccentricity(name: str, source: str, state: FilmState, printed: float, bound: float, why: str = "") -> Row:
    """The row of a printed eccentricity at rest."""
    found = state.eccentricity
    return Row(name, source, PRINTED, "eccentricity", printed, found, state.place_error / found, bound, why)


def of_table(
    name: str, source: str, state: FilmState, clearance: float, row: dict[str, float], share: float, why: str = ""
) -> list[Row]:
    """Rows of the largest stiffness and damping of a printed line."""
    rows = []
    for sort, found in zip(("k", "b"), dimensionless(state, clearance), strict=True):
        given = {each: row[sort + each] for each in NAMES if sort + each in row}
        largest = max(given, key=lambda each: abs(given[each]))
        value = float(found.ravel()[NAMES.index(largest)])
        quantity = f"K_{largest} C/W" if sort == "k" else f"D_{largest} C omega/W"
        rows.append(Row(name, source, PRINTED, quantity, given[largest], value, state.error, share, why))
    return rows


def butenschoen() -> list[Row]:
    rows = []
    for line in printed("butenschoen.csv"):
        slenderness, number, attitude = (line[x] for x in ("width_over_diameter", "sommerfeld_number", "attitude_deg"))
        if line["eccentricity"] != 0.5 or slenderness not in (1.0, 0.5, 0.25):
            continue
        radius, clearance = 0.05, 1e-4
        state = chart(film(2 * radius * slenderness, 2 * radius, clearance, grooves(1, attitude, 0.5)), 0.5)
        flow, error = state.side_flow / (radius**2 * clearance * OMEGA), state.side_flow_error / state.side_flow
        row = partial(Row, f"plain bearing, B/D {slenderness:g}, eccentricity 0.5", "Butenschoen 1976", PRINTED)
        rows += [
            row("Sommerfeld number", number, state.sommerfeld_number, state.force_error, 0.01),
            row("attitude, deg", attitude, state.attitude_deg, math.nan, 5e-3),
            row("side flow", line["side_flow"], flow, error, 0.01),
        ]
    return rows


def lund_thomsen() -> list[Row]:
    rows = []
    for row in printed("lund-thomsen.csv")[::3]:
        state = under(row["s"], 0.1 * row["width_over_diameter"], 1e-4, grooves(2, 90, 20))
        name = f"two axial grooves, L/D {row['width_over_diameter']:g}, S {row['s']:g}"
        source = "Lund, Thomsen 1978"
        rows.append(eccentricity(name, source, state, row["eccentricity"], 0.01))
        rows += of_table(name, source, state, 1e-4, row, 0.016)
    row = printed("lund-thomsen-lemon.csv")[0]
    state = under(row["s"], 0.1, 2e-4, grooves(2, 90, 20), "lobes = { count = 2, preload = 0.5 }")
    name = f"lemon bore, L/D 1, preload 0.5, S {row['s']:g}"
    return rows + of_table(name, "Lund, Thomsen 1978", state, 2e-4, row, 0.016)


def nicholas() -> list[Row]:
    """Bearings without a dam: a rigid rotor on a film whose coefficients stay."""
    rows = []
    for mil, printed_eccentricity in ((1.8, 0.03), (2.0, 0.04)):
        clearance, load, speed = 25.4e-6 * mil, 66.278, 8000.0 / 60.0
        text = CASE.format(viscosity=52.4, width=25.4, diameter=25.4, clearance=1e6 * clearance,
                           supply=grooves(2, 90, 20), load=load)  # fmt: skip
        state = bearing_sheet(frbcli.load_case_text(text.replace("50 Hz", f"{speed!r} Hz"), name="textbook")).points[0]
        k, b = state.stiffness, state.damping
        assert k is not None
        assert b is not None
        still = (k[0, 0] * b[1, 1] + k[1, 1] * b[0, 0] - k[0, 1] * b[1, 0] - k[1, 0] * b[0, 1]) / np.trace(b)
        whirl = np.linalg.det(k - still * np.eye(2)) / np.linalg.det(b) / (math.tau * speed) ** 2
        found = math.sqrt(still * clearance / load / whirl)
        name, source = f"bearing A of {mil:g} mil, 8000 rpm", "Nicholas et al. 1980, table 6"
        rows.append(eccentricity(name, source, state, printed_eccentricity, 0.15, "Printed to one digit."))
        rows.append(Row(name, source, PRINTED, "threshold sqrt(C/g)", 2.1, found, state.error, 0.025))
    return rows


LOBES = {"preload 2/3": 2.0 / 3.0, "preload 1/2": 0.5}


def someya() -> list[Row]:
    rows = []
    for line in rows_of("someya.csv"):
        row = {key.lower(): float(value) for key, value in line.items() if key not in ("table", "page")}
        width = 0.05 if "L/D 0.5" in line["table"] else 0.1
        preload = next((each for part, each in LOBES.items() if part in line["table"]), 0.0)
        shell = f'lobes = {{ count = 2, preload = {preload!r}, position = "0 deg" }}' if preload else ""
        state = under(row["s"], width, 1e-4, grooves(2, 90, 10), shell, preload)
        name, source = f"{line['table']}, S {row['s']:g}", SOMEYA.format(line["page"])
        bound, why = (0.04, LOBED) if preload else (0.01, "")
        rows.append(eccentricity(name, source, state, row["e"], bound, why))
        turned = BOOK if row["e"] < 0.3 and not preload else ""
        rows.append(Row(name, source, PRINTED, "attitude, deg", row["phi"], state.attitude_deg, math.nan, 0.04, turned))
        rows += of_table(name, source, state, 1e-4, row, 0.1, LOBED if preload else BOOK)
        if preload:
            continue
        value, bound = float(dimensionless(state, 1e-4)[0][1, 0]), 0.55 if row["e"] < 0.3 else 0.3
        rows.append(Row(name, source, PRINTED, KYX, row["kyx"], value, state.error, bound, BOOK))
        if width == 0.05 and row["e"] == 0.2:
            rows.append(Row(name, "finite differences", PROGRAM, KYX, -3.07, value, state.error, 5e-3))
    return rows


def greenwood_tripp(sigma: float, factor: float, crowd: float) -> tuple[float, float]:
    """Radius in m and density in 1/m^2 of summits whose pressure is factor E F_5/2, with crowd = N beta sigma."""
    radius = sigma / (factor / (16.0 * math.sqrt(2.0) * math.pi / 15.0 * crowd**2)) ** 2
    return radius, crowd / (radius * sigma)


def mixed(diameter: float, width: float, supply: str, load: float, rpm: float) -> FilmState:
    """A bearing of Sander's test rig; lengths in m."""
    sigma = math.hypot(0.13e-6, 0.28e-6)
    radius, density = greenwood_tripp(sigma, 1e-3, 0.05)
    surfaces = {"model": "asperities", "roughness": sigma, "summit_radius": radius, "summit_density": density}
    pressures = {"ambient_pressure": 1e5, "cavitation_pressure": 100.0}
    case = frbcli.case_from_dict(
        {
            "oil": {"viscosity": 6.8e-3, "density": 900.0, **pressures},
            "bearing": {"kind": "single-film", "width": width, "diameter": diameter, "clearance": 0.5e-3 * diameter,
                        "supply": tomllib.loads(f"supply = {supply}")["supply"]},
            "film": {"cavitation": "reynolds"},
            "contact": {**surfaces, "modulus": 53.3e9, "friction": 0.02, "mean_height": 0.6e-6},
            "motion": {"load": load, "speed": rpm / 60.0},
        },
        "Sander",
    )  # fmt: skip
    return bearing_sheet(case).points[0]


def sander() -> list[Row]:
    """Shaft torque of a test bearing with an oil hole and of two supports with a groove of half the circumference."""
    hole = '{ kind = "bores", count = 1, diameter = "5 mm", position = "0 deg", pressure = "1 bar" }'
    groove = '{ kind = "pocket", position = "0 deg", opening_angle = "180 deg", width = "5 mm", pressure = "1 bar" }'
    rows = []
    for load, rpm, expected, bound in ((4e3, 1000.0, 0.46, 0.05), (8e3, 1000.0, 0.544, 0.2), (8e3, 150.0, 1.71, 1.05)):
        test, support = mixed(0.0478, 0.0172, hole, load, rpm), mixed(0.054, 0.025, groove, 0.5 * load, rpm)
        found = abs(test.torque) + 2.0 * abs(support.torque)
        lost = (test.power_error + 2.0 * support.power_error) / (test.power + 2.0 * support.power)
        name = f"three rough bearings, {load / 800:g} MPa at {rpm:g} rpm"
        source = "Sander et al."
        rows.append(Row(name, source, PRINTED, "friction torque, N m", expected, found, lost, bound, RIGID))
    return rows


FORMS: tuple[Bench, ...] = (ocvirk, short_thresholds, squeeze_film_damper)
TABLES: tuple[Bench, ...] = (petroff, sommerfeld, butenschoen, lund_thomsen, nicholas, someya, sander)
