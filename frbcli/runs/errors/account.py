"""The cost and the errors of a run, in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from frbcli.results.columns import event_name
from frbcli.results.store import Run
from frbcli.runs.errors.second_run import SECOND_RUN, SECOND_RUN_PREDICTED
from frbcli.scene.cost import clock
from frbcli.units import HERTZ, SpeedUnit

LATE = 0.5  # of the time until which the error is stated: from then on its growth is reported
SLOW_WORDS = (
    ("ring_speed_uncertainty_Hz", "ring speeds", " Hz"),
    ("temperature_uncertainty_K", "temperatures", " K"),
    ("power_uncertainty_W", "losses", " W"),
    ("oil_fraction_uncertainty", "oil fractions", ""),
)


def account(run: Run) -> list[tuple[str, str, str]]:
    """Rows of a table, what and how much and a remark: cost, oil that passed, heat, wear, stated errors."""
    cost, error = run.cost, run.error
    film = error.get("film_force_relative")
    in_films = "length_m" not in run.references

    def kept(row: tuple[str, str, str]) -> list[tuple[str, str, str]]:
        """A row about films, if a bearing has one."""
        return [row] if in_films else []

    against = "against a finer mesh" if error.get("model_relative") is None else "of the short-bearing theory"
    return [
        ("CPU time", f"{cost['cpu_s']:.3g} s", _predicted(cost)),
        *_compiled(cost),
        (
            "steps",
            f"{cost['steps']}",
            f"{cost['steps_per_revolution']:.3g} per revolution, {cost['rejected_steps']} rejected",
        ),
        *kept(("film solves", f"{cost['film_solves']}", f"{1e3 * cost['ms_per_film_solve']:.3g} us each")),
        *_oil_rows(run),
        *_heat_rows(run),
        *_wear_rows(run),
        *_second_run(cost),
        *kept(("CPU time of the error", f"{cost.get('error_cpu_s', 0.0):.3g} s", "films on other meshes")),
        ("error, time integration", f"{error['time_integration']:.1e}", _of(run)),
        *kept(("error, film forces", "-" if film is None else f"{film:.1e}", f"relative, {against}")),
        *_error_rows(error),
    ]


def about_certainty(
    events: Sequence[Mapping[str, Any]], cost: Mapping[str, Any], unit: SpeedUnit = HERTZ
) -> list[str]:
    """Sentences on the uncertainties of the events of a run: which events are not certain and why, or what it would
    cost to know. events: with the names of their whirls; unit: of rotor speeds."""
    if SECOND_RUN in cost and any(event.get("certain") is None for event in events):
        return ["No uncertainties of the events: the machine does not begin to run on fewer cells."]
    if SECOND_RUN in cost:
        return [
            f"Not certain: {event_name(event)} at {unit.words(event['speed_Hz'])}: {event['reason']}."
            for event in events
            if event.get("certain") is False
        ]
    if not events or SECOND_RUN_PREDICTED not in cost:
        return []
    return [f"No uncertainties of the events: they take about {clock(cost[SECOND_RUN_PREDICTED])} with --uncertainty."]


def _of(run: Run) -> str:
    """The quantity that the error of the time integration is of."""
    if "length_m" not in run.references:
        return "of the eccentricity, whole run"
    return f"of displacements, over {1e6 * run.references['length_m']:.4g} um, whole run"


def _compiled(cost: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """What a first start takes in addition to the run."""
    spent = cost.get("compile_cpu_s", 0.0)
    return [("CPU time of compiling", f"{spent:.3g} s", "once: kernels are kept")] if spent > 0.0 else []


def _second_run(cost: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    if SECOND_RUN not in cost:
        return []
    return [("CPU time of uncertainties", f"{cost[SECOND_RUN]:.3g} s", "second, coarser run")]


def _oil_rows(run: Run) -> list[tuple[str, str, str]]:
    """Oil that passed mass-conserving films."""
    if "oil_in_m3" not in run.cost:
        return []
    came, left = (1e9 * run.cost[name] for name in ("oil_in_m3", "oil_out_m3"))
    off = run.error.get("oil_balance_relative")
    defect = "" if off is None else f", unaccounted for {off:.0e}"
    if "oil_created_m3" in run.cost:
        made = 1e9 * run.cost["oil_created_m3"]
        defect = f", {made:.3g} mm^3 created" if made >= 0.0 else f", {-made:.3g} mm^3 destroyed"
    return [("oil", f"{came:.3g} mm^3 in", f"{left:.3g} mm^3 out{defect}")]


def _heat_rows(run: Run) -> list[tuple[str, str, str]]:
    """Where the heat of the films went, of one bearing each."""
    if "heat_dissipated_J" not in run.cost:
        return []
    whole, oil, walls, kept = (run.cost[f"heat_{name}_J"] for name in ("dissipated", "carried", "into_walls", "kept"))
    off = run.error.get("heat_balance_relative")
    defect = "" if off is None else f", unaccounted for {off:.0e}"
    of_walls = f"{walls:.4g} J into" if walls >= 0.0 else f"{-walls:.4g} J out of"
    parts = f"{oil:.4g} J with the oil, {of_walls} shaft and housing, {kept:.4g} J kept"
    return [("heat", f"{whole:.4g} J", f"{parts}{defect}")]


def _wear_rows(run: Run) -> list[tuple[str, str, str]]:
    """The largest depth that a shell has lost, of one bearing."""
    if "wear_depth_m" not in run.cost:
        return []
    depth, angle = 1e9 * run.cost["wear_depth_m"], run.cost["wear_angle_deg"]
    return [("wear, an estimate", f"{depth:.3g} nm", f"by Archard, of a shell at phi = {angle:.0f} deg")]


def _predicted(cost: dict[str, Any]) -> str:
    """The prediction of the plan, which runs of earlier versions lack."""
    return f"predicted {cost['predicted_cpu_s']:.2g} s" if "predicted_cpu_s" in cost else ""


def grows_late(error: Mapping[str, Any]) -> str:
    """Words on an error that arises late, "" of any other."""
    late_s = error.get("error_grows_from_s") or 0.0
    late = late_s > LATE * error.get("quiet_until_s", math.inf)
    return f", two thirds of it after {late_s:.3g} s" if late else ""


def _error_rows(error: dict[str, Any]) -> list[tuple[str, str, str]]:
    """The parts of the error that not every run has."""
    rows = [
        (f"uncertainty, {words}", f"{error[key]:.2g}{unit}", "means of a hundredth of the run")
        for key, words, unit in SLOW_WORDS
        if error.get(key) is not None
    ]
    if error.get("modal_reduction") is not None:
        rows.append(("error, modal reduction", f"{error['modal_reduction']:.1e}", "of the natural frequencies"))
    if error.get("modal_reduction_amplitude") is not None:
        rows.append(("", f"{error['modal_reduction_amplitude']:.1e}", "of the heights of peaks at critical speeds"))
    if error.get("eccentricity") is not None:
        until = f"total, until {error['quiet_until_s']:.3g} s{grows_late(error)}"
        rows.append(("error of the eccentricity", f"{error['eccentricity']:.1e}", until))
    return rows
