"""The state of a thrust bearing at one gap and speed, with its error from a coarser mesh."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array
from frbcli.case.elements import ThrustBearing
from frbcli.case.oil import Oil
from frbcli.case.schema import Case
from frbcli.case.thermal import Thermal
from frbcli.elements.collar.collar import BOTH, pad_of
from frbcli.film.pads.film import PadFilm, PadOil, pad_film, ring_of_pads
from frbcli.film.pads.geometry import COARSE, MESH, Pad
from frbcli.film.pads.mesh import PadMesh, pad_mesh

if TYPE_CHECKING:
    from frbcli.elements.collar.heat import PadHeat

COEFFICIENTS = "stiffness", "damping"
OilAt = tuple[PadOil, float | None]  # of a film, and its temperature in K


@dataclass(frozen=True, repr=False)
class ThrustState:
    """The films of a thrust bearing. gap: over the lands in m, on the loaded side; load in N; torque in N m; flows in
    m^3/s; p_max: absolute in Pa; stiffness, damping: axial; tilt_stiffness, tilt_damping: 2 x 2 over x and y, in N m
    and N m s per rad; viscosity in Pa s, temperature in K: of the loaded side; pressure: absolute at the nodes of a pad
    of the loaded side in Pa; errors: relative."""

    bearing: str
    speed_Hz: float
    gap: float
    load: float
    torque: float
    power: float
    flow_inner: float
    flow_outer: float
    flow_leading: float
    p_max: float
    stiffness: float
    damping: float
    tilt_stiffness: Array
    tilt_damping: Array
    viscosity: float
    temperature: float | None
    load_error: float
    coefficient_error: float
    pressure: Array


@dataclass(frozen=True)
class ThrustFilms:
    """What computes the films of a thrust bearing over gap and speed: its pad, planned and coarse mesh, and oil."""

    bearing: ThrustBearing
    pad: Pad
    mesh: PadMesh
    coarse: PadMesh
    oil: PadOil
    ambient_pressure: float
    temperature: float | None
    heat: PadHeat | None = None

    def load(self, gap: float, omega: float) -> float:
        """The load in N that the film carries at a gap in m and a speed in rad/s. Raises NotConverged as `state`."""
        films = self._sides(self.mesh, gap, omega, self._oils(gap, omega))
        return _sum(films, lambda film: float(film.forces[0]), opposed=True)

    def state(self, gap: float, omega: float) -> ThrustState:
        """The state at a gap in m and a speed in rad/s. Raises NotConverged as `pad_film`, and with heat where a film
        becomes too hot."""
        oils = self._oils(gap, omega)
        films = self._sides(self.mesh, gap, omega, oils)
        torque = _sum(films, lambda film: film.torque)
        stiffness, damping = (np.sum([getattr(film, name) for film in films], axis=0) for name in COEFFICIENTS)
        load_error, coefficient_error = _errors(films, self._sides(self.coarse, gap, omega, oils))
        return ThrustState(
            bearing=self.bearing.name,
            speed_Hz=omega / (2.0 * np.pi),
            gap=gap,
            load=_sum(films, lambda film: float(film.forces[0]), opposed=True),
            torque=torque,
            power=torque * omega,
            flow_inner=_sum(films, lambda film: film.inner_flow),
            flow_outer=_sum(films, lambda film: film.outer_flow),
            flow_leading=_sum(films, lambda film: film.leading_flow),
            p_max=self.ambient_pressure + max(film.largest_pressure for film in films),
            stiffness=float(stiffness[0, 0]),
            damping=float(damping[0, 0]),
            tilt_stiffness=stiffness[1:, 1:],
            tilt_damping=damping[1:, 1:],
            viscosity=oils[0][0].viscosity,
            temperature=oils[0][1],
            load_error=load_error,
            coefficient_error=coefficient_error,
            pressure=self.ambient_pressure + films[0].pressure,
        )

    def _sides(self, mesh: PadMesh, gap: float, omega: float, oils: Sequence[OilAt]) -> tuple[PadFilm, ...]:
        """The film of the loaded side, and of the other side where it has pads, too. A tilt changes the gaps of both by
        opposite amounts, and their forces are opposed, so that stiffness and damping add up."""
        pairs = zip(self._gaps(gap), oils, strict=True)
        return tuple(self._film(mesh, each, oil, omega) for each, (oil, _) in pairs)

    def _film(self, mesh: PadMesh, gap: float, oil: PadOil, omega: float) -> PadFilm:
        """All pads of a side."""
        return ring_of_pads(pad_film(mesh, gap + self.pad.depth(mesh.theta), oil, omega), self.bearing.pads)

    def _gaps(self, gap: float) -> tuple[float, ...]:
        bearing = self.bearing
        return (gap, bearing.end_play - gap) if bearing.side == BOTH and bearing.end_play is not None else (gap,)

    def _oils(self, gap: float, omega: float) -> tuple[OilAt, ...]:
        """The oil of each side, from the case or, with heat, as warm as it becomes."""
        return tuple(self._oil(each, omega) for each in self._gaps(gap))

    def _oil(self, gap: float, omega: float) -> OilAt:
        if self.heat is None:
            return self.oil, self.temperature
        mesh = self.mesh
        inverse = self.bearing.pads * float(mesh.weights @ (mesh.r / (gap + self.pad.depth(mesh.theta))))

        def loss_and_flow(viscosity: float) -> tuple[float, float]:
            film = self._film(mesh, gap, replace(self.oil, viscosity=viscosity), omega)
            return omega * film.torque, film.inner_flow + film.outer_flow

        viscosity, temperature = self.heat.warm(loss_and_flow, omega, gap, inverse)
        return replace(self.oil, viscosity=viscosity), temperature


def thrust_films(case: Case, bearing: ThrustBearing) -> ThrustFilms:
    """What computes the films of a thrust bearing of a case."""
    oil, pad = case.oil, pad_of(bearing)
    pressure = oil.cavitation_pressure - oil.ambient_pressure
    film_oil = PadOil(case.oil_viscosity, case.film.cavitation, pressure)
    meshes = pad_mesh(pad, *MESH), pad_mesh(pad, *COARSE)
    heat = None if case.heat is None else _heat(case.oil, case.heat)
    return ThrustFilms(bearing, pad, *meshes, film_oil, oil.ambient_pressure, oil.temperature, heat)


def _heat(oil: Oil, thermal: Thermal) -> PadHeat:
    from frbcli.elements.collar.heat import PadHeat  # its kernels are compiled

    return PadHeat(oil, thermal)


def _sum(films: tuple[PadFilm, ...], read: Callable[[PadFilm], float], opposed: bool = False) -> float:
    """The sum over both sides, or their difference."""
    first, *others = map(read, films)
    return first - sum(others) if opposed else first + sum(others)


def _errors(films: tuple[PadFilm, ...], coarse: tuple[PadFilm, ...]) -> tuple[float, float]:
    """Relative errors of load and coefficients: the change from the coarse to the planned mesh, which is above the
    error that is left where the order is at least one."""
    load, coefficients = 0.0, 0.0
    for fine, other in zip(films, coarse, strict=True):
        load = max(load, _change(fine.forces[:1], other.forces[:1]))
        for a, b in ((fine.stiffness, other.stiffness), (fine.damping, other.damping)):
            coefficients = max(coefficients, _change(a[:1, :1], b[:1, :1]), _change(a[1:, 1:], b[1:, 1:]))
    return load, coefficients


def _change(fine: Array, coarse: Array) -> float:
    largest = float(np.abs(fine).max())
    return float(np.abs(fine - coarse).max()) / largest if largest else 0.0
