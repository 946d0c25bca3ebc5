"""Columns of the result of a kinematic test, and of the moments of a squeeze or a whirl."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from operator import attrgetter, itemgetter
from typing import Any

from frbcli.columns import Column, Columns, Shown, named

FORCES, OIL, GASES = "forces", "oil", "gas"  # tables of the terminal
NO_TORQUE = 1e-15  # N m


def _loads(path: str) -> Callable[[Any], Any]:
    get = attrgetter(path)
    return lambda result: math.nan if result.loads is None else get(result.loads)


def _gas(name: str) -> Callable[[Any], Any]:
    def value(result: Any) -> Any:
        gas = None if result.loads is None else result.loads.gas
        return math.nan if gas is None else getattr(gas, name)

    return value


def _moment(result: Any) -> Any:
    known = result.loads is not None and not math.isnan(result.loads.moment[0])
    return result.loads.moment if known else None


def _force(result: Any) -> Any:
    return None if result.loads is None else result.loads.force


def force_size(result: Any) -> float:
    """The force in N of a KinematicResult, 0 without a solution."""
    return math.hypot(*(_force(result) or (0.0, 0.0)))


def _fixed(vector: Sequence[float], digits: int) -> list[str]:
    """Both components and the size, with decimals that give so many digits to the size; round-off below them is 0."""
    size = math.hypot(*vector)
    decimals = max(0, digits - 1 - math.floor(math.log10(size))) if size > 0.0 else 0
    return [f"{value:.{decimals}f}" for value in (*vector, size)]


def _torque(value: float) -> str:
    """The torque of a journal that does not turn is round-off."""
    return f"{value:.3g}" if abs(value) > NO_TORQUE else "0"


def _angle(result: Any) -> float:
    x, y = _force(result) or (math.nan, math.nan)
    return math.degrees(math.atan2(y, x))


HEAD = (
    Column("cavitation", "", "cavitation model", shown=(
        Shown("cavitation", table=FORCES), Shown("cavitation", table=OIL), Shown("cavitation", table=GASES)
    )),
    Column("theory", "", "of the film: `finite` or `short`"),
    Column("status", "", "`ok` or `not-converged`"),
)

# Of a KinematicResult; of a squeeze or a whirl at the moment of the largest force
RESULT = (
    *HEAD,
    Column("displacement", "", "journal displacement over clearance", shape=(2,)),
    Column("eccentricity", "", "relative eccentricity of the journal", lambda result: math.hypot(*result.displacement),
           shown=(Shown("eps", ".3f", table=FORCES),), key=""),
    Column("force", "N", "force on the journal", _force, shape=(2,),
           shown=(Shown(("Fx", "Fy", "|F|"), partial(_fixed, digits=3), table=FORCES),)),
    Column("sommerfeld_number", "", "Sommerfeld number (3.14)", shown=(Shown("So", ".3g", table=FORCES),), key=""),
    Column("force_angle", "deg", "angle of the force from the x-axis", _angle,
           shown=(Shown("angle", "{:.0f}°".format, table=FORCES),), key=""),
    Column("p_max", "Pa", "largest absolute pressure", _loads("p_max"), shown=(Shown("p_max", ".4g", "bar", FORCES),)),
    Column("p_min", "Pa", "smallest absolute pressure", _loads("p_min"), shown=(Shown("p_min", ".4g", "bar", OIL),)),
    Column("torque_journal", "N m", "torque on the journal", _loads("torque.journal"),
           shown=(Shown("torque", _torque, table=OIL),)),
    Column("torque_shell", "N m", "torque on the shell", _loads("torque.shell")),
    Column("oil_fraction", "", "mean oil fraction (4.46)", _loads("oil_fraction"),
           shown=(Shown("oil", ".3f", table=OIL),)),
    Column("oil_in", "m^3/s", "incoming oil", _loads("oil.in_m3_s"), shown=(Shown("in", ".4g", "mm^3/s", OIL),),
           key="oil_balance.in_m3_s"),
    Column("oil_out", "m^3/s", "leaving oil", _loads("oil.out_m3_s"), shown=(Shown("out", ".4g", "mm^3/s", OIL),),
           key="oil_balance.out_m3_s"),
    Column("oil_defect_relative", "", "lost oil (negative: created) over the flow",
           _loads("oil.defect_relative"), shown=(Shown("balance", ".0e", table=OIL),),
           key="oil_balance.defect_relative"),
    Column("force_error_relative", "", "relative error: from half the cells, or of a short bearing "
                                       "from the finite one", attrgetter("force_error"), key="error.force_relative"),
    Column("temperature", "K", "temperature of the film", lambda result: math.nan if result.heat is None
           else float(result.heat.temperatures[0]), key=""),
    Column("viscosity", "Pa s", "viscosity of its oil", attrgetter("plan.section.viscosity"), key=""),
    Column("cpu", "s", "CPU time", attrgetter("cpu_s"), shown=(Shown("CPU", ".1f", table=OIL),), key="cost.cpu_s"),
    Column("unknowns", "", "number of unknowns", key="cost.unknowns"),
    Column("newton_iterations", "", "Newton steps", key="cost.newton_iterations"),
)  # fmt: skip

# Of a KinematicResult whose journal tilts, or of a rotation whose velocity is given
MOMENT = (
    Column("moment", "N m", "moment about x, y through the middle", _moment,
           shape=(2,), shown=(Shown(("Mx", "My"), lambda moment: _fixed(moment, 4)[:2], table=FORCES),)),
    Column("moment_error_relative", "", "relative error, from half the cells",
           attrgetter("moment_error"), key="error.moment_relative"),
)  # fmt: skip


# Of a KinematicResult of a test with a model whose oil carries gas
GAS = (
    Column("free_gas", "", "mean free gas over oil, at saturation pressure", _gas("share"),
           shown=(Shown("free gas", ".4f", table=GASES),), key="gas_balance.free"),
    Column("gas_in", "m^3/s", "incoming free gas at saturation pressure", _gas("in_m3_s"),
           shown=(Shown("in", ".4g", "mm^3/s", GASES),), key="gas_balance.in_m3_s"),
    Column("gas_out", "m^3/s", "leaving free gas", _gas("out_m3_s"),
           shown=(Shown("out", ".4g", "mm^3/s", GASES),), key="gas_balance.out_m3_s"),
    Column("gas_released", "m^3/s", "gas that leaves the solution, net", _gas("released_m3_s"),
           shown=(Shown("released", ".4g", "mm^3/s", GASES),), key="gas_balance.released_m3_s"),
    Column("gas_defect_relative", "", "defect over all gas of the oil",
           _gas("defect_relative"), shown=(Shown("balance", ".0e", table=GASES),), key="gas_balance.defect_relative"),
)  # fmt: skip


def result_columns(moment: bool, gas: bool) -> Columns:
    """Columns of a KinematicResult; moment: whether it states the moment of the force, gas: the balance of its gas."""
    return (*RESULT, *(MOMENT if moment else ()), *(GAS if gas else ()))


# Of a History: whole in JSON, moment by moment in pandas
HISTORY = (
    Column("time", "s", "time", attrgetter("time_s"), key="t_s"),
    Column("displacement", "", "journal displacement over clearance", shape=(2,), key=""),
    Column("force", "N", "force on the journal", shape=(2,), key="force_history_N"),
    Column("probe_pressure", "Pa", "absolute, at the bottom, a quarter of the width from the end"),
    Column("gap_ratio", "", "gap there over the clearance"),
)

# Of a History of a test whose journal tilts
MOMENT_HISTORY = (Column("moment", "N m", "moment of the force about x, y", shape=(2,), key="moment_history_N_m"),)


def history_columns(moment: bool) -> Columns:
    """Columns of a History; moment: see result_columns."""
    return (*HISTORY, *(MOMENT_HISTORY if moment else ()))


def _at_moment(column: Column) -> Column:
    def value(item: Any) -> Any:
        result, moment = item
        return None if result.history is None else column.value_of(result.history)[moment]

    return replace(column, value=value)


def moment_columns(moment: bool) -> Columns:
    """Columns of a KinematicResult and the number of a moment; moment: see result_columns."""
    return (*named(HEAD, "", itemgetter(0)), *map(_at_moment, history_columns(moment)))


# Of a StribeckCurve, whole in JSON
STRIBECK = tuple(
    replace(column, key=f"stribeck.{column.quantity}" + ("_Hz" if column.unit else ""), flat=False)
    for column in (
        Column("speed", "Hz", "speed of the journal"),
        Column("friction_coefficient", "", "`mu = |T| / (R F)`"),
        Column("asperity_share", "", "share of the load that asperities carry"),
    )
)


def error_column(largest: float) -> Column:
    """The error of a force over the largest one of a table in N: a force that nearly vanishes has a large relative
    error, which means nothing among larger forces."""
    return Column(
        "error", "", "error of the force over the largest |F| of the table: from half the cells, of a short bearing "
        "from the finite one",
        lambda result: result.force_error * force_size(result) / largest if largest > 0.0 else math.nan,
        shown=(Shown("err.", ".0e", table=FORCES),), key="", flat=False,
    )  # fmt: skip
