"""The films of all pads of one side of a collar over the gap, as one table for all speeds and viscosities.

Pads that narrow in the direction of rotation do not cavitate while their gap stays: the pressure is nowhere below that
at the edges. The film is then linear in the speed and homogeneous in the viscosity,

    W = eta omega w(h),   T = eta omega t(h),   Q = omega q(h),   K = eta omega k(h),   C = eta c(h).

Each function is interpolated over ln h by Chebyshev polynomials, those that fall over many powers of ten as their
logarithms, and the others relative to them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from frbcli.arrays import Array
from frbcli.film.pads.film import PadFilm, PadOil, pad_film, ring_of_pads
from frbcli.film.pads.geometry import MESH, SOMMERFELD, Pad
from frbcli.film.pads.mesh import PadMesh, pad_mesh

NODES = 48  # of the interpolation, whose error is below 1e-7
MOST_HELD = 8


@dataclass(frozen=True)
class ScaledPads:
    """All pads of a side at one gap, with viscosity and speed divided out. load: W / (eta omega) in m^2; torque: T /
    (eta omega) in m^3; side_flow: what leaves at both radii over omega in m^3; stiffness: K / (eta omega) in m,
    damping: C / eta in m, axial; tilt_stiffness, tilt_damping: (2, 2) likewise, in m^3; inverse_gap: integral of 1/h
    over the pads in m."""

    load: float
    torque: float
    side_flow: float
    stiffness: float
    damping: float
    tilt_stiffness: Array
    tilt_damping: Array
    inverse_gap: float


@dataclass(frozen=True)
class GapTable:
    """Films over the gap from `thin` to `wide` in m, of pads up to `radius` in m. coefficients: (NODES, 9)."""

    thin: float
    wide: float
    radius: float
    coefficients: Array

    def at(self, gap: float) -> ScaledPads:
        """The films at a gap in m between thin and wide."""
        series = chebyshev.chebval(self._scaled(gap), self.coefficients)
        load, torque, side_flow, stiffness, damping, inverse_gap = np.exp(series[:6]).tolist()
        direct, cross, turning = (series[6:] * self.radius**2).tolist()
        return ScaledPads(
            load,
            torque,
            side_flow,
            stiffness,
            damping,
            stiffness * np.array([[direct, -cross], [cross, direct]]),
            damping * turning * np.eye(2),
            inverse_gap,
        )


    def torques(self, gaps: Array) -> Array:
        """(k,) T / (eta omega) in m^3 at gaps in m."""
        return np.asarray(np.exp(chebyshev.chebval(self._scaled(gaps), self.coefficients[:, 1])))

    def _scaled(self, gaps: Array | float) -> Array:
        """Gaps in m as the polynomials take them, from -1 to 1."""
        middle, half = 0.5 * np.log(self.thin * self.wide), 0.5 * np.log(self.wide / self.thin)
        return np.asarray((np.log(gaps) - middle) / half)


@lru_cache(maxsize=MOST_HELD)
def gap_table(pad: Pad, pads: int, thin: float, wide: float, mesh: tuple[int, int] = MESH) -> GapTable:
    """The table of three or more equal pads; mesh: elements in the radius and in the angle."""
    cells, half = pad_mesh(pad, *mesh), 0.5 * np.log(wide / thin)
    at = chebyshev.chebpts1(NODES)
    values = [_functions(cells, pad, pads, float(gap)) for gap in np.sqrt(thin * wide) * np.exp(half * at)]
    return GapTable(thin, wide, pad.outer_radius, chebyshev.chebfit(at, np.array(values), NODES - 1))


def _functions(mesh: PadMesh, pad: Pad, pads: int, gap: float) -> list[float]:
    """The tabulated numbers at a gap in m, from the film of unit viscosity and speed."""
    heights = gap + pad.depth(mesh.theta)
    film: PadFilm = ring_of_pads(pad_film(mesh, heights, PadOil(1.0, SOMMERFELD), 1.0), pads)
    size = pad.outer_radius**2
    logarithms = np.log([
        film.forces[0],
        film.torque,
        film.inner_flow + film.outer_flow,
        film.stiffness[0, 0],
        film.damping[0, 0],
        pads * float(mesh.weights @ (mesh.r / heights)),
    ])
    tilts = film.stiffness[1, 1], film.stiffness[2, 1]
    relative = [each / (film.stiffness[0, 0] * size) for each in tilts]
    return [*logarithms.tolist(), *relative, film.damping[1, 1] / (film.damping[0, 0] * size)]
