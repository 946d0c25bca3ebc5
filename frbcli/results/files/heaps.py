"""The texts of an HDF5 file lie in collections that the HDF5 library walks from object to object, without a look at
where that leads: at an object of no size it never ends. They are walked here before, wherever one seems to begin.

The form of a collection is that of the HDF5 file format, version 3.0, section III.E: signature, version, three bytes,
size; then objects, each of index, references, four bytes, size and, unless it is what is free, as many bytes, padded to
a multiple of 8.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from io import BufferedReader

BEGINNING = b"GCOL\x01"
HEAD = 16  # bytes of a collection's head, and of an object's
MOST = 10_000  # collections; a run has a handful
MOST_BYTES = 16 * 1024**2  # of all collections
SUPERBLOCK = 24  # bytes
SIZES = {0: slice(13, 15), 1: slice(13, 15), 2: slice(9, 11), 3: slice(9, 11)}  # by the version of the superblock


def are_sound(file: BufferedReader, begin: int, end: int, places: Iterable[int]) -> bool:
    """Whether the collections of the HDF5 file between two offsets can be walked to their ends. places: offsets of all
    BEGINNINGs in it; one whose size leads out of the file is no collection, and the library refuses it."""
    file.seek(begin)
    superblock = file.read(SUPERBLOCK)
    if superblock[SIZES.get(superblock[8], slice(0))] != b"\x08\x08":  # addresses and sizes of 8 bytes
        return False
    left = MOST_BYTES
    for place in places:
        file.seek(place + 8)
        (size,) = struct.unpack("<Q", file.read(8).ljust(8, b"\xff"))
        if place + size > end:
            continue
        left -= size
        file.seek(place)
        if left < 0 or not _is_sound(file.read(size)):
            return False
    return True


def _is_sound(collection: bytes) -> bool:
    at = HEAD
    while at + HEAD <= len(collection):
        index, _, size = struct.unpack_from("<HH4xQ", collection, at)
        taken = size if index == 0 else HEAD + -(-size // 8) * 8
        if taken < HEAD:
            return False
        at += taken
    return at <= len(collection)
