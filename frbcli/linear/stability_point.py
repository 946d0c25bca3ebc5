"""A machine at rest at one speed: the coefficients of its films, and the eigenvalues of its small motions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.equilibrium import hopf
from frbcli.equilibrium.coefficients import LEAST, FilmsAtRest, RestingFilm, stacked
from frbcli.equilibrium.dynamic_films import DynamicFilm, place_errors
from frbcli.equilibrium.linearised import eigenpairs, rotor_at_rest
from frbcli.equilibrium.static_machine import MachineAtRest
from frbcli.equilibrium.warm_machine import WarmMachine
from frbcli.errors import NotConverged
from frbcli.film.cells.linearised import DynamicStiffness
from frbcli.rotor.assembly import LinearRotor
from frbcli.rotor.loads import fastest_first, ranks

if TYPE_CHECKING:  # films on pads take long to import
    from frbcli.linear.sheets.thrust import AxialState

HARDLY_KNOWN = 0.25  # error of coefficients of films that keep oil, relative, above which they are not shown
UNKNOWN_WHIRL = 0.5  # over the rotor's speed: frequency of coefficients where no motion oscillates
DIVERGENT = 1e-9  # real part over the largest absolute value from which a motion grows without oscillating


class Eigenvalue(NamedTuple):
    """An eigenvalue in 1/s, and its expected distance from the true one by the mesh, NaN if not known."""

    value: complex
    error: float


@dataclass(frozen=True)
class StabilityPoint:
    """The rotor at one speed.

    films: one per bearing of the case, of a floating ring the inner before the outer one; eigenvalues: (2 n,) in 1/s,
    on mass-conserving films only eigenvalues that grow or decay slowly, see dynamic_films.modes; ascending in
    |imaginary part|, then in the real part, of a pair the one with positive imaginary part first. ring_speeds_Hz: of
    the rings that turn; their speeds follow the motion and are states of their own; 0 against a pin. warm: the machine
    with its heat, of a case with [thermal]; its temperatures are frozen. errors: (2 n,) expected ones of the
    eigenvalues in 1/s, by the mesh of the films, empty where they were not asked for; others: stiffness and damping
    (films, c, c) on other meshes, with the share of the difference that is the error; axial: the collar under an axial
    load, None without one; rotor: the machine without its films, as small motions see it, None without rest. All others
    are empty where no static equilibrium was found; problem then says why, and is empty otherwise. """

    speed_Hz: float
    films: tuple[RestingFilm, ...]
    eigenvalues: Complex
    problem: str = ""
    ring_speeds_Hz: tuple[float, ...] = ()
    warm: WarmMachine | None = None
    errors: Array = field(default_factory=lambda: np.zeros(0))
    others: tuple[tuple[Array, Array, float], ...] = ()
    axial: AxialState | None = None
    rotor: LinearRotor | None = None

    @property
    def value(self) -> float:
        """Rotor speed in Hz, over which thresholds are sought."""
        return self.speed_Hz

    @property
    def status(self) -> str:
        """ "resting" | "not-converged"."""
        return "not-converged" if self.problem else "resting"

    @property
    def rests(self) -> bool:
        """Whether a static equilibrium was found."""
        return not self.problem

    @property
    def oscillating(self) -> Complex:
        """One eigenvalue of each oscillating pair, that with positive imaginary part, ascending in frequency."""
        return self.eigenvalues[hopf.oscillating(self.eigenvalues)]

    @property
    def modes(self) -> Complex:
        """One eigenvalue of each motion that oscillates or grows: those that grow, the fastest first, then those that
        decay, the slowest first."""
        size = np.abs(self.eigenvalues)
        divergent = (self.eigenvalues.imag >= 0.0) & (self.eigenvalues.real > DIVERGENT * size.max(initial=0.0))
        shown: Complex = self.eigenvalues[hopf.oscillating(self.eigenvalues) | divergent]
        return shown[fastest_first(shown)]

    @property
    def modes_with_errors(self) -> list[Eigenvalue]:
        """The modes with their errors."""
        return [Eigenvalue(complex(value), self.error_of(complex(value))) for value in self.modes]

    def error_of(self, value: complex) -> float:
        """The expected error of one of the eigenvalues, see Eigenvalue."""
        if not len(self.errors) or math.isnan(value.real):
            return math.nan
        return float(self.errors[int(np.argmin(np.abs(self.eigenvalues - value)))])

    @property
    def critical_error(self) -> float:
        """The expected error of the critical eigenvalue."""
        return self.error_of(self.critical)

    @property
    def growing(self) -> Complex:
        """Eigenvalues of the modes that grow."""
        modes = self.modes
        return modes[modes.real > 0.0]

    @property
    def critical(self) -> complex:
        """See critical_eigenvalue."""
        return critical_eigenvalue(self.eigenvalues)

    @property
    def growth(self) -> float:
        """Real part of the critical eigenvalue, 1/s: positive where a whirl grows; NaN without a static equilibrium."""
        return self.critical.real

    def growth_of(self, number: int) -> float:
        """Growth of the whirl number 0, 1, ... by falling growth; of the critical eigenvalue where none oscillates."""
        return hopf.growth_of(self.eigenvalues, number) if len(self.oscillating) else self.growth


def eigenvalues(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> Complex:
    """(2 n,) eigenvalues in 1/s of the rotor at omega rad/s on bearings of stiffness and damping (films, 2, 2).

    Ascending in |imaginary part|, then in the real part, of a pair the one with positive imaginary part first.
    """
    return _ordered(eigenpairs(rotor, omega, stiffness, damping)[0])


def _ordered(values: Complex) -> Complex:
    """Eigenvalues (N,) in the order of `eigenvalues`."""
    # frequencies that are equal but for round-off are one, and the real parts decide
    frequency = np.abs(values.imag)
    equal = ranks(frequency, float(np.max(np.abs(values), initial=0.0)))
    return values[np.lexsort((-values.imag, frequency, values.real, equal))]


def critical_eigenvalue(values: Complex) -> complex:
    """The eigenvalue with the largest real part among those that oscillate, or among all where none does; NaN of
    none."""
    whirling = hopf.oscillating(values)
    candidates = values[whirling] if whirling.any() else values
    return complex(candidates[fastest_first(candidates)[0]]) if len(candidates) else complex(math.nan, math.nan)


def machine_eigenvalues(machine: MachineAtRest, films: FilmsAtRest) -> Complex:
    """(2 n,) eigenvalues in 1/s of a machine at rest with its films as they are solved, on its own mesh or another."""
    return eigenvalues(machine_rotor(machine, films), machine.omega, *_coefficients(films))


def machine_rotor(
    machine: MachineAtRest, films: FilmsAtRest | None = None, frequency: float = math.nan
) -> LinearRotor:
    """A machine at rest without its films, as small motions see it; films: on another mesh, by default its own;
    frequency: of the motion in rad/s, above 0, where films keep oil that turns rings."""
    at_rest = machine.at_rest
    oil = None if math.isnan(frequency) else [film.oil_at(frequency) for film in machine.dynamic]
    return rotor_at_rest(machine.system, machine.omega, at_rest.position.ring_speeds, films or at_rest, oil)


def other_eigenvalues(machine: MachineAtRest) -> list[tuple[Complex, float]]:
    """The eigenvalues of a machine at rest on the other meshes of its films, each with the share of the difference that
    is the error."""
    if machine.dynamic:
        return [(_both(machine.modes_on_finer_films), 1.0)]
    return [(machine_eigenvalues(machine, films), share) for films, share in machine.others]


def point_at_rest(machine: MachineAtRest, speed: float, frequency: float | None = None) -> StabilityPoint:
    """The point at a speed in Hz of a machine that rests. frequency: in rad/s, of the coefficients of films that keep
    oil; by default of the least damped whirl."""
    rings = tuple((machine.at_rest.position.ring_speeds / (2 * math.pi)).tolist())
    others: tuple[tuple[Array, Array, float], ...]
    if machine.dynamic:
        values = _both(machine.modes)
        whirl = critical_eigenvalue(values).imag
        if frequency is None:
            frequency = whirl if whirl > 0.0 else UNKNOWN_WHIRL * machine.omega
        pairs = zip(machine.films, machine.dynamic, strict=True)
        films = tuple(_at_frequency(film, dynamic, frequency) for film, dynamic in pairs)
        _check_known(films)
        fine = [_by_journal(dynamic.fine, frequency) for dynamic in machine.dynamic]
        rotor = machine_rotor(machine, frequency=frequency)
        others = ((np.array([z.real for z in fine]), np.array([z.imag for z in fine]) / frequency, 1.0),)
        return StabilityPoint(speed, films, values, ring_speeds_Hz=rings, warm=machine.warm, others=others, rotor=rotor)
    rotor, values = machine_rotor(machine), machine_eigenvalues(machine, machine.at_rest)
    others = tuple((*_coefficients(films), share) for films, share in machine.others)
    return StabilityPoint(
        speed, machine.films, values, ring_speeds_Hz=rings, warm=machine.warm, others=others, rotor=rotor
    )


def with_errors(point: StabilityPoint, machine: MachineAtRest) -> StabilityPoint:
    """The point of a machine with the errors of its eigenvalues: the distance to the nearest ones on the other meshes,
    times their shares, at least LEAST of it, and in films that keep oil at least what the places of their cells leave.
    Real and imaginary part have the same one, since either may agree by chance."""
    others = [(values, share) for values, share in other_eigenvalues(machine) if len(values)]
    if not others:
        return point
    apart = [share * np.abs(point.eigenvalues[:, None] - values).min(axis=1) for values, share in others]
    if machine.dynamic:
        apart.append(place_errors(machine.oscillator, machine.dynamic, point.eigenvalues))
    return replace(point, errors=np.max([LEAST * np.abs(point.eigenvalues), *apart], axis=0))


def _coefficients(films: FilmsAtRest) -> tuple[Array, Array]:
    """(films, c, c) stiffness and damping of the films of a machine, as they are solved."""
    stiffness, damping = (
        -stacked([getattr(force, name) for force in films.forces]) for name in ("by_displacement", "by_velocity")
    )
    return stiffness, damping


def _check_known(films: Sequence[RestingFilm]) -> None:
    """Raises NotConverged if a film's coefficients are hardly known."""
    error, name = max((film.error, film.name) for film in films if not math.isnan(film.error))
    if error > HARDLY_KNOWN:
        which = f"The film {name}" if name else "The film"
        raise NotConverged(
            f"{which} has no linear coefficients on these cells: two meshes differ by {100.0 * error:.2g} %. "
            "Its fronts of oil cross cells at the least motion. Give it more supply pressure."
        )


