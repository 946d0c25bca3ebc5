"""A cavitation law: one class, which declares and computes everything that is particular to it."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from frbcli.arrays import Array


@dataclass(frozen=True)
class CellState:
    """State of cells with the unknown w, arrays of its shape: pressure over the ambient pressure, scaled, in
    1/s; oil fraction theta; source of oil in 1/s; and the derivatives of the three by w."""

    pressure: Array
    fraction: Array
    source: Array
    pressure_slope: Array
    fraction_slope: Array
    source_slope: Array


class Scales(NamedTuple):
    """Scaled gauge pressures in 1/s of one film: reference (> 0) of the unknown, cavitation, ambient (absolute)."""

    reference: float
    cavitation: float
    ambient: float


class FilmOil(NamedTuple):
    """Properties of a film that a law may need: scale, 12 eta / psi^2 in Pa s, which a pressure is divided by to be
    scaled; ambient and cavitation pressure, absolute, in Pa; density of the full oil in kg / m^3."""

    scale: float
    ambient: float
    cavitation: float
    density: float


@dataclass(frozen=True)
class Key:
    """One key of the table [film.NAME] of a law.

    A number has a unit ("" for none), an example with its unit, and bounds: above, below exclusive, least, most
    inclusive. A word has choices. default: SI; None: need not be given.
    """

    name: str
    default: float | str | None
    meaning: str = ""
    example: str = ""
    unit: str = ""
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None
    choices: tuple[str, ...] = ()


Cell = tuple[float, float, float, float, float, float]
CellWithGas = tuple[float, float, float, float, float, float, float, float]
Numbers = tuple[float, ...]
ABOVE_KINK = 1e-300  # of an unknown: a negligible pressure, but a full cell
FRONTS = 1.5  # fronts between cells make the order 1 to 2: the middle of it


class Law:
    """A cavitation law; a subclass is a frozen dataclass, its fields are the numbers of the law as a film takes them.

    What a class declares: name: in film.cavitation; label: in pictures; equation: its numbers in the dissertation, or
    the source; meaning: of the table [film.NAME], a sentence; cell_words: what a cell does, for the documents; keys: of
    that table. conserves: whether oil neither appears nor vanishes in its cells; keeps_oil: whether the oil of a cell
    is a state that goes on from one moment to the next; cavitates: whether it does anything below p_cav; clips: whether
    loads take no pressure below p_cav; closed: whether the pressure solves a linear equation, known in closed form
    between rectangles; tabulated: whether its source follows from the pressure of the cell alone, as a penalty's, so
    that films without openings are tabulated; starves: whether its cavity stays so near to p_cav that no oil is drawn
    in; empties: whether it is at p_cav, so that a film without supply carries nothing in the long run; holds_cavity:
    whether a source keeps the pressure from falling below p_cav; edges: whether the edge of its cavity within a cell is
    known, see `edged`; published_form: whether it has a published form, with artificial diffusion; carries_gas: whether
    the oil carries free gas, whose balance then follows from free_gas and exchanged of the law, and of which `cell`
    takes two more parameters and has two more results, see bubbly.py. order: by which forces become exact with smaller
    cells; cost: time of a solve on cells over the time with Elrod's law; fronts: steps that the fronts of oil in a film
    without inflow need over the steps with the two-phase law. heavy: static load over width and diameter, Pa, above
    which errors of steps grow in its films. compared: values of keys that the picture of theta(p) shows besides the
    case's own. """

    name: ClassVar[str]
    label: ClassVar[str]
    equation: ClassVar[str] = ""
    meaning: ClassVar[str] = ""
    cell_words: ClassVar[str] = ""
    keys: ClassVar[tuple[Key, ...]] = ()
    conserves: ClassVar[bool] = True
    keeps_oil: ClassVar[bool] = True
    cavitates: ClassVar[bool] = True
    clips: ClassVar[bool] = False
    closed: ClassVar[bool] = False
    tabulated: ClassVar[bool] = False
    starves: ClassVar[bool] = False
    empties: ClassVar[bool] = False
    holds_cavity: ClassVar[bool] = False
    edges: ClassVar[bool] = False
    published_form: ClassVar[bool] = False
    carries_gas: ClassVar[bool] = False
    order: ClassVar[float] = FRONTS
    cost: ClassVar[float] = 1.0
    fronts: ClassVar[float] = 1.0
    heavy: ClassVar[float] = math.inf
    compared: ClassVar[tuple[tuple[str, tuple[float, ...]], ...]] = ()

    @classmethod
    def scaled(cls, given: Any, oil: FilmOil) -> Self:
        """The law of one film from the values `given` for its keys, by attribute, and from its oil. Quantities that
        follow the film are given for the centred journal at 1 rad/s, see follow."""
        return cls()

    @staticmethod
    def cell(w: float, parameters: Numbers, scales: Scales) -> Cell:
        """The compiled form: pressure, oil fraction, source and their slopes by w of one cell, see CellState.

        parameters: the fields of the law, in their order. Numba compiles it with every function that it calls: plain
        Python on numbers, with the functions of `math`; all six results are floats. A law without it is none.
        """
        return math.nan, math.nan, math.nan, math.nan, math.nan, math.nan

    @staticmethod
    def follow(parameters: Numbers, eccentricity: float, speed: float, whirl: float) -> Numbers:
        """The parameters at an eccentricity, a speed omega_J + omega_S in rad/s and a share (0 to 1) of half-frequency
        whirl; following them again changes nothing. Compiled as `cell` is."""
        return parameters

    @staticmethod
    def empty(parameters: Numbers, scales: Scales) -> float:
        """w below which a cell is empty and its oil hardly changes any more; by default there is no such. Compiled as
        `cell` is."""
        return -np.inf

    def cells(self, w: Array, scales: Scales, carried: Array | float = 0.0, turnover: Array | float = 0.0) -> CellState:
        """The state of cells with the unknown w, of any shape, by the compiled form. carried, turnover: of the shape of
        w, the two parameters that `cell` of a law with gas takes behind its own; without them the gas is in
        equilibrium."""
        from frbcli.film.cavitation.compiled import compiled_cells

        return compiled_cells(self, w, scales, carried, turnover)

    @property
    def supplied_gas(self) -> float:
        """Free gas over the oil that is supplied."""
        return 0.0

    @property
    def gas_content(self) -> float:
        """Free and dissolved gas over the oil."""
        return 0.0

    def standing(self, scales: Scales) -> float:
        """w of a full film at the ambient pressure, or of oil whose gas is in equilibrium there.

        Where that is p_cav, a full film lies on the kink of the law, on its full side: from there one step of Newton's
        method finds the pressures of the whole film, from the other side only of one more column of cells."""
        return max(ABOVE_KINK, -scales.cavitation / scales.reference)

    def free_gas(self, state: CellState, scales: Scales) -> Array:
        """Free gas of cells over their oil."""
        return np.zeros_like(state.pressure)

    def exchanged(self, pressure: Array, carried: Array, scales: Scales) -> tuple[Array, Array]:
        """Free gas in equilibrium at scaled gauge pressures, and the time constant in s with which the gas that comes
        into a cell, `carried`, tends to it."""
        return np.zeros_like(pressure), np.zeros_like(pressure)

    def edged(self, state: CellState, w: Array, scales: Scales, rate: Array, through: Array) -> CellState:
        """The cells `state` with the unknown w, with the edge of the cavity within them, of a law with `edges`. rate:
        at which the gap opens, 1/s; through: scaled flow to the next cell over the area, per pressure; see
        film/cells/cavity_edge.py."""
        return state

    def edge_slopes(self, pressure: Array, scales: Scales, rate: Array, through: Array) -> tuple[Array, Array]:
        """Derivatives by rate and through of the sources of cells with scaled gauge pressures, see `edged`."""
        return np.zeros_like(pressure), np.zeros_like(pressure)

    def curve(self, ratio: Array) -> Array | None:
        """theta at p / p_cav (n,), of a law whose pressures are scaled with p_cav; None where theta does not follow
        from the pressure."""
        return None

    @classmethod
    def legend(cls, given: Any) -> str:
        """The law with the values `given` for its keys, as the picture of theta(p) calls it."""
        return cls.label

    @property
    def parameters(self) -> Numbers:
        """Numbers of the law in the order in which `cell` takes them."""
        return tuple(float(getattr(self, field.name)) for field in fields(self))  # type: ignore[arg-type]

    def followed(self, eccentricity: float, speed: float, whirl: float = 0.0) -> Self:
        """The law at an eccentricity, a speed and a share of whirl, see follow."""
        names = (field.name for field in fields(self))  # type: ignore[arg-type]
        values = self.follow(self.parameters, eccentricity, speed, whirl)
        return replace(self, **dict(zip(names, values, strict=True)))  # type: ignore[type-var]


