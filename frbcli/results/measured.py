"""Measured files of all kinds, read as columns of numbers; Universal Files by the library pyuff, their data sets 58.

Columns of numbers from MAT files: up to version 7 by scipy, version 7.3, which is HDF5, by h5py.
"""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.errors import InputError, printable
from frbcli.results.delimited import MOST_COLUMNS, DelimitedTable, NoTable, read_table, seconds
from frbcli.results.measured_columns import LARGEST_FILE, Columns, is_interval, wrong_file
from frbcli.results.records import MOST_SAMPLES
from frbcli.results.write import Unreadable, require_file

Numbers = NDArray[Any]
Leaf = tuple[str, "Numbers | str"]  # name and values in MATLAB's shape, or what they are where they are no numbers

GROUPED = r"[+-]?\d{1,3}(?:[,' ]\d{3})+(?:\.\d*)?|[+-]?\d{1,3}(?:\.\d{3})+,\d*"  # 1,200.5 or 1.200,5
DEEPEST = 8  # structs within structs
MOST_VARIABLES = 10_000
OBJECT = "is an object of MATLAB, such as a table: save its columns as vectors, e.g. x = T.x"
MATLAB_CLASS, EMPTY, SPARSE = "MATLAB_class", "MATLAB_empty", "MATLAB_sparse"


def read_mat(path: Path) -> Columns:
    """Vectors, rows or columns, by their names; the columns of matrices, or their rows where they have more columns
    than rows, as NAME.1, NAME.2; the fields of structs as STRUCT.FIELD, of arrays of structs as STRUCT.1.FIELD, what
    cells hold as NAME.1. A single number is one of `numbers`. Raises what scipy and h5py raise."""
    values: dict[str, Array] = {}
    numbers: dict[str, float] = {}
    doubtful: dict[str, str] = {}
    shapes: dict[str, tuple[int, ...]] = {}
    for count, (name, leaf) in enumerate(_leaves_7_3(path) if h5py.is_hdf5(path) else _leaves_5(path)):
        if count >= MOST_VARIABLES:
            raise ValueError(f"it has more than {MOST_VARIABLES} variables")
        if isinstance(leaf, str):
            doubtful[name] = leaf
            continue
        shapes[name] = leaf.shape
        problem = _problem(leaf)
        if problem:
            doubtful[name] = problem
        elif leaf.size == 1:
            numbers[name] = float(leaf.ravel()[0])
        elif leaf.size:
            values |= _columns(name, np.asarray(leaf, dtype=np.float64))
    return Columns(path, values, doubtful=doubtful, numbers=numbers, shapes=shapes)


def _problem(leaf: Numbers) -> str:
    """Why numbers cannot be columns, nothing if they can."""
    if leaf.ndim > 2:
        return f"has {leaf.ndim} dimensions"
    if np.iscomplexobj(leaf):
        return "holds complex numbers"
    if min(leaf.shape, default=0) > MOST_COLUMNS:
        return f"has {' x '.join(map(str, leaf.shape))} values, more than {MOST_COLUMNS} columns"
    return ""


def _columns(name: str, leaf: Array) -> dict[str, Array]:
    """A vector, or the columns of a matrix; samples are along its longer side."""
    if leaf.ndim < 2 or 1 in leaf.shape:
        return {name: leaf.ravel()}
    along = leaf if leaf.shape[0] >= leaf.shape[1] else leaf.T
    return {f"{name}.{number}": np.ascontiguousarray(column) for number, column in enumerate(along.T, start=1)}


def _is_number(dtype: np.dtype[Any]) -> bool:
    return np.issubdtype(dtype, np.number) or dtype == np.bool_


def _leaves_5(path: Path) -> Iterator[Leaf]:
    from scipy.io import loadmat

    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of a variable that occurs twice
        for coming in (DeprecationWarning, FutureWarning):  # of scipy, about what it will return: not of the file
            warnings.simplefilter("ignore", coming)
        variables = loadmat(path)
    for name, value in variables.items():
        if not name.startswith("__"):
            yield from _inside_5(name, value, DEEPEST)


