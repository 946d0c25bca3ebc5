"""Time signals from Universal Files (UFF), their data sets 58, by the library pyuff."""

from __future__ import annotations

import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.errors import input_error
from frbcli.results.measured.columns import Columns

FUNCTION, TIME_RESPONSE = 58, 1  # data set "function at nodal DOF", and its functions of time
DIRECTIONS = {0: "", 1: "+X", -1: "-X", 2: "+Y", -2: "-Y", 3: "+Z", -3: "-Z",
              4: "+RX", -4: "-RX", 5: "+RY", -5: "-RY", 6: "+RZ", -6: "-RZ"}  # fmt: skip
NO_UNIT = ("", "NONE", "UNKNOWN")
TIME = "time"
SAME = 1e-6  # of a step of time


def read_uff(path: Path) -> Columns:
    """The times as `time`, and the responses over time, named by node and direction as "12:+X"; of several with one
    name the second one as "12:+X.2", and so on.

    Raises InputError where pyuff is not installed, ValueError if there is no response over time.
    """
    if find_spec("pyuff") is None:
        remedy = "pip install frbcli[uff], or write the file as CSV or MAT."
        raise input_error(f"measurement {path}", "file", "", "needs the library pyuff.", remedy)
    import pyuff

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of data sets of other kinds
        file = pyuff.UFF(str(path))
        places = [place for place, kind in enumerate(file.get_set_types()) if kind == FUNCTION]
        found = [file.read_sets(place) for place in places]
    responses = [one for one in found if one.get("func_type") == TIME_RESPONSE]
    if not responses:
        kinds = sorted({int(kind) for kind in file.get_set_types()})
        raise ValueError(f"it has no response over time (data set 58, function 1), but the data sets {kinds}")
    times = np.asarray(responses[0]["x"], dtype=np.float64)
    values: dict[str, Array] = {TIME: times}
    units: dict[str, str] = {}
    doubtful: dict[str, str] = {}
    for response in responses:
        name = _name(response, values.keys() | doubtful.keys())
        if np.iscomplexobj(response["data"]):
            doubtful[name] = "holds complex numbers"
        elif not _same(times, np.asarray(response["x"], dtype=np.float64)):
            doubtful[name] = "has other times than the first response of the file"
        else:
            values[name] = np.asarray(response["data"], dtype=np.float64)
        unit = str(response.get("ordinate_axis_units_lab", "")).strip()
        if unit.upper() not in NO_UNIT:
            units[name] = unit
    return Columns(path, values, None, units, None, doubtful)


def _name(response: dict[str, Any], taken: set[str]) -> str:
    node, direction = int(response["rsp_node"]), DIRECTIONS.get(int(response["rsp_dir"]), "")
    name = f"{node}:{direction}" if direction else f"{node}"
    return next(each for each in (name, *(f"{name}.{k}" for k in range(2, len(taken) + 3))) if each not in taken)


def _same(times: Array, others: Array) -> bool:
    if len(times) != len(others) or len(times) < 2:
        return False
    return bool(np.max(np.abs(times - others)) <= SAME * abs(times[1] - times[0]))
