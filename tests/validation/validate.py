"""Measures everything and writes docs/validation.md: `cd tests && python -m validation.validate [FOLDER]`.

Runs are kept in FOLDER, where it is given, and taken from it the next time.
"""

import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

from paths import DATA, DOCS

from frbcli.case.reading.load import load_case
from validation import chapter6_rows, chapter_7_page, forms, measures, published
from validation.measured import Measured, number, speeds, with_reasons
from validation.measured import rises as rising
from validation.measures import RIGID

PAGE = DOCS / "validation.md"
STIFFNESSES = ("1000 N/mm", "5000 N/mm", RIGID)
PRESSURES = ("1 bar", "2 bar", "3 bar", "4 bar")
AXIAL_PRESSURES = ("1 bar", "2 bar", "4 bar")
WHIRL_RATIO = 0.51  # at both thresholds, by the same program
WHIRLING = 0.05  # amplitude over the clearance
ORDERS = ("axial-groove-supply-order", "supply-order", "stiffness-order")  # of all models
THRESHOLDS_Hz = {"jeffcott-table-4-1": 167.4, "jeffcott": 177.2}  # by an independent finite-volume program

HEAD = """# Validation

`cd tests && python -m validation.validate` writes this page; `tests/docs/test_validation.py` checks the most important
rows. Films are of finite length. Half-Sommerfeld films have the default accuracy, run-ups with the penalty and the
two-phase model a target of 3e-3 ([cases](cases.md)). An onset belongs to a whirl of about 0.5X, below 0.65X.

A row with a number in brackets differs, for this reason; the others agree within the rounding or wording of the source.
"""


def printed_rows() -> list[dict[str, Any]]:
    """The rows of thesis-numbers.toml."""
    rows: list[dict[str, Any]] = tomllib.loads((DATA / "thesis-numbers.toml").read_text(encoding="utf-8"))["result"]
    return rows


def measure(folder: Path) -> dict[str, Measured]:
    """All reached rows, by their id. Runs are written to `folder`."""
    rows = chapter6_rows.measure(folder)
    half = half_sommerfeld(folder)
    for name in ORDERS:
        transient = rows.pop(f"{name}-transient")
        text = f"half-Sommerfeld: {half[name].text}; {transient.text}"
        half[name] = Measured(text, holds=half[name].holds and transient.holds)
    return {**half, **rows}


def half_sommerfeld(folder: Path) -> dict[str, Measured]:
    """The rows that are measured with half-Sommerfeld films."""
    runs = {
        name: measures.kept_runup(folder, load_case(name))
        for name in ("jeffcott", "jeffcott-table-4-1", "rigid", "soft-shaft")
    }
    rises = {name: measures.rise(run) for name, run in runs.items()}
    zero = measures.effective_velocity_zero(runs["rigid"])
    stiff = measures.stiffness_thresholds(STIFFNESSES)
    supply = measures.supply_thresholds("jeffcott", PRESSURES)
    axial = measures.supply_thresholds("axial-groove", AXIAL_PRESSURES)
    resting = [
        measures.eccentricity_at_1s(folder, "axial-groove", (f"bearing.supply.pressure={pressure}",))
        for pressure in AXIAL_PRESSURES
    ]
    whirl = measures.smallest_whirl(folder, PRESSURES[-1])

    def risen(name: str) -> Measured:
        found = rises[name]
        return Measured(f"{found.passage_s:.2f} (onset {found.onset_s:.2f})", found.passage_s)

    def critical(name: str) -> Measured:
        return number(measures.first_event(runs[name], "critical-speed", "t_s"), 2)

    return {
        "rigid-bearing-frequency": number(measures.rigid_bearing_frequency(load_case("jeffcott")), 2),
        "critical-speed": critical("jeffcott"),
        "critical-speed-table-4-1": critical("jeffcott-table-4-1"),
        "rise-table-4-1": risen("jeffcott-table-4-1"),
        "rise": risen("jeffcott"),
        "axial-groove-supply-order": Measured(
            f"thresholds {speeds(axial)}, eccentricity {', '.join(f'{value:.3f}' for value in resting)}",
            holds=rising(axial) and rising(resting),
        ),
        "soft-shaft-critical": number(measures.first_event(runs["soft-shaft"], "critical-speed", "speed_Hz"), 1),
        "effective-angular-velocity": Measured(
            f"zero at {zero:.2f} s, jump at {rises['rigid'].passage_s:.2f} s",
            holds=abs(zero - rises["rigid"].passage_s) < 0.1,
        ),
        "stiffness-order": Measured(f"thresholds {speeds(stiff)}", holds=rising(stiff)),
        "supply-order": Measured(
            f"thresholds {speeds(supply)}, at 4 bar a whirl above {whirl:.2f} clearances",
            holds=rising(supply[::-1]) and whirl > WHIRLING,
        ),
    }