def _inside_5(name: str, value: object, deeper: int) -> Iterator[Leaf]:
    from scipy.io.matlab import MatlabFunction, MatlabOpaque

    match value:
        case MatlabFunction() | MatlabOpaque():
            yield name, OBJECT
        case np.ndarray() if deeper == 0:
            yield name, "is nested too deeply"
        case np.ndarray(dtype=np.dtype(names=(_, *_) as fields)):
            elements = value.ravel(order="F")
            for number, element in enumerate(elements, start=1):
                own = name if len(elements) == 1 else f"{name}.{number}"
                for field in fields:
                    yield from _inside_5(f"{own}.{field}", element[field], deeper - 1)
        case np.ndarray() if value.dtype == object:
            for number, element in enumerate(value.ravel(order="F"), start=1):
                yield from _inside_5(f"{name}.{number}", element, deeper - 1)
        case np.ndarray() if _is_number(value.dtype):
            yield name, value
        case np.ndarray():
            yield from [(name, "holds text")] if value.size else []
        case _:
            yield name, "is sparse" if hasattr(value, "todense") else "holds no numbers"


def _leaves_7_3(path: Path) -> Iterator[Leaf]:
    with h5py.File(path, "r") as file:
        for name in file:
            if not name.startswith("#"):  # where MATLAB keeps what references lead to
                yield from _inside_7_3(name, file[name], file, DEEPEST)


def _inside_7_3(name: str, value: Any, file: Any, deeper: int) -> Iterator[Leaf]:
    kind = value.attrs.get(MATLAB_CLASS, b"")
    kind = kind.decode() if isinstance(kind, bytes) else str(kind)
    if deeper == 0:
        yield name, "is nested too deeply"
    elif isinstance(value, h5py.Group):
        if SPARSE in value.attrs:
            yield name, "is sparse"
            return
        yield from _struct_7_3(name, value, file, deeper)
    elif value.dtype == h5py.ref_dtype:
        for number, reference in enumerate(value[()].T.ravel(order="F"), start=1):
            if kind == "cell":
                yield from _inside_7_3(f"{name}.{number}", file[reference], file, deeper - 1)
            else:  # the content of an object, or a field of an array of structs without its struct
                yield name, OBJECT
                return
    elif kind not in ("", "char", "cell") and not _is_matlab_number(kind):
        yield name, OBJECT
    elif kind == "char":
        yield name, "holds text"
    elif EMPTY not in value.attrs:
        yield name, _numbers_7_3(value)


def _struct_7_3(name: str, group: Any, file: Any, deeper: int) -> Iterator[Leaf]:
    """The fields of a struct. In an array of structs each field is a dataset of references without a class."""
    many = [field for field, value in group.items() if _is_of_many(value)]
    for field, value in group.items():
        if field not in many:
            yield from _inside_7_3(f"{name}.{field}", value, file, deeper - 1)
    counts = [group[field].size for field in many]
    for number in range(min(counts, default=0)):
        for field in many:
            reference = group[field][()].T.ravel(order="F")[number]
            yield from _inside_7_3(f"{name}.{number + 1}.{field}", file[reference], file, deeper - 1)


def _is_of_many(value: Any) -> bool:
    return isinstance(value, h5py.Dataset) and value.dtype == h5py.ref_dtype and MATLAB_CLASS not in value.attrs


def _is_matlab_number(kind: str) -> bool:
    return kind in ("double", "single", "logical") or kind.removeprefix("u").startswith("int")


def _numbers_7_3(value: Any) -> Numbers | str:
    """The values of a dataset in MATLAB's shape; HDF5 has its axes in the reverse order."""
    if value.nbytes > LARGEST_FILE:
        raise ValueError(f"{value.name} has more than {LARGEST_FILE // 1024**2} MB")
    numbers: Numbers = value[()]
    if value.dtype.names == ("real", "imag"):
        return np.asarray(numbers["real"] + 1j * numbers["imag"]).T
    if not _is_number(value.dtype):
        return "holds no numbers"
    return np.asarray(numbers).T


READABLE = (ValueError, OSError, NotImplementedError, Warning)  # whose words a reader of the file is meant to read
NO_TABLE = "Write CSV with one line of names, and numbers below."
OTHERS = {".tdms": "TDMS", ".xlsx": "Excel", ".xls": "Excel", ".mdf": "MDF", ".mf4": "MDF", ".dxd": "Dewesoft"}

FUNCTION, TIME_RESPONSE = 58, 1  # data set "function at nodal DOF", and its functions of time
DIRECTIONS = {0: "", 1: "+X", -1: "-X", 2: "+Y", -2: "-Y", 3: "+Z", -3: "-Z",
              4: "+RX", -4: "-RX", 5: "+RY", -5: "-RY", 6: "+RZ", -6: "-RZ"}  # fmt: skip
