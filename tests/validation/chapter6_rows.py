"""The rows of docs/validation.md on chapter 6 with the penalty and the two-phase model, by their id.

Onsets are those of run-ups: when the whirl exceeds 5 % of the clearance.
"""

import itertools
from pathlib import Path

from frbcli.case.reading.load import load_case
from validation.chapter6 import RunUp, at_rest, eccentricity, held, largest_pressure_bar, run_up, slow_onset
from validation.measured import Measured, listed, number, rises
from validation.measures import eccentricity_at_1s, threshold_Hz

CIRCUMFERENTIAL, AXIAL, RIGID = "jeffcott-two-phase", "axial-groove-two-phase", "rigid-two-phase"
RIGID_AXIAL = "rigid-axial-groove"
PENALTY, TWO_PHASE = "film.cavitation=penalty", "film.cavitation=two-phase"
MODELS = {"penalty": PENALTY, "two-phase": TWO_PHASE}
BATH = "bearing.ends=oil-bath"
TWO_BAR = "bearing.supply.pressure=2 bar"
SOFT = "rotor.shaft_stiffness=1000 N/mm"
PUBLISHED = "film.two-phase.form=published"
STEEPNESSES = (0.9, 0.99, 0.999)
SAME = 0.01  # relative difference of thresholds that are called the same
CLOSE = 0.01  # of eccentricities that are called almost identical
AT_ONCE_s = 1.5
UNBALANCES = ("3 g*mm", "25 g*mm", "50 g*mm")


def measure(folder: Path) -> dict[str, Measured]:
    """All rows of this file. Runs are written to `folder`, or taken from it."""
    circumferential = _supplied(folder, CIRCUMFERENTIAL, {1: 7, 2: 6, 3: 4, 4: 3})
    axial = _supplied(folder, AXIAL, {1: 8, 2: 8, 4: 10})
    return {
        **_like_penalty(folder, circumferential["penalty"][0], axial["penalty"]),
        **_steepness(folder, circumferential),
        **_rigid(folder),
        **_pressures(),
        **_stiffness(folder, axial),
        **_unbalance(folder, axial),
        "axial-groove-supply-order-transient": _axial_order(axial),
        "supply-order-transient": _circumferential_order(circumferential),
    }


def _supplied(folder: Path, case: str, until_s: dict[int, float]) -> dict[str, list[RunUp]]:
    """Run-ups by model, at each supply pressure in bar until a time after the onset."""
    return {
        name: [run_up(folder, case, end, model, f"bearing.supply.pressure={bar} bar") for bar, end in until_s.items()]
        for name, model in MODELS.items()
    }


def _like_penalty(folder: Path, run: RunUp, axial: list[RunUp]) -> dict[str, Measured]:
    """Where half-Sommerfeld and penalty are compared, and the numbers that are printed for the penalty model."""
    near = ("speed.from=160 Hz", "speed.to=200 Hz")
    half, penalty = threshold_Hz(load_case("jeffcott", near)), threshold_Hz(load_case("jeffcott", (PENALTY, *near)))
    halves = eccentricity_at_1s(folder, "jeffcott")
    bath = eccentricity_at_1s(folder, "jeffcott", (PENALTY,))

    free = [run.eccentricities[0] for run in axial]

    def resting(case: str, bar: int, words: str) -> Measured:
        supply = f"bearing.supply.pressure={bar} bar"
        absolute = eccentricity_at_1s(folder, case, (PENALTY, supply))
        other = eccentricity_at_1s(folder, case, (PENALTY, "film.penalty.pressure=dimensionless", supply))
        return Measured(f"{absolute:.3f} ({words}; dimensionless {other:.3f})", absolute)

    return {
        "critical-speed-penalty": number(run.critical_s, 2),
        "rise-penalty": Measured(f"{run.passage_s:.2f} (onset {run.onset_s:.2f})", run.passage_s),
        "same-threshold": Measured(
            f"thresholds {half:.1f}, {penalty:.1f} Hz; oil bath, 1 s: {halves:.3f}, {bath:.3f}",
            holds=abs(half / penalty - 1.0) < SAME and halves > bath,
        ),
        "eccentricity-1bar": resting(CIRCUMFERENTIAL, 1, "free to air"),
        "axial-groove-eccentricity-1bar": resting("axial-groove", 1, f"oil bath; free to air {free[0]:.3f}"),
        "axial-groove-eccentricity-2bar": resting("axial-groove", 2, f"oil bath; free to air {free[1]:.3f}"),
        "eccentricity-2bar": resting(CIRCUMFERENTIAL, 2, "free to air"),
        "largest-pressure-1bar": _held_pressure(0.485),
        "largest-pressure-2bar": _held_pressure(0.393, TWO_BAR),
    }


