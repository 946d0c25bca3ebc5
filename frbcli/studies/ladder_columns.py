"""The columns of a ladder of speed against error: its rungs."""

from __future__ import annotations

from operator import attrgetter, itemgetter
from typing import Any

from frbcli.columns import Column, Shown, named, short_number

RESOLVED = 0.01  # Hz; resolution of the terminal's table


def _film(item: Any) -> str:
    rung = item.rung
    return rung.theory if rung.mesh is None else f"{rung.mesh[0]}x{rung.mesh[1]}"


def _tolerance(value: float) -> str:
    return short_number(value).replace(".0e", "e")


def _difference(value: float) -> str:
    return f"{value:+.2f}" if abs(value) >= RESOLVED else short_number(value)


# Of a Rung
RUNG = (
    Column("theory", "", "theory of the films"),
    Column("cavitation", "", "cavitation model"),
    Column("mesh", "", "elements or cells along and around, none of the short bearing and of bearing models"),
    Column("tolerance", "", "local error of a step", shown=(Shown("tol.", _tolerance),)),
    Column("coupling", "", "coupling of rotor and films"),
)

# Of a RungResult
RESULT = (
    Column("film", "", "short bearing, or elements of a finite one", _film, shown=(Shown("film"),), key="", flat=False),
    *named(RUNG, "", attrgetter("rung")),
    Column("status", "", "how the run ended"),
    Column("cpu", "s", "CPU time", attrgetter("cpu_s"), shown=(Shown("CPU", ".3g"),)),
    Column("eccentricity_largest", "", "largest error of the eccentricity", attrgetter("error.eccentricity_largest"),
           shown=(Shown("max", short_number),), key="error.eccentricity_largest"),
    Column("eccentricity_rms", "", "its root mean square", attrgetter("error.eccentricity_rms"),
           shown=(Shown("rms", short_number),), key="error.eccentricity_rms"),
    Column("until", "s", "end of both errors, where a whirl begins to grow", attrgetter("error.until_s"), key=""),
    Column("window", "s", "their begin and end", lambda item: [0.0, item.error.until_s],
           key="error.window_s", flat=False),
    Column("onset_speed", "Hz", "error of the rotor speed at the onset of whirl", attrgetter("error.onset_Hz"),
           shown=(Shown("onset", _difference),), key="error.onset_speed_Hz"),
    Column("threshold", "Hz", "error of the linear threshold", attrgetter("error.threshold_Hz"),
           shown=(Shown("thr.", _difference),), key="error.threshold_Hz"),
    Column("film_force_relative", "", "relative error of the film forces", attrgetter("error.force_relative"),
           shown=(Shown("force", short_number),), key="error.film_force_relative"),
    Column("stated", "", "error of the eccentricity that the run states", lambda item: item.stated.get("eccentricity"),
           key=""),
    Column("work", "s", "CPU time by the number of film solves, whatever the load of the machine", attrgetter("work_s"),
           key=""),
)  # fmt: skip

# Of a RungResult and whether it is on Pareto's front
LADDER = (
    Column("mark", "", "", lambda item: ("*" if item[0].planned else "") + ("+" if item[1] else ""),
           shown=(Shown(""),), key="", flat=False),
    *named(RESULT, "", itemgetter(0)),
    Column("planned", "", "whether the plan chooses it", lambda item: item[0].planned),
    Column("on_front", "", "whether no cheaper one has a smaller error", itemgetter(1), key="pareto"),
)  # fmt: skip