NO_UNIT = ("", "NONE", "UNKNOWN")
UNITS = 164  # data set "units"
LENGTHS = {1.0: "m", 1000.0: "mm", 100.0: "cm", 1e6: "um", 39.37008: "in", 3.28084: "ft"}  # by their factor from m
RATES = {8: "", 11: "/s", 12: "/s^2"}  # data types: displacement, velocity, acceleration
TIME = "time"
SAME = 1e-6  # of a step of time


def read_columns(path: Path) -> Columns:
    """The columns of a file.

    Text: names, perhaps units, then numbers or time stamps, separated by comma, semicolon, tab or blanks; lines above
    the names, and those that begin with #, are left out; with a semicolon, tab or blanks, numbers may have a decimal
    comma; without names the columns are called 1, 2 and so on. WAV: the channels, named 1, 2 and so on, from -1 to 1
    where they are whole numbers. MAT: see `read_mat`. UFF (or unv): see `read_uff`. Raises InputError for what is
    none of these.
    """
    try:
        require_file(path, LARGEST_FILE)
    except Unreadable as error:
        remedy = "Cut it into several files." if path.is_file() else "Check its name."
        raise wrong_file(path, str(error), remedy) from None
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        other = OTHERS.get(path.suffix.lower())
        what, remedy = ("is of no known kind.", f"Known are {', '.join(READERS)}.")
        if other:
            what, remedy = f"is a file of {other}, which is not read.", "Export its channels as CSV or MAT."
        raise wrong_file(path, what, remedy)
    try:
        columns = reader(path)
    except InputError:
        raise
    except Exception as error:  # of several libraries, which raise errors of their own
        reason = " ".join(str(error).split()) if isinstance(error, READABLE) else "it is damaged"
        problem = f"cannot be read: {printable(reason)[:200].rstrip('.')}."
        raise wrong_file(path, problem, error.remedy if isinstance(error, NoTable) else NO_TABLE) from None
    counts = [len(values) for values in columns.values.values()]
    if not columns.doubtful and (not counts or min(counts) < 2):
        raise wrong_file(path, "holds no columns of numbers.", NO_TABLE)
    if max(counts, default=0) > MOST_SAMPLES:
        raise wrong_file(path, f"has more than {MOST_SAMPLES} samples.", "Cut it into several files.")
    return columns


def _csv(path: Path) -> Columns:
    """Columns by their names; of several with one name they are NAME.1, NAME.2 and so on. A column without a name is
    called by its number, and one without a name and without numbers is none."""
    table = read_table(path.read_bytes())
    named = Counter(table.names)
    doubtful = {name: f"is the name of {count} columns" for name, count in named.items() if count > 1}
    values: dict[str, Array] = {}
    units: dict[str, str] = {}
    seen = Counter[str]()
    for place, (name, unit) in enumerate(zip(table.names, table.units, strict=True)):
        seen[name] += 1
        one = f"{name}.{seen[name]}" if named[name] > 1 else name
        column, stamped = _numbers(table, place)
        if grouped := _grouped(table.values[place]):
            doubtful[one] = f'has marks between thousands, as in "{grouped}"'
            continue
        if np.all(np.isnan(column)) and (name == str(place + 1) or name in table.numbers):
            continue
        values[one] = column
        if stamped or unit:
            units[one] = "s" if stamped else unit
    rates = {1.0 / value for name, value in table.numbers.items() if is_interval(name) and value > 0.0}
    rate = rates.pop() if len(rates) == 1 else None
    return Columns(path, values, rate, units, table.lines, doubtful, table.numbers)


def _grouped(column: Any) -> str | None:
    """The first number of a column of text that has marks between its thousands, which would count as a gap."""
    if column.dtype.kind in "biuf":
        return None
    words = column.astype(str).str.strip()
    grouped = words[words.str.fullmatch(GROUPED)]
    return None if grouped.empty else printable(str(grouped.iloc[0]))


def _numbers(table: DelimitedTable, place: int) -> tuple[Array, bool]:
    """(a column, NaN where it holds no number; whether it holds time stamps, which become seconds)."""
    import pandas as pd

    column = table.values[place]
    if column.dtype == bool:
        return np.full(len(column), np.nan), False
    if not pd.api.types.is_numeric_dtype(column):
        stamps = seconds(column)
        if stamps is not None:
            return stamps, True
        column = column.astype(str).str.replace(table.mark, ".", regex=False)  # a word among decimal commas
    return np.asarray(pd.to_numeric(column, errors="coerce").to_numpy(dtype=np.float64)), False


