"""Small dense blocks on the vector units: code for sizes that the compiler knows, in vectors of four numbers.

The compiler makes vectors of long loops by itself, but none of short ones. So what a column of a few cells needs is
written out here, number by number and in registers. A column of k cells has k rows of its own equations, or what has
become of them, followed by k + r more columns: what it takes from the border, and r right-hand sides. Rows are filled
up with zeros to a multiple of four. k and r are passed as tuples of that length. """

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic, register_jitable

LANES = 4
_NUMBER, _PLACE, _INDEX = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_VECTOR = ir.VectorType(_NUMBER, LANES)
_ANY = ir.Constant(_VECTOR, ir.Undefined)
_ZERO, _ONE = ir.Constant(_NUMBER, 0.0), ir.Constant(_NUMBER, 1.0)
_FUSED = ("contract",)  # a product and a sum are rounded once


@register_jitable
def row_length(k: int, r: int) -> int:
    """Length of the rows of a column of k cells with r right-hand sides."""
    return -(-(2 * k + r) // LANES) * LANES


class _Code:
    """Instructions of vectors; rows of arrays by their data."""

    def __init__(self, context: Any, builder: Any, signature: Any, arguments: Any) -> None:
        self.builder = builder
        self.arrays = [
            context.make_array(kind)(context, builder, value).data if isinstance(kind, types.Array) else value
            for kind, value in zip(signature.args, arguments, strict=True)
        ]

    def number(self, base: Any, place: int) -> Any:
        return self.builder.load(self.builder.gep(base, [ir.Constant(_PLACE, place)]))

    def put(self, base: Any, place: int, value: Any) -> None:
        self.builder.store(value, self.builder.gep(base, [ir.Constant(_PLACE, place)]))

    def vector(self, base: Any, place: int) -> Any:
        at = self.builder.gep(base, [ir.Constant(_PLACE, place)])
        loaded = self.builder.load(self.builder.bitcast(at, _VECTOR.as_pointer()))
        loaded.align = 8
        return loaded

    def put_vector(self, base: Any, place: int, value: Any) -> None:
        at = self.builder.gep(base, [ir.Constant(_PLACE, place)])
        self.builder.store(value, self.builder.bitcast(at, _VECTOR.as_pointer()), align=8)

    def lane(self, vector: Any, number: int) -> Any:
        return self.builder.extract_element(vector, ir.Constant(_INDEX, number))

    def with_lane(self, vector: Any, number: int, value: Any) -> Any:
        return self.builder.insert_element(vector, value, ir.Constant(_INDEX, number))

    def all_lanes(self, value: Any) -> Any:
        first = ir.Constant(ir.VectorType(_INDEX, LANES), [0] * LANES)
        return self.builder.shuffle_vector(self.with_lane(_ANY, 0, value), _ANY, first)

    def vectors(self, numbers: list[Any]) -> list[Any]:
        """Vectors of consecutive numbers; None: 0."""
        made = [ir.Constant(_VECTOR, [_ZERO] * LANES)] * (len(numbers) // LANES)
        for place, value in enumerate(numbers):
            if value is not None:
                made[place // LANES] = self.with_lane(made[place // LANES], place % LANES, value)
        return made

    def times(self, x: list[Any], y: list[Any]) -> list[Any]:
        return [self.builder.fmul(a, b, flags=_FUSED) for a, b in zip(x, y, strict=True)]

    def less(self, x: list[Any], factor: Any, y: list[Any]) -> list[Any]:
        """x - factor y."""
        products = [self.builder.fmul(factor, b, flags=_FUSED) for b in y]
        return [self.builder.fsub(a, b, flags=_FUSED) for a, b in zip(x, products, strict=True)]

    def eliminate(self, rows: Iterable[list[Any]]) -> Iterator[list[Any]]:
        """Rows that begin with a square matrix: its inverse, and the inverse times the rest (Gauss and Jordan).

        Row by row, first with the pivots before and then with those behind its own: so that one row at a time changes,
        in registers, and the others are only read.
        """
        pivots: list[list[Any]] = []
        for p, given in enumerate(rows):
            row = given
            for q, other in enumerate(pivots):
                row = self.without(row, q, other)
            group, lane = divmod(p, LANES)
            pivot = self.all_lanes(self.builder.fdiv(_ONE, self.lane(row[group], lane)))
            row[group] = self.with_lane(row[group], lane, _ONE)
            pivots.append(self.times(row, [pivot] * len(row)))
        for p, row in enumerate(pivots):
            for q in range(p + 1, len(pivots)):
                row = self.without(row, q, pivots[q])
            yield row

    def without(self, row: list[Any], p: int, other: list[Any]) -> list[Any]:
        """A row without the unknown p, of which another row has one."""
        group, lane = divmod(p, LANES)
        factor, rest = self.all_lanes(self.lane(row[group], lane)), list(row)
        rest[group] = self.with_lane(row[group], lane, _ZERO)
        return self.less(rest, factor, other)


def _eliminate_column(typing, rows, sizes):  # type: ignore[no-untyped-def]
    """rows (k, w) <- the inverse of their first k columns, and the inverse times the rest."""
    k, w = len(sizes[0]), row_length(len(sizes[0]), len(sizes[1]))

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        code = _Code(context, builder, signature, arguments)
        base = code.arrays[0]
        filled = ([code.vector(base, w * i + c) for c in range(0, w, LANES)] for i in range(k))
        for i, row in enumerate(code.eliminate(filled)):
            for c in range(0, w, LANES):
                code.put_vector(base, w * i + c, row[c // LANES])
        return context.get_dummy_value()

    return types.void(rows, sizes), generate


def _next_column(typing, centre, below, above, before, behind, right, last, rows, sizes):  # type: ignore[no-untyped-def]
    """rows (k, w) <- as eliminate_column, of a column with the entries centre, below, above, before (k,) and right-hand
    sides right (k, k + r), its last r layers, behind one with the entries behind (k,) and the rows last (k, w)."""
    k, r, w = len(sizes[0]), len(sizes[1]), row_length(len(sizes[0]), len(sizes[1]))

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        code = _Code(context, builder, signature, arguments)
        centre, below, above, before, behind, right, last, rows, _ = code.arrays
        passed = [code.number(behind, j) for j in range(k)] + [_ONE] * (w - k)
        passes = code.vectors(passed)

        def filled(i):  # type: ignore[no-untyped-def]
            own: list[Any] = [None] * w
            own[i] = code.number(centre, i)
            if i > 0:
                own[i - 1] = code.number(below, i)
            if i < k - 1:
                own[i + 1] = code.number(above, i)
            own[2 * k : 2 * k + r] = [code.number(right, (k + r) * i + k + side) for side in range(r)]
            back = code.times([code.vector(last, w * i + c) for c in range(0, w, LANES)], passes)
            return code.less(code.vectors(own), code.all_lanes(code.number(before, i)), back)

        for i, row in enumerate(code.eliminate(map(filled, range(k)))):
            for c in range(0, w, LANES):
                code.put_vector(rows, w * i + c, row[c // LANES])
        return context.get_dummy_value()

    given = (centre, below, above, before, behind, right, last, rows, sizes)
    return types.void(*given), generate


def _take_in_next(typing, behind, following, rows, sizes):  # type: ignore[no-untyped-def]
    """rows (k, w) from column k on -= their inverse diag(behind) following (k, w), the rows of the next column. Of the
    inverse itself what shares a vector with these is lost."""
    k, w = len(sizes[0]), row_length(len(sizes[0]), len(sizes[1]))
    parts = range(k // LANES * LANES, w, LANES)

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        code = _Code(context, builder, signature, arguments)
        behind, following, rows, _ = code.arrays
        passed = []
        for j in range(k):
            there = [code.vector(following, w * j + c) for c in parts]
            passed.append(code.times(there, [code.all_lanes(code.number(behind, j))] * len(there)))
        for i in range(k):
            row = [code.vector(rows, w * i + c) for c in parts]
            for j in range(k):
                row = code.less(row, code.all_lanes(code.number(rows, w * i + j)), passed[j])
            for c, value in zip(parts, row, strict=True):
                code.put_vector(rows, w * i + c, value)
        return context.get_dummy_value()

    return types.void(behind, following, rows, sizes), generate


def _take_in_border(typing, border, rows, right, sizes):  # type: ignore[no-untyped-def]
    """right (k, k + r), its last r layers <- the right-hand sides of rows (k, w) less what they take from the border,
    whose solutions replace its right-hand sides in border (k, w)."""
    k, r, w = len(sizes[0]), len(sizes[1]), row_length(len(sizes[0]), len(sizes[1]))
    first = min(2 * k, w - row_length(0, r))  # no vector reaches beyond its row
    places, shift = range(first, 2 * k + r, LANES), 2 * k - first

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        code = _Code(context, builder, signature, arguments)
        border, rows, right, _ = code.arrays
        there = [[code.vector(border, w * j + c) for c in places] for j in range(k)]
        for i in range(k):
            row = [code.vector(rows, w * i + c) for c in places]
            for j in range(k):
                row = code.less(row, code.all_lanes(code.number(rows, w * i + k + j)), there[j])
            for side in range(r):
                place, lane = divmod(shift + side, LANES)
                code.put(right, (k + r) * i + k + side, code.lane(row[place], lane))
        return context.get_dummy_value()

    return types.void(border, rows, right, sizes), generate


eliminate_column: Any = intrinsic(_eliminate_column)
next_column: Any = intrinsic(_next_column)
take_in_next: Any = intrinsic(_take_in_next)
take_in_border: Any = intrinsic(_take_in_border)
