"""The measured side of the validation: one function per figure, each from the public functions of frbcli."""

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from paths import rows_of
from scipy.linalg import eigh, null_space

from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.film.gap import whole_width
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.film.rectangles.film_force import FilmData
from frbcli.linear.stability import Stability, stability
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.machine.rotor import make_rotor
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

RISEN = 0.6  # eccentricity beyond which the journal has left its resting position, ...
SETTLED_s = 2.0  # ... after this time: a slow rotor rests there, too
RIGID = "rigid"  # a shaft stiffness
FIRST_SECOND = ("speed.to=30 Hz", "speed.duration=1 s")  # the first tenth of 0 to 300 Hz in 10 s
FIRST_SECONDS = ("speed.to=90 Hz", "speed.duration=3 s")
WINDOW_s = 0.1  # at least one turn of a whirl at half of 30 Hz and more
AXIAL_GROOVE = (
    'bearing.supply={ kind = "axial-grooves", position = "0 deg", opening_angle = "15 deg", pressure = "1 bar" }'
)
TO_600_Hz = "speed.to=600 Hz"


@dataclass(frozen=True)
class Rise:
    """When the eccentricity jumps: first passage of RISEN (NaN if never), and the onset event (NaN if none), in s."""

    passage_s: float
    onset_s: float


def rigid_bearing_frequency(case: Case) -> float:
    """Lowest natural frequency in Hz of the rotor with its journals held."""
    rotor = make_rotor(case)
    free = null_space(rotor.journals.reshape(-1, rotor.size))
    squares = eigh(free.T @ rotor.stiffness @ free, free.T @ rotor.mass @ free, eigvals_only=True)
    return float(np.sqrt(squares[0])) / (2 * math.pi)


def first_event(run: Run, kind: str, key: str) -> float:
    """`key` of the first event of a kind, NaN if there is none."""
    return next((float(event[key]) for event in run.events if event["kind"] == kind), math.nan)


def kept_runup(folder: Path, case: Case) -> Run:
    """The run-up of a case, taken from `folder` if it was run before."""
    key = hashlib.sha256(case.source_text.encode()).hexdigest()[:12]
    return runup(case, folder / f"{case.name}-{key}.h5", resume=True)


def rise(run: Run) -> Rise:
    """When the eccentricity of a run jumps."""
    time = run["time_s"]
    risen = np.flatnonzero((time > SETTLED_s) & (run["eccentricity"] > RISEN))
    passage = float(time[risen[0]]) if len(risen) else math.nan
    return Rise(passage, first_event(run, "onset", "t_s"))


def eccentricity_at_1s(folder: Path, name: str, settings: Sequence[str] = ()) -> float:
    """Eccentricity after the first second of a shipped run-up."""
    return float(kept_runup(folder, load_case(name, (*FIRST_SECOND, *settings)))["eccentricity"][-1])


def threshold_Hz(case: Case) -> float:
    """Linear threshold; 0 for a rotor that is unstable from its lowest speed on, infinite for one that is never."""
    found: Stability = stability(case)
    if found.threshold is not None:
        return found.threshold.speed_Hz
    resting = [point for point in found.sweep if point.films]
    return 0.0 if resting and resting[0].growth > 0.0 else math.inf


def whirl_ratio(case: Case) -> float:
    """Frequency of the whirl over the rotor speed at the linear threshold, NaN if there is none."""
    found = stability(case).threshold
    return math.nan if found is None else found.whirl_ratio