def place_of_edge(above: Array, rate: Array, through: Array) -> Array:
    """s in [0, 1]: how far behind the middle of a cell the cavity begins, over the cell, where the pressure is by
    `above` larger than in the cavity: s^2 = above / (A L^2 / (2 H^3)), see film/cells/cavity_edge.py."""
    most = 0.5 * np.maximum(rate, 0.0) / through
    return np.asarray(np.sqrt(np.clip(np.divide(above, most, out=np.ones_like(above), where=most > 0.0), 0.0, 1.0)))


def source_at_edge(above: Array, rate: Array, through: Array) -> Array:
    """Source A (1 - s)^2 / 2 of a cell, see place_of_edge."""
    return np.asarray(0.5 * np.maximum(rate, 0.0) * (1.0 - place_of_edge(above, rate, through)) ** 2)


def slopes_at_edge(above: Array, by_rate: Array | float, rate: Array, through: Array) -> tuple[Array, Array]:
    """Derivatives of source_at_edge by rate and through; by_rate: that of `above`."""
    s, opens = place_of_edge(above, rate, through), np.maximum(rate, 0.0)
    left = np.divide(1.0 - s, s, out=np.zeros_like(s), where=s > 0.0)
    fall = by_rate - np.divide(above, opens, out=np.zeros_like(above), where=opens > 0.0)
    return 0.5 * (1.0 - s) ** 2 - left * through * fall, -left * above