def _with(value: float, digits: int, words: str) -> Measured:
    return Measured(f"{value:.{digits}f} ({words})", value)


def _held_pressure(eccentricity: float, *settings: str) -> Measured:
    air = largest_pressure_bar(held(CIRCUMFERENTIAL, eccentricity, 30.0, PENALTY, *settings))
    bath = largest_pressure_bar(held(CIRCUMFERENTIAL, eccentricity, 30.0, PENALTY, BATH, *settings))
    return Measured(f"{bath:.2f} oil bath, {air:.2f} free to air", bath)


def _steepness(folder: Path, circumferential: dict[str, list[RunUp]]) -> dict[str, Measured]:
    """x_1 and the ends of the bearing, at a supply of ambient pressure."""
    penalty, steep = circumferential["penalty"][0], circumferential["two-phase"][0]
    low = run_up(folder, CIRCUMFERENTIAL, 6, "film.two-phase.steepness=0.9")
    steep_bath = run_up(folder, CIRCUMFERENTIAL, 6, BATH)
    low_bath = run_up(folder, CIRCUMFERENTIAL, 7, "film.two-phase.steepness=0.9", BATH)
    onsets = [low.onset_s, steep.onset_s, penalty.onset_s]
    published = [
        eccentricity(at_rest(CIRCUMFERENTIAL, 30.0, PUBLISHED, f"film.two-phase.steepness={x}")) for x in STEEPNESSES
    ]
    resting = eccentricity(at_rest(CIRCUMFERENTIAL, 30.0, PENALTY))
    conserving = [low.eccentricities[0], steep.eccentricities[0]]
    bath = [eccentricity(at_rest(CIRCUMFERENTIAL, 120.0, BATH, model)) for model in (PUBLISHED, PENALTY)]
    return {
        "steepness-limit": Measured(
            f"{listed(published, '.3f')} for x_1 = 0.9, 0.99, 0.999; penalty {resting:.3f}",
            holds=abs(published[-1] / resting - 1.0) < CLOSE and rises(published),
        ),
        "steepness-below": Measured(
            f"published {listed(published[:2], '.3f')}, penalty {resting:.3f}; "
            f"conservative at 1 s {listed(conserving, '.3f')}, penalty {penalty.eccentricities[0]:.3f}",
            holds=published[0] > published[1] > resting and conserving[0] > conserving[1],
        ),
        "two-phase-below-penalty": Measured(
            f"onset {listed(onsets, '.2f')} s for x_1 = 0.9, 0.99, penalty", holds=max(onsets[:2]) < onsets[2]
        ),
        "steepness-lowest": Measured(
            f"onset {listed(onsets[:2], '.2f')} s for x_1 = 0.9, 0.99", holds=onsets[0] < onsets[1]
        ),
        "oil-bath-close-to-penalty": Measured(
            f"120 Hz: {listed(bath, '.4f')} with penalty; "
            f"conservative at 4 s {steep_bath.eccentricities[-1]:.3f}, onset {steep_bath.onset_s:.2f} s",
            holds=abs(bath[0] / bath[1] - 1.0) < CLOSE,
        ),
        "oil-bath-higher": Measured(
            f"onset {listed(onsets[:2], '.2f')} s, oil bath {low_bath.onset_s:.2f}, {steep_bath.onset_s:.2f} s",
            holds=low.onset_s < low_bath.onset_s and steep.onset_s < steep_bath.onset_s,
        ),
    }


def _rigid(folder: Path) -> dict[str, Measured]:
    onsets = [run_up(folder, RIGID, 10, PENALTY).onset_s, run_up(folder, RIGID, 8, TWO_PHASE).onset_s]
    return {
        "rigid-two-phase-below-penalty": Measured(
            f"onset {onsets[0]:.2f} s penalty, {onsets[1]:.2f} s two-phase, conservative", holds=onsets[1] < onsets[0]
        )
    }


