"""Columns of numbers from MAT files: up to version 7 by scipy, version 7.3, which is HDF5, by h5py."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from frbcli.arrays import Array
from frbcli.results.measured.columns import LARGEST_FILE, Columns
from frbcli.results.measured.delimited import MOST_COLUMNS

Numbers = NDArray[Any]
Leaf = tuple[str, "Numbers | str"]  # name and values in MATLAB's shape, or what they are where they are no numbers

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

    if isinstance(value, MatlabFunction | MatlabOpaque):
        yield name, OBJECT
    elif not isinstance(value, np.ndarray):
        yield name, "is sparse" if hasattr(value, "todense") else "holds no numbers"
    elif deeper == 0:
        yield name, "is nested too deeply"
    elif value.dtype.names:
        elements = value.ravel(order="F")
        for number, element in enumerate(elements, start=1):
            own = name if len(elements) == 1 else f"{name}.{number}"
            for field in value.dtype.names:
                yield from _inside_5(f"{own}.{field}", element[field], deeper - 1)
    elif value.dtype == object:
        for number, element in enumerate(value.ravel(order="F"), start=1):
            yield from _inside_5(f"{name}.{number}", element, deeper - 1)
    elif _is_number(value.dtype):
        yield name, value
    elif value.size:
        yield name, "holds text"


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