def _wav(path: Path) -> Columns:
    """Channels from -1 to 1. Whole numbers of 8 bits have no sign: 128 is zero. 24 bits are read as 32 bits."""
    from scipy.io import wavfile

    with warnings.catch_warnings():
        warnings.simplefilter("error", wavfile.WavFileWarning)  # a file that ends too early
        warnings.filterwarnings("ignore", "Chunk .*not understood", wavfile.WavFileWarning)  # notes besides the samples
        rate, samples = wavfile.read(path)
    if not samples.size:
        raise ValueError("it has no samples")
    if rate <= 0:
        raise ValueError("it has no samples per second")
    channels = np.asarray(samples, dtype=np.float64).reshape(len(samples), -1).T
    if len(channels) > MOST_COLUMNS:
        raise ValueError(f"it has {len(channels)} channels, more than {MOST_COLUMNS}")
    if np.issubdtype(samples.dtype, np.integer):
        whole = np.iinfo(samples.dtype)
        middle = 0.5 * (whole.min + whole.max + 1)
        channels = (channels - middle) / (whole.max + 1 - middle)
    return Columns(path, {str(number): channel for number, channel in enumerate(channels, start=1)}, float(rate))


def read_uff(path: Path) -> Columns:
    """The times as `time`, and the responses over time, named by node and direction as "12:+X"; of several with one
    name the second one as "12:+X.2", and so on. Units follow from the data type of a response (displacement, velocity,
    acceleration) and the lengths of data set 164, where its own label is none.

    Raises InputError where pyuff is not installed, ValueError if there is no response over time.
    """
    if find_spec("pyuff") is None:
        remedy = "pip install frbcli[uff], or write the file as CSV or MAT."
        raise wrong_file(path, "needs the library pyuff.", remedy)
    import pyuff

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of data sets of other kinds
        file = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in file.get_set_types()]
        sets = [file.read_sets(place) for place, kind in enumerate(kinds) if kind == FUNCTION]
        lengths = [file.read_sets(place) for place, kind in enumerate(kinds) if kind == UNITS]
    responses = [one for one in sets if one.get("func_type") == TIME_RESPONSE]
    if not responses:
        listed = sorted(set(kinds))
        raise ValueError(f"it has no response over time (data set 58, function 1), but the data sets {listed}")
    length = _length(float(lengths[0]["length"])) if lengths else None
    times = np.asarray(responses[0]["x"], dtype=np.float64)
    values: dict[str, Array] = {TIME: times}
    units: dict[str, str] = {TIME: "s"}
    doubtful: dict[str, str] = {}
    own_times: dict[str, Array] = {}
    for response in responses:
        name = _name(response, values.keys() | doubtful.keys())
        moments = np.asarray(response["x"], dtype=np.float64)
        if np.iscomplexobj(response["data"]):
            doubtful[name] = "holds complex numbers"
        else:
            values[name] = np.asarray(response["data"], dtype=np.float64)
            if not _same(times, moments):
                own_times[name] = moments
        unit = str(response.get("ordinate_axis_units_lab", "")).strip()
        if unit.upper() in NO_UNIT:
            unit = _unit_of_kind(int(response.get("ordinate_spec_data_type", 0)), length)
        if unit:
            units[name] = unit
    return Columns(path, values, None, units, None, doubtful, own_times=own_times)


def _length(factor: float) -> str | None:
    """The unit of length of which a metre has so many, None if it has no name."""
    return next((name for each, name in LENGTHS.items() if math.isclose(each, factor, rel_tol=1e-4)), None)


def _unit_of_kind(kind: int, length: str | None) -> str:
    """The unit of a data type, "" where it is not known or, without data set 164, is not a length."""
    per = RATES.get(kind)
    if per is None:
        return ""
    return f"{length or 'm'}{per}" if per or length else ""


def _name(response: dict[str, Any], used: set[str]) -> str:
    node, direction = int(response["rsp_node"]), DIRECTIONS.get(int(response["rsp_dir"]), "")
    name = f"{node}:{direction}" if direction else f"{node}"
    return next(each for each in (name, *(f"{name}.{k}" for k in range(2, len(used) + 3))) if each not in used)


def _same(times: Array, others: Array) -> bool:
    if len(times) != len(others) or len(times) < 2:
        return False
    return bool(np.max(np.abs(times - others)) <= SAME * abs(times[1] - times[0]))


TEXT = (".csv", ".txt", ".dat", ".asc", ".lvm", ".tsv", ".prn")
READERS = dict.fromkeys(TEXT, _csv) | {".wav": _wav, ".mat": read_mat, ".uff": read_uff, ".unv": read_uff}
