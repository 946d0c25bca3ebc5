"""Thrust bearings: the state at one gap and speed, with its error from a coarser mesh; a collar at rest under the axial
load of a case; and the sheet over gap, load and speed.

The axis of a rotor moves by itself, for pads all around do not couple it to tilts: m z'' + c z' + k z = 0 with the mass
m of the rotor.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from frbcli.arrays import Array
from frbcli.case.elements import ThrustBearing
from frbcli.case.oil import Oil, Thermal
from frbcli.case.schema import Case
from frbcli.columns import Table, Tabular, table_of
from frbcli.elements.collar import BOTH, Collar, NotCarried, collar_at_rest, collar_of, collar_under, pad_of
from frbcli.errors import InputError, input_error
from frbcli.film.pad_geometry import COARSE, MESH, Pad
from frbcli.film.pads import PadFilm, PadMesh, PadOil, pad_film, pad_mesh, ring_of_pads
from frbcli.linear.columns import THRUST
from frbcli.scene.gate.rule import sheet_top
from frbcli.scene.gate.static import require_thrust_sheet
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.units import display

if TYPE_CHECKING:
    from frbcli.elements.collar import PadHeat


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
    from frbcli.elements.collar import PadHeat  # its kernels are compiled

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


@dataclass(frozen=True)
class AxialState:
    """A collar at rest. axial_load: on the rotor towards larger positions, N; position: of the collar in m, from the
    middle of the end play, or from the pads of its only side; films: of the thrust bearing; mass: of the rotor in
    kg."""

    axial_load: float
    position: float
    films: ThrustState
    mass: float

    @property
    def eigenvalue(self) -> complex:
        """Eigenvalue of the axial motion in 1/s: of a pair the one with a positive imaginary part, else the slower."""
        roots = np.roots([self.mass, self.films.damping, self.films.stiffness])
        return complex(max(roots, key=lambda root: (root.imag, root.real)))

    @property
    def frequency(self) -> float:
        """Frequency of the axial motion in Hz, 0 if it does not oscillate."""
        return self.eigenvalue.imag / (2.0 * np.pi)


def axial_state(case: Case, omega: float) -> AxialState | None:
    """The collar of a case at rest at a speed in rad/s; None without an axial load. Raises NotConverged if no film
    carries it."""
    collar = collar_of(case)
    if collar is None:
        return None
    rest = collar_at_rest(collar, omega)
    films = thrust_films(case, collar.bearing).state(rest.gap, omega)
    return AxialState(rest.load, collar.position(rest), films, shaft_of(case).mass)


Observer = Callable[[int, int], None]
POINTS = 10


@dataclass(frozen=True, repr=False)
class ThrustSheet(Tabular):
    """States of the thrust bearings of a case: bearing by bearing, speed by speed, gap by gap."""

    case: Case
    bearings: tuple[str, ...]
    points: tuple[ThrustState, ...]

    def of(self, bearing: str) -> tuple[ThrustState, ...]:
        """The states of one thrust bearing."""
        return tuple(point for point in self.points if point.bearing == bearing)

    def table(self) -> Table:
        """One row per state."""
        return table_of(THRUST, self.points)


def thrust_sheet(
    case: Case,
    gaps: Sequence[float] | None = None,
    speeds_Hz: Sequence[float] | None = None,
    loads: Sequence[float] = (),
    observe: Observer | None = None,
) -> ThrustSheet:
    """Compute the thrust bearings of a case over their gap, or the gap that carries a load, and speed.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`; [[thrust_bearing]] and [oil] will do.
    gaps : sequence of float, optional
        Gaps in m over the lands, of a runner without tilt; by default, without `loads`, that at which the axial load
        of the case is carried, or ten over the range of the bearing: up to 2.5 times the taper, or to half of the end
        play of pads on both sides.
    speeds_Hz : sequence of float, optional
        Rotor speeds in Hz, above 0; by default the highest of the case.
    loads : sequence of float, optional
        Loads in N, above 0, whose gap is found.
    observe : callable, optional
        Called with each state's number and their number.

    Returns
    -------
    ThrustSheet
        Gap in m, load in N, torque in N m, loss in W, flows in m^3/s, pressure in Pa, axial stiffness in N/m and
        damping in N s/m, those in tilt in N m and N m s per rad, of every state, with the errors of its mesh.

    Raises
    ------
    InputError
        If the case has no thrust bearing or no speed, a model that its films do not have, a gap beyond the end play,
        or a load that no gap carries.
    NotConverged
        If the cavity in a film by Reynolds' condition is not found, or, with heat, a film becomes too hot.

    Examples
    --------
    >>> import frbcli
    >>> sheet = frbcli.thrust_sheet(frbcli.load_case("thrust"), [15e-6], [2000.0])
    >>> round(sheet.points[0].load)
    446
    """
    require_thrust_sheet(case, gaps or ())
    speeds = sorted([sheet_top(case)] if speeds_Hz is None else speeds_Hz)
    states: list[ThrustState] = []
    for bearing in case.thrust_bearings:
        films = thrust_films(case, bearing)
        collar = collar_of(case) or collar_under(case, bearing, 0.0)
        acts = case.loads_a_collar and gaps is None and not loads
        asked = _gaps(films) if gaps is None and not (loads or acts) else sorted(gaps or ())
        count = len(case.thrust_bearings) * len(speeds) * (len(asked) + len(loads) + acts)
        for speed in speeds:
            omega = 2.0 * math.pi * speed
            at_rest = [collar.rest(omega).gap] if acts else []
            for gap in (*at_rest, *asked, *(_gap_of(collar, load, omega) for load in sorted(loads, reverse=True))):
                states.append(films.state(gap, omega))
                if observe is not None:
                    observe(len(states), count)
    return ThrustSheet(case, tuple(bearing.name for bearing in case.thrust_bearings), tuple(states))


def _gap_of(collar: Collar, load: float, omega: float) -> float:
    """The gap in m that carries a load in N. Raises InputError if there is none."""
    low = collar.carried(collar.wide, omega)
    if load < low:
        raise _no_gap(load, f"is below the {low:.4g} N that the film carries at a gap of {display(collar.wide, 'm')}.")
    try:
        return replace(collar, load=load).rest(omega).gap
    except NotCarried as error:
        raise _no_gap(load, f"is not carried. {error}") from None


def _gaps(films: ThrustFilms) -> list[float]:
    """Gaps in m over the range of a thrust bearing."""
    bearing = films.bearing
    if bearing.side == BOTH and bearing.end_play is not None:
        return [bearing.end_play * share for share in np.linspace(0.05, 0.5, POINTS).tolist()]
    return [bearing.taper * share for share in np.geomspace(0.25, 2.5, POINTS).tolist()]


def _no_gap(load: float, problem: str) -> InputError:
    """The error of a load in N that no gap carries."""
    remedy = "Give another load, or change the pads, the oil or the speed."
    return input_error("case", "--load", f"{load:.6g} N", problem, remedy)
