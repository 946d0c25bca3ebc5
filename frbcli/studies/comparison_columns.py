"""The columns of a comparison of models."""

from __future__ import annotations

import math
from collections.abc import Callable
from operator import attrgetter
from typing import Any

from frbcli.columns import ZERO_CELSIUS, Column, Shown, uncertain_speed
from frbcli.results.columns import uncertain_pair

MODELS, COUPLINGS = "models", "couplings"  # tables of the terminal


def _event(kind: str, key: str) -> Callable[[Any], float]:
    def value(result: Any) -> float:
        event = result.first(kind)
        return math.nan if event is None or event.get(key) is None else event[key]

    return value


def _uncertain(kind: str) -> Callable[[Any], tuple[float, float | None] | None]:
    """The speed of an event with its uncertainty, where the run has one."""
    return lambda result: None if result.first(kind) is None else uncertain_pair(result.first(kind))


def _of(account: str, key: str) -> Callable[[Any], Any]:
    """From the cost or the error of a run; NaN where the run does not state it."""
    return lambda result: getattr(result.run, account).get(key, math.nan)


def _rough(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e+")


def _coupling(name: str) -> str:
    return name.replace("-semi", "-\nsemi")


# Of a VariantResult
VARIANT = (
    Column("name", "", "", attrgetter("variant.name"), shown=(Shown("films", table=MODELS),), key="", flat=False),
    Column("cavitation", "", "cavitation model", attrgetter("variant.cavitation")),
    Column("theory", "", "theory of the films", attrgetter("variant.theory")),
    Column("coupling", "", "coupling of rotor and films", attrgetter("variant.coupled"),
           shown=(Shown("coupling", _coupling, table=COUPLINGS),)),
    Column("status", "", "how the run ended", attrgetter("run.status")),
    Column("t_end", "s", "when it ended", attrgetter("run.t_end_s"), key=""),
    Column("events", "", "events of the run", attrgetter("run.events"), flat=False),
    Column("critical_speed", "Hz", "rotor speed at resonance", _event("critical-speed", "speed_Hz"), key=""),
    Column("critical_speed", "", "rotor speed at resonance", _uncertain("critical-speed"), key="", flat=False,
           shown=(uncertain_speed("crit.", table=MODELS, unit="Hz"),)),
    Column("onset_speed", "Hz", "rotor speed at the onset of whirl", _event("onset", "speed_Hz"), key=""),
    Column("onset_speed", "", "rotor speed at the onset of whirl", _uncertain("onset"), key="", flat=False,
           shown=tuple(uncertain_speed("onset", table=table, unit="Hz") for table in (MODELS, COUPLINGS))),
    Column("onset_speed_uncertainty", "Hz", "its uncertainty",
           _event("onset", "speed_uncertainty_Hz"), key=""),
    Column("onset_frequency_ratio", "", "whirl ratio there", _event("onset", "frequency_ratio"), key="",
           shown=(Shown("ratio", ".3f", table=MODELS),)),
    Column("deviation_largest", "", "largest deviation from the first row before a whirl",
           attrgetter("deviation.largest"), key="deviation.eccentricity_largest",
           shown=(Shown("max", ".3f", table=MODELS), Shown("max", ".1e", table=COUPLINGS))),
    Column("deviation_rms", "", "its root mean square", attrgetter("deviation.rms"),
           key="deviation.eccentricity_rms", shown=(Shown("rms", ".3f", table=MODELS),)),
    Column("deviation_until", "s", "end of both", attrgetter("deviation.until_s"), key="deviation.until_s"),
    Column("cost", "", "cost of the run", attrgetter("run.cost"), flat=False),
    Column("error", "", "stated errors", attrgetter("run.error"), flat=False),
    Column("film_force_relative", "", "stated error", _of("error", "film_force_relative"), key=""),
    Column("eccentricity_error", "", "stated error of the eccentricity before a whirl", _of("error", "eccentricity"),
           key="", shown=(Shown("err.", _rough, table=MODELS),), more="over the clearance"),
    Column("ms_per_step", "", "CPU time of a (micro) step in ms", key="",
           shown=(Shown("ms/step", ".2g", table=COUPLINGS),)),
    Column("micro_steps_per_macro_step", "", "micro steps per macro step", _of("cost", "micro_steps_per_macro_step"),
           key="", shown=(Shown("micro", ".2f", table=COUPLINGS),)),
    Column("simulated_ms_per_hour", "", "simulated time in ms per hour", _of("cost", "simulated_ms_per_hour"), key="",
           shown=(Shown("ms/h", ".2g", table=COUPLINGS),)),
    Column("cpu", "s", "CPU time", _of("cost", "cpu_s"), key="",
           shown=(Shown("CPU", ".2f", table=MODELS), Shown("CPU", ".3g", table=COUPLINGS))),
)  # fmt: skip


def _joined(form: str) -> Callable[[Any], str]:
    return lambda values: ", ".join(form.format(value) for value in values) or "-"


# Of a VariantResult with heat, at the end of its run
HEAT = (
    Column("name", "", "", attrgetter("variant.name"), shown=(Shown("films"),), key="", flat=False),
    Column("thermal", "", "model of heat", attrgetter("variant.thermal")),
    Column("ring_speed_ratios", "", "speeds of the rings over the rotor speed", attrgetter("ring_ratios"),
           shown=(Shown("ring over rotor", lambda ratios: _joined("{:.4f}")(ratios.values())),), flat=False),
    Column("loss", "W", "power that all films take", shown=(Shown("loss, W", ".4g"),)),
    Column("temperatures", "", "", lambda result: [value - ZERO_CELSIUS for value in result.temperatures_K],
           shown=(Shown("films, degC", _joined("{:.1f}")),), key="", flat=False),
)  # fmt: skip
