"""Options that say where a motion stands in the file of a measurement, and the run that it makes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from frbcli.cli.quantities import LENGTH_OPTION, SPEED_OPTION, QuantityOption

if TYPE_CHECKING:
    from frbcli.analysis.measured import Measurement
    from frbcli.results.store import Run

_GIVEN = "frbcli.measurement"  # in the context of a command
EITHER = (("time", "rate"), ("speed", "speed_at", "tacho"))  # options of which one is enough
_TIME_UNIT, _SPEED_UNIT = QuantityOption("time", "s", "1 ms"), QuantityOption("speed", "Hz", "1 rpm")
Function = TypeVar("Function", bound=Callable[..., Any])


def measured_options(function: Function) -> Function:
    """Give a command the options of a measurement; it receives `measurement: Measurement | None`."""
    named: dict[str, tuple[dict[str, Any], str]] = {
        "x": ({"metavar": "COLUMN"}, "Of a measurement: column of the displacement in x."),
        "y": ({"metavar": "COLUMN"}, "Column of the displacement in y; events need it."),
        "time": ({"metavar": "COLUMN"}, "Column of the times."),
        "rate": ({"type": click.FloatRange(min=0.0, min_open=True)}, "Samples per second, without a column of times."),
        "speed": ({"metavar": "COLUMN"}, "Column of the rotor speed."),
        "speed-at": ({"metavar": "SPEED", "type": SPEED_OPTION}, 'A constant rotor speed, e.g. "100 Hz".'),
        "tacho": ({"metavar": "COLUMN"}, "Column of a signal with pulses, from which the rotor speed follows."),
        "pulses": ({"type": click.IntRange(min=1), "default": 1, "show_default": True}, "Pulses per revolution."),
        "unit": ({"type": LENGTH_OPTION, "default": "1 um", "show_default": True}, "Unit of the displacements."),
        "time-unit": ({"type": _TIME_UNIT, "default": "1 s", "show_default": True}, "Unit of the times."),
        "speed-unit": ({"type": _SPEED_UNIT, "default": "1 Hz", "show_default": True}, "Unit of the rotor speed."),
    }
    told: Any = function
    told = click.option("--clearance", "measurement", metavar="LENGTH", type=LENGTH_OPTION, callback=_measurement,
                        help='Of the bearing, to which levels and events refer, e.g. "35 um".')(told)  # fmt: skip
    for name, (kind, meaning) in reversed(named.items()):  # read before the clearance, which makes one of all
        kind |= {"is_eager": True, "expose_value": False, "callback": _remember}
        told = click.option(f"--{name}", help=meaning, **kind)(told)
    return told  # type: ignore[no-any-return]


def _remember(context: click.Context, option: click.Parameter, value: Any) -> None:
    context.meta.setdefault(_GIVEN, {})[option.name] = value


def _measurement(context: click.Context, _: click.Parameter, clearance: float | None) -> Measurement | None:
    from frbcli.analysis.measured import Measurement

    given = context.meta[_GIVEN]
    if given["x"] is None:
        return None
    if clearance is None:
        words = "A measurement needs --clearance, to which amplitudes refer; a run of frb needs neither that nor --x."
        raise click.UsageError(words)
    for names in EITHER:
        several = [f"--{name.replace('_', '-')}" for name in names if given[name] is not None]
        if len(several) > 1:
            raise click.UsageError(f"{' and '.join(several)} tell the same of the measurement: give one of them.")
    return Measurement(
        x=given["x"],
        clearance=clearance,
        y=given["y"],
        time=given["time"],
        rate=given["rate"],
        speed=given["speed"],
        speed_Hz=given["speed_at"],
        tacho=given["tacho"],
        pulses=given["pulses"],
        unit_m=given["unit"],
        time_unit_s=given["time_unit"],
        speed_unit_Hz=given["speed_unit"],
    )


def run_of(path: Path, measurement: Measurement | None) -> Run:
    """The run in a file: a computed one, or a measurement. Raises as read_run and measured_run do."""
    from frbcli.results.measured import SUFFIXES

    if path.suffix.lower() in SUFFIXES:
        if measurement is None:
            raise click.UsageError(f"{path} is a measurement: say by --x COLUMN where its motion stands.")
        from frbcli.analysis.measured import measured_run

        return measured_run(path, measurement)
    if measurement is not None:
        raise click.UsageError(f"{path} is a run, which needs no --x.")
    from frbcli.results.store import read_run

    return read_run(path)
