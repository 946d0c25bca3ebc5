"""Arrays that take long to make, kept on disk next to the compiled kernels, so that later processes need not make them.

An array is found by all that it follows from: the sources of the function that makes it, its arguments, the libraries.
"""

from __future__ import annotations

import hashlib
import io
import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import lru_cache, wraps
from pathlib import Path
from typing import ParamSpec

import numba
import numpy as np

from frbcli.arrays import Array
from frbcli.caches import store, stored
from frbcli.compiled import folder_of, sources_digest

SUFFIX = ".table"
MOST_KEPT = 64  # files in a folder; those that were used last
MOST_HELD = 8  # arrays of one function in the memory of a process
NAME = 32  # letters of the digest in the name of a file

Arguments = ParamSpec("Arguments")


def kept_beside(kernel: Callable[..., object]) -> Callable[[Callable[Arguments, Array]], Callable[Arguments, Array]]:
    """Decorates a function that makes an array; it is kept in the folder of a kernel.

    Its arguments are numbers, texts, truth values, and tuples and frozen dataclasses of them; others raise TypeError.
    Where nothing can be read or written, the array is made again: no error comes from the files.
    """

    def decorated(make: Callable[Arguments, Array]) -> Callable[Arguments, Array]:
        source = Path(make.__code__.co_filename)

        @lru_cache(maxsize=MOST_HELD)
        @wraps(make)
        def kept(*given: Arguments.args, **named: Arguments.kwargs) -> Array:
            content = repr((_exact(given), _exact(tuple(named.items()))))
            made_by = f"{make.__qualname__} {sources_digest(source)} {np.__version__} {numba.__version__}"
            name = hashlib.sha256(f"{made_by} {content}".encode()).hexdigest()[:NAME]
            folder = folder_of(kernel)
            if folder is None:
                return make(*given, **named)
            file = folder / f"{make.__name__}-{name}{SUFFIX}"
            values = _read(file)
            if values is not None:
                return values
            array = make(*given, **named)
            with suppress(OSError):
                _write(file, array)
            return array

        return kept  # type: ignore[return-value]  # the cache of functools loses the types of the arguments

    return decorated


def _exact(value: object) -> object:
    """A value with its exact digits, as its `repr` shows it. Raises TypeError for one whose `repr` may be less."""
    if isinstance(value, tuple):
        return tuple(map(_exact, value))
    if is_dataclass(value) and not isinstance(value, type):
        return (type(value).__qualname__, *(_exact(getattr(value, field.name)) for field in fields(value)))
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"{type(value).__name__} cannot name what is kept on disk")


def _read(path: Path) -> Array | None:
    """The array of a file, None if there is none or it is damaged."""
    content = stored(path)
    if content is None:
        return None
    with suppress(OSError):  # of another user
        os.utime(path)
    array: Array = np.load(io.BytesIO(content), allow_pickle=False)
    return array


def _write(path: Path, array: Array) -> None:
    """Write a file, and remove those that were not used for the longest time. Raises OSError."""
    content = io.BytesIO()
    np.save(content, array, allow_pickle=False)
    store(path, content.getvalue())
    others = sorted(path.parent.glob(f"*{SUFFIX}"), key=lambda other: other.stat().st_mtime)
    for other in others[:-MOST_KEPT]:
        other.unlink(missing_ok=True)