def smallest_whirl(folder: Path, supply: str) -> float:
    """Smallest amplitude of the journal's motion over the clearance in the first three seconds at a supply pressure."""
    case = load_case("jeffcott", (*FIRST_SECONDS, f"bearing.supply.pressure={supply}"))
    run = kept_runup(folder, case)
    motion = (run["journal_x_m"] + 1j * run["journal_y_m"]) / run.references["clearance_m"]
    windows = motion[: len(motion) // (width := round(WINDOW_s / case.output.step)) * width].reshape(-1, width)
    return float(windows.std(axis=1).min())


def effective_velocity_zero(run: Run) -> float:
    """First time in s, once settled, at which omega - 2 delta' of the journal is no longer positive."""
    time = run["time_s"]
    attitude = np.unwrap(np.angle(run["journal_x_m"] + 1j * run["journal_y_m"]))
    effective = 2 * math.pi * run["speed_Hz"] - 2.0 * np.gradient(attitude, time)
    reached = np.flatnonzero((time > SETTLED_s) & (effective <= 0.0))
    return float(time[reached[0]]) if len(reached) else math.nan


def stiffness_thresholds(stiffnesses: Sequence[str]) -> list[float]:
    """Linear thresholds in Hz with an axial groove and shafts of the given stiffnesses, RIGID among them."""
    return [
        threshold_Hz(
            load_case("rigid", (AXIAL_GROOVE, TO_600_Hz))
            if stiffness == RIGID
            else load_case("axial-groove", (f"rotor.shaft_stiffness={stiffness}",))
        )
        for stiffness in stiffnesses
    ]


def supply_thresholds(name: str, pressures: Sequence[str]) -> list[float]:
    """Linear thresholds in Hz of a shipped case at the given supply pressures."""
    return [threshold_Hz(load_case(name, (f"bearing.supply.pressure={p}",))) for p in pressures]


def worst_resting_position(clearance_um: str, theory: str) -> tuple[float, float]:
    """Largest deviation from equilibrium.csv: relative in eccentricity, and in attitude angle in degrees."""
    name = {"40": "jeffcott-table-4-1", "35": "jeffcott"}[clearance_um]
    rows = [row for row in _rows("equilibrium.csv") if (row["clearance_um"], row["theory"]) == (clearance_um, theory)]
    speeds = [float(row["speed_Hz"]) for row in rows]
    points = stability(load_case(name, (f"film.theory={theory}",)), speeds).points
    films = [point.films[0] for point in points]
    pairs = list(zip(films, rows, strict=True))
    relative = max(abs(film.eccentricity / float(row["eccentricity"]) - 1.0) for film, row in pairs)
    degrees = max(abs(film.attitude_deg - float(row["attitude_deg"])) for film, row in pairs)
    return relative, degrees


def worst_film_force(supply: str) -> float:
    """Largest relative deviation of the film forces from film-forces.csv, on the mesh that is planned by default."""
    case = load_case("jeffcott-table-4-1")
    plan = make_plan(case)
    like = make_system(case, plan).films.sections[0]
    if supply == "none":
        like = whole_width(replace(like, far="symmetry"))
    rows = [row for row in _rows("film-forces.csv") if row["supply"] == supply]
    pressures = {row["supply_pressure_bar"] for row in rows}
    gauges = {bar: 0.0 if supply == "none" else float(bar) * 1e5 - like.ambient_pressure for bar in pressures}
    bearings = {bar: replace(like, far_pressure=gauge) for bar, gauge in gauges.items()}
    films = {bar: make_film(bearing, plan.theory, plan.cavitation, plan.mesh) for bar, bearing in bearings.items()}
    return max(_force_error(films[row["supply_pressure_bar"]], like.clearance, row) for row in rows)


def _force_error(film: FilmData, clearance: float, row: dict[str, str]) -> float:
    eccentricity, attitude = float(row["eccentricity"]), math.radians(float(row["attitude_deg"]))
    along = np.array([math.cos(attitude), math.sin(attitude)])
    across = np.array([-along[1], along[0]])
    rate = float(row["eccentricity_rate_1_s"]) * along + float(row["whirl_speed_rad_s"]) * eccentricity * across
    omega = 2 * math.pi * float(row["speed_Hz"])
    force = evaluate(film, clearance, eccentricity * clearance * along, rate * clearance, omega).force
    expected = np.array([float(row["Fx_N"]), float(row["Fy_N"])])
    return float(np.linalg.norm(force - expected) / np.linalg.norm(expected))


def _rows(name: str) -> list[dict[str, str]]:
    return [row for row in rows_of(name) if row["cavitation"] == "half-sommerfeld"]
