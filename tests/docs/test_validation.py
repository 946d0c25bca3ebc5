"""The rows of docs/validation.md that matter most, by the functions that the page is written with. Tolerances:
thresholds and resting positions 0.5 % and 0.3 % of an independent, grid-refined program; printed numbers bear what
thesis-numbers.toml says; rises move by tenths of a second with the noise that excites them. The rows of
docs/textbooks.md: frb has the figures of their sources within the bounds of the rows."""

import re
import shlex
from pathlib import Path

import pytest
from pages.textbook_bearings import FORMS, TABLES, nicholas
from pages.textbook_rotors import ROTORS
from pages.textbook_rows import Bench
from pages.textbooks_page import PAGE, written
from validation import chapter6, chapter6_rows, chapter_7, chapter_7_page, measures, validate

from frbcli.case.reading.load import load_case
from frbcli.case.reading.shipped import shipped_names
from frbcli.linear.sheets.ball import ball_bearing_sheet
from frbcli.runs.run import runup
from frbcli.scene.planning.kinematic_plan import kinematic_plan
from frbcli.scene.planning.plan import make_plan, thrust_plan

PRINTED = {row["id"]: row for row in validate.printed_rows()}


CASES_PAGE = validate.PAGE.parent / "cases.md"


def commands() -> list[str]:
    """The commands that docs/cases.md shows for cases; what reads a run follows the command that writes it."""
    blocks = re.findall(r"```sh\n(.*?)```", CASES_PAGE.read_text(encoding="utf-8"), re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    return [line for line in lines if not shlex.split(line)[2].endswith(".h5")]


def planned(name: str, settings: tuple[str, ...]) -> bool:
    """Load and plan a case: for a run, for a kinematic test if it gives a motion, or for thrust bearings alone."""
    case = load_case(name, settings)
    if not case.given_bearings:
        return bool(thrust_plan(case))
    if case.given_rotor is None and case.motion is None:
        return bool(ball_bearing_sheet(case, [1000.0], [60.0]).points)
    if case.motion is None:
        return bool(make_plan(case).decisions)
    test = "rotation" if case.motion.frequency is None else "squeeze"
    return bool(kinematic_plan(case, case.film.cavitation, test).decisions)


def agrees(row: str, measured: float, tolerance: float | None = None) -> bool:
    return measured == pytest.approx(PRINTED[row]["printed"], rel=tolerance or PRINTED[row]["tolerance"])


@pytest.mark.parametrize("supply", ["none", "circumferential-groove"])
def test_film_forces(supply: str) -> None:
    assert 0.0 < measures.worst_film_force(supply) < 3e-3


def test_natural_frequency_in_rigid_bearings() -> None:
    assert agrees("rigid-bearing-frequency", measures.rigid_bearing_frequency(load_case("jeffcott")))


@pytest.mark.parametrize(
    ("row", "eccentricity", "settings"),
    [("largest-pressure-1bar", 0.485, ()), ("largest-pressure-2bar", 0.393, (chapter6_rows.TWO_BAR,))],
)
def test_largest_pressure(row: str, eccentricity: float, settings: tuple[str, ...]) -> None:
    found = chapter6.held("jeffcott-two-phase", eccentricity, 30.0, chapter6_rows.PENALTY, *settings)
    assert agrees(row, chapter6.largest_pressure_bar(found))


@pytest.mark.parametrize(
    ("row", "case", "settings"),
    [
        ("eccentricity-1bar", "jeffcott-two-phase", ()),
        ("eccentricity-2bar", "jeffcott-two-phase", (chapter6_rows.TWO_BAR,)),
        ("axial-groove-eccentricity-1bar", "axial-groove", ()),
        ("axial-groove-eccentricity-2bar", "axial-groove", (chapter6_rows.TWO_BAR,)),
    ],
)
def test_eccentricity_after_a_second(tmp_path: Path, row: str, case: str, settings: tuple[str, ...]) -> None:
    assert agrees(row, measures.eccentricity_at_1s(tmp_path, case, (chapter6_rows.PENALTY, *settings)))


@pytest.mark.nightly  # compiles a time loop that no other test has
def test_half_sommerfeld_rests_a_little_further_out_than_the_penalty_model(tmp_path: Path) -> None:
    half, penalty = (
        measures.eccentricity_at_1s(tmp_path, "jeffcott", (f"film.cavitation={model}",))
        for model in ("half-sommerfeld", "penalty")
    )
    assert 1.0 < half / penalty < 1.05


def test_published_form_has_the_printed_pressures_and_tends_to_the_penalty_model() -> None:
    published = (chapter6_rows.PUBLISHED,)
    air = chapter6.largest_pressure_bar(chapter6.at_rest("jeffcott-two-phase", 120.0, *published))
    bath = chapter6.largest_pressure_bar(chapter6.at_rest("jeffcott-two-phase", 120.0, *published, chapter6_rows.BATH))
    assert air < bath  # printed: 2.13 and 2.17 bar
    assert agrees("two-phase-pressure-bath", bath)
    steep = chapter6.at_rest("jeffcott-two-phase", 30.0, *published, "film.two-phase.steepness=0.999")
    assert agrees("eccentricity-1bar", chapter6.eccentricity(steep))  # printed for the penalty model


def test_a_film_that_keeps_its_oil_starves_without_supply(tmp_path: Path) -> None:
    # 0.485 with the penalty model; fed from an axial groove, the two models rest within a few per cent of each other
    starved = measures.eccentricity_at_1s(tmp_path, "jeffcott-two-phase")
    assert starved > 1.3 * PRINTED["eccentricity-1bar"]["printed"]
    fed, penalty = (
        measures.eccentricity_at_1s(tmp_path, "axial-groove-two-phase", (f"film.cavitation={model}",))
        for model in ("two-phase", "penalty")
    )
    assert fed == pytest.approx(penalty, rel=0.1)


def test_critical_speed_and_rise(tmp_path: Path) -> None:
    until_7s = ("speed.to=210 Hz", "speed.duration=7 s")
    run = runup(load_case("jeffcott", until_7s), tmp_path / "run.h5")
    assert agrees("critical-speed", measures.first_event(run, "critical-speed", "t_s"))
    found = measures.rise(runup(load_case("jeffcott-table-4-1", until_7s), tmp_path / "table.h5"))
    assert agrees("rise-table-4-1", found.passage_s)
    assert found.onset_s == pytest.approx(found.passage_s, abs=0.2)


def test_threshold_rises_with_the_stiffness_and_falls_with_the_supply_pressure() -> None:
    soft, stiff, rigid = measures.stiffness_thresholds(validate.STIFFNESSES)
    assert soft < stiff < rigid
    first, second, third, fourth = measures.supply_thresholds("jeffcott", validate.PRESSURES)
    assert first > second > third > fourth


def test_every_row_is_measured_or_says_what_it_waits_for() -> None:
    text = validate.PAGE.read_text(encoding="utf-8")
    for row in PRINTED.values():
        assert f"| {row['quantity']} | {row['where']} |" in text
        assert "printed" not in row or "tolerance" in row


def test_every_number_of_chapter_7_is_on_the_page() -> None:
    text = validate.PAGE.read_text(encoding="utf-8")
    for row in chapter_7_page.printed():
        assert f"| {row['text']} | {row['where']} | {row['model']} |" in text
        assert row["study"] in chapter_7.STUDIES


@pytest.mark.parametrize("name", shipped_names())
def test_every_shipped_case_can_be_modelled(name: str) -> None:
    assert planned(name, ())


@pytest.mark.parametrize("line", commands())
def test_every_command_of_the_cases_page_can_be_run(line: str) -> None:
    program, _, name, *rest = shlex.split(line)
    assert program == "frb"
    assert planned(name, tuple(rest[i + 1] for i, word in enumerate(rest) if word == "--set"))


def test_every_shipped_case_is_on_the_cases_page() -> None:
    text = CASES_PAGE.read_text(encoding="utf-8")
    named = [name for name in shipped_names() if not name.startswith("floating-ring-")]
    assert [name for name in named if f" {name} " not in text and f"`{name}`" not in text] == []


def hold(bench: Bench) -> None:
    page = {(*cells[:2], cells[2].split(", ")[0]) for cells in written(PAGE.read_text(encoding="utf-8"))}
    rows = bench()
    assert rows
    for row in rows:
        assert row.holds, row.cells()
        assert row.given in page


QUICK = (*ROTORS, *FORMS, nicholas)  # the others are tables of films of finite length
LONG = [pytest.param(bench, marks=pytest.mark.nightly) for bench in TABLES if bench not in QUICK]


@pytest.mark.parametrize("bench", [*QUICK, *LONG], ids=lambda bench: bench.__name__)
def test_figures_of_textbooks(bench: Bench) -> None:
    hold(bench)


def test_the_page_has_25_machines_and_says_why_figures_differ() -> None:
    text = PAGE.read_text(encoding="utf-8")
    rows = written(text)
    assert len({row[0].partition(":")[0] for row in rows}) >= 25
    reasons = text.partition("## Why figures differ")[2].partition("\n## ")[0]
    numbers = set(re.findall(r" \((\d+)\)(?:;| \|$)", text, re.MULTILINE))
    assert numbers
    for number in numbers:
        assert f"\n{number}. " in reasons