def _pressures() -> dict[str, Measured]:
    """Largest pressures at 4 s, in both forms of the model."""
    rows = {}
    for row, ends in (("two-phase-pressure-air", "bearing.ends=free-to-air"), ("two-phase-pressure-bath", BATH)):
        published = largest_pressure_bar(at_rest(CIRCUMFERENTIAL, 120.0, PUBLISHED, ends))
        conserving = largest_pressure_bar(at_rest(CIRCUMFERENTIAL, 120.0, ends))
        rows[row] = _with(published, 2, f"conservative {conserving:.2f}")
    return rows


def _axial_order(axial: dict[str, list[RunUp]]) -> Measured:
    onsets = {model: [run.onset_s for run in runs] for model, runs in axial.items()}
    eccentric = {model: [run.eccentricities[0] for run in runs] for model, runs in axial.items()}
    text = "; ".join(
        f"{model}: onset {listed(onsets[model], '.2f')} s, eccentricity {listed(eccentric[model], '.3f')}"
        for model in MODELS
    )
    return Measured(text, holds=all(rises(onsets[m]) and rises(eccentric[m]) for m in MODELS))


def _circumferential_order(circumferential: dict[str, list[RunUp]]) -> Measured:
    onsets = {model: [run.onset_s for run in runs] for model, runs in circumferential.items()}
    text = "; ".join(f"{model}: onset {listed(onsets[model], '.2f')} s" for model in MODELS)
    falls = all(a >= b for each in onsets.values() for a, b in itertools.pairwise(each))
    return Measured(text, holds=falls and all(each[0] > each[-1] < AT_ONCE_s for each in onsets.values()))


def _stiffness(folder: Path, axial: dict[str, list[RunUp]]) -> dict[str, Measured]:
    soft = {m: run_up(folder, AXIAL, 5, model, SOFT) for m, model in MODELS.items()}
    rigid = {m: run_up(folder, RIGID_AXIAL, 10, model) for m, model in MODELS.items()}
    onsets = {m: [soft[m].onset_s, axial[m][0].onset_s, rigid[m].onset_s] for m in MODELS}
    gaps = [abs(a - b) for a, b in zip(*onsets.values(), strict=True)]
    slow = [
        [slow_onset(folder, name, *range_Hz, model, *settings) for model in MODELS.values()]
        for name, range_Hz, settings in ((AXIAL, (105.0, 145.0), (SOFT,)), (RIGID_AXIAL, (205.0, 250.0), ()))
    ]
    apart = [abs(a / b - 1.0) for a, b in slow]
    text = "; ".join(f"{model}: onset {listed(onsets[model], '.2f')} s" for model in MODELS)
    return {
        "stiffness-order-transient": Measured(text, holds=all(rises(each) for each in onsets.values())),
        "stiffness-difference": Measured(
            f"onsets apart by {gaps[0]:.2f} s, {gaps[2]:.2f} s rigid; in a ramp of 5 Hz/s "
            f"at {listed(slow[0], '.1f')} Hz, {listed(slow[1], '.1f')} Hz",
            holds=gaps[0] < gaps[2] and apart[0] < apart[1],
        ),
    }


def _unbalance(folder: Path, axial: dict[str, list[RunUp]]) -> dict[str, Measured]:
    runs = {
        m: [axial[m][0], *(run_up(folder, AXIAL, 8, model, f"rotor.unbalance={u}") for u in UNBALANCES[1:])]
        for m, model in MODELS.items()
    }
    onsets = {m: [run.onset_s for run in each] for m, each in runs.items()}
    amplitudes = {m: [run.amplitude for run in each] for m, each in runs.items()}
    penalty = onsets["penalty"]
    return {
        "unbalance-order": Measured(
            "; ".join(f"{m}: onset {listed(onsets[m], '.2f')} s" for m in MODELS),
            holds=rises(onsets["two-phase"]) and penalty[0] < penalty[1] and penalty[2] < penalty[0],
        ),
        "unbalance-amplitude": Measured(
            "; ".join(f"{m}: {listed(amplitudes[m], '.3f')} clearances" for m in MODELS),
            holds=all(rises(each) for each in amplitudes.values())
            and all(a < b for a, b in zip(amplitudes["penalty"], amplitudes["two-phase"], strict=True)),
        ),
    }