def _both(pairs: Sequence[tuple[complex, Complex]]) -> Complex:
    """The eigenvalues of modes, both of each pair, in the order of `eigenvalues`."""
    values = np.array([value for value, _ in pairs]).astype(complex)
    return _ordered(np.concatenate([values, values[hopf.oscillating(values)].conj()]))


def _by_journal(film: DynamicStiffness, frequency: float) -> Complex:
    """(c, c) Z(i frequency) of forces and moments by the coordinates of the journal."""
    c = len(film.place) // 2 * 2
    return film.at(1j * frequency)[0][:c, :c]


def _at_frequency(film: RestingFilm, dynamic: DynamicFilm, frequency: float) -> RestingFilm:
    """The film with K = Re Z(i frequency) and D = Im Z(i frequency) / frequency in rad/s, above 0."""
    own, fine = (_by_journal(each, frequency) for each in (dynamic.own, dynamic.fine))
    error, size = film.error, len(own)
    if dynamic.exact is not None:
        blocks = [(slice(first, first + 2),) * 2 for first in range(0, size, 2)]  # forces, and moments by tilts
        pairs = [(part(own[block]), part(fine[block])) for block in blocks for part in (np.real, np.imag)]
        error = max(float(np.abs(mine - other).max() / np.abs(mine).max()) for mine, other in pairs)
    stiffness, damping = own.real, own.imag / frequency
    tilting = film.tilting and replace(film.tilting, stiffness=stiffness, damping=damping)
    return replace(film, stiffness=stiffness[:2, :2], damping=damping[:2, :2], error=error, tilting=tilting)