def compared(rows: list[dict[str, Any]], measured: dict[str, Measured]) -> list[str]:
    """The table of what is reached, the reasons, and the table of what is not."""
    lines = ["| quantity | where | model there | printed | measured | deviation, % |", "|" + " --- |" * 6]
    found_rows, reasons = [], []
    for row in (row for row in rows if "missing" not in row):
        found = measured[row["id"]]
        printed, deviation, agrees = "order", "", found.holds
        if "printed" in row:
            relative = found.value / row["printed"] - 1.0
            printed, deviation = f"{row['printed']:g}", f"{100 * relative:+.1f}"
            agrees = abs(relative) <= row["tolerance"]
        cells = (row["quantity"], row["where"], row.get("model", ""), printed, found.text, deviation)
        found_rows.append(f"| {' | '.join(cells)} |")
        reasons.append("" if agrees else row.get("note", "no reason known"))
    lines += with_reasons(found_rows, reasons)
    missing = [f"| {row['quantity']} | {row['where']} | {row['missing']} |" for row in rows if "missing" in row]
    if missing:
        lines += ["", "## Not yet reached", "", "| quantity | where | waits for |", "|" + " --- |" * 3, *missing]
    return lines


def independent() -> list[str]:
    """The section on the independent finite-volume program."""
    lines = ["| quantity | theory | expected | measured | deviation | allowed |", "|" + " --- |" * 6]
    for name, expected in THRESHOLDS_Hz.items():
        found = measures.threshold_Hz(load_case(name))
        off = f"{100 * (found / expected - 1):+.2f} %"
        lines.append(f"| linear threshold of `{name}`, Hz | finite | {expected} | {found:.1f} | {off} | 0.5 % |")
        ratio = measures.whirl_ratio(load_case(name))
        off = f"{100 * (ratio / WHIRL_RATIO - 1):+.1f} %"
        lines.append(f"| whirl ratio there | finite | {WHIRL_RATIO:g} | {ratio:.3f} | {off} | two digits |")
    for clearance in ("40", "35"):
        worst = [measures.worst_resting_position(clearance, theory) for theory in ("finite", "short")]
        what = f"static equilibria, {clearance} um, 10 to 200 Hz: eccentricity, attitude"
        off = "; ".join(f"{100 * relative:.3f} %, {degrees:.3f} deg" for relative, degrees in worst)
        lines.append(f"| {what} | finite; short | 5 positions | | {off} | 0.3 %, 0.3 deg |")
    for supply in ("none", "circumferential-groove"):
        off = f"{100 * measures.worst_film_force(supply):.3f} %"
        lines.append(f"| film forces, `{supply}`, eccentricity 0.3 to 0.9 | finite | | | {off} | 0.3 % |")
    return lines


def main(folder: Path) -> None:
    """Measure, and write the page."""
    sections = [
        HEAD,
        "## The dissertation",
        "",
        "Nowald, dissertation, TU Darmstadt 2018. Rotor: Jeffcott, table 6.1; 0 to 300 Hz in 10 s.",
        "The rise is the first passage of an eccentricity of 0.6; at the onset the whirl exceeds 5 % of the clearance.",
        "",
        *compared(printed_rows(), measure(folder)),
        "",
        chapter_7_page.section(folder, PAGE.read_text(encoding="utf-8")),
        *forms.table(),
        "",
        *published.table(),
        "",
        "## An independent program",
        "",
        "Largest deviations from a finite-volume program with mesh refinement and extrapolation.",
        "",
        *independent(),
    ]
    PAGE.write_text("\n".join(sections) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as name:
            main(Path(name))
