"""The parts of a run file, each checked before it is read.

HDF5 can describe far more than a run needs: data that are compressed, that lie in other files, that were never written,
or that are found along a path. A part of a run belongs to its group itself, is of a plain type, and lies in its file in
one piece, so that no part is larger than the file.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5l

from frbcli.results.records import RunPlace, Stored

LARGEST_TEXT = 2 * 1024**2  # characters
MOST_PARTS = 500  # of a group
NUMBERS = (np.dtype("<f8"), np.dtype("<i8"))
_NAME = re.compile(r"[A-Za-z0-9_-]{1,100}")


class WrongPart(Exception):
    """A part of a run file is missing or has a wrong form; says which."""


def group(file: h5py.Group, name: str) -> h5py.Group:
    """A group by its name. Raises WrongPart."""
    return _member(file, name, h5py.Group)


def names(inside: h5py.Group, what: str) -> list[str]:
    """The names in a group, in the order in which they were written. Raises WrongPart if they cannot be a run's."""
    if len(inside) > MOST_PARTS:
        raise WrongPart(f"{what} holds more than {MOST_PARTS} parts")
    members = list(inside)
    if not all(_NAME.fullmatch(name) for name in members):
        raise WrongPart(f"{what} holds a part with a wrong name")
    return members


def array(inside: h5py.Group, name: str, place: RunPlace, dimensions: int | None = None) -> Stored:
    """Where the numbers of a part lie. dimensions: that it must have. Raises WrongPart."""
    data = _member(inside, name, h5py.Dataset)
    if data.dtype not in NUMBERS or data.shape is None or dimensions not in (None, len(data.shape)):
        raise WrongPart(f"{name} is not an array of plain numbers")
    if not _in_one_piece(data) or data.id.get_storage_size() != data.size * data.dtype.itemsize:
        raise WrongPart(f"{name} does not lie in the file in one piece")
    return Stored(place, data.id.get_offset() or 0, data.dtype, data.shape)


def text(inside: h5py.Group, name: str) -> str:
    """The text of a name in a group. Raises WrongPart if it is none, or too long."""
    data = _member(inside, name, h5py.Dataset)
    if data.shape != () or not _is_text(data.dtype) or not _in_one_piece(data):
        raise WrongPart(f"{name} is not a text")
    content = str(data.asstr()[()])
    if len(content) > LARGEST_TEXT:
        raise WrongPart(f"{name} is too long")
    return content


def record(inside: h5py.Group, name: str) -> Any:
    """The value of a text in JSON. Raises WrongPart."""
    try:
        return json.loads(text(inside, name))
    except (ValueError, RecursionError):
        raise WrongPart(f"{name} is no record") from None


def text_attribute(of: h5py.Dataset, name: str) -> str:
    """A text that is attached to a part. Raises WrongPart."""
    return str(_attribute(of, name, _is_text))


def number_attribute(of: h5py.Group, name: str) -> float | int:
    """A number that is attached to a group. Raises WrongPart."""
    return _attribute(of, name, NUMBERS.__contains__).item()  # type: ignore[no-any-return]


def has(inside: h5py.Group, name: str) -> bool:
    """Whether a group has a part of that name, whatever it is."""
    return bool(inside.id.links.exists(name.encode()))


def rest(arrays: Iterable[Stored], length: int) -> int:
    """How many bytes of a file do not belong to its arrays; negative where arrays share bytes."""
    return length - sum(stored.bytes for stored in arrays)


def _member(inside: h5py.Group, name: str, kind: type[Any]) -> Any:
    """A part of a group that is in it, not a link to some place; a link is not followed."""
    links = inside.id.links
    if not links.exists(name.encode()) or links.get_info(name.encode()).type != h5l.TYPE_HARD:
        raise WrongPart(f"{name} is missing")
    member = inside[name]
    if not isinstance(member, kind):
        raise WrongPart(f"{name} is of another kind")
    return member


def _attribute(of: h5py.HLObject, name: str, fits: Callable[[np.dtype[Any]], bool]) -> Any:
    if not h5py.h5a.exists(of.id, name.encode()):
        raise WrongPart(f"{name} is missing")
    attribute = of.attrs.get_id(name)
    if attribute.shape != () or not fits(attribute.dtype):
        raise WrongPart(f"{name} is of another kind")
    return of.attrs[name]


def _is_text(dtype: np.dtype[Any]) -> bool:
    info = h5py.check_string_dtype(dtype)
    return info is not None and info.length is None


def _in_one_piece(data: h5py.Dataset) -> bool:
    """Whether a part lies in its file as it is: neither in others, nor virtual, nor compressed in pieces."""
    how = data.id.get_create_plist()
    return bool(how.get_layout() == h5d.CONTIGUOUS and how.get_external_count() == 0 and how.get_nfilters() == 0)
