"""A machine at rest at one speed: the coefficients of its films, and the eigenvalues of its small motions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from frbcli.equilibrium import hopf
from frbcli.equilibrium.coefficients import FilmsAtRest, RestingFilm
from frbcli.equilibrium.linearised import state_matrix
from frbcli.equilibrium.static_machine import MachineAtRest
from frbcli.equilibrium.warm_machine import WarmMachine
from frbcli.rotor.linear import LinearRotor, without_spins
from frbcli.rotor.order import fastest_first, ranks

Array = NDArray[np.float64]
Eigenvalues = NDArray[np.complex128]

DIVERGENT = 1e-9  # real part over the largest absolute value from which a motion grows without oscillating


@dataclass(frozen=True)
class StabilityPoint:
    """The rotor at one speed.

    films: one per bearing of the case, of a floating ring the inner before the outer one; eigenvalues: (2 n,) in 1/s,
    ascending in |imaginary part|, then in the real part, of a pair the one with positive imaginary part first.
    ring_speeds_Hz: of the rings that turn; their speeds stand while the rotor moves. warm: the machine with its heat,
    of a case that has it; its temperatures stand, too. All are empty where no resting
    position was found; problem then says why, and is empty otherwise.
    """

    speed_Hz: float
    films: tuple[RestingFilm, ...]
    eigenvalues: Eigenvalues
    problem: str = ""
    ring_speeds_Hz: tuple[float, ...] = ()
    warm: WarmMachine | None = None

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
        """Whether a resting position was found."""
        return not self.problem

    @property
    def oscillating(self) -> Eigenvalues:
        """One eigenvalue of each oscillating pair, that with positive imaginary part, ascending in frequency."""
        return self.eigenvalues[hopf.oscillating(self.eigenvalues)]

    @property
    def modes(self) -> Eigenvalues:
        """One eigenvalue of each motion that oscillates or grows: those that grow, the fastest first, then those that
        decay, the slowest first."""
        size = np.abs(self.eigenvalues)
        divergent = (self.eigenvalues.imag >= 0.0) & (self.eigenvalues.real > DIVERGENT * size.max(initial=0.0))
        told: Eigenvalues = self.eigenvalues[hopf.oscillating(self.eigenvalues) | divergent]
        return told[fastest_first(told)]

    @property
    def growing(self) -> Eigenvalues:
        """Those of the modes that grow."""
        modes = self.modes
        return modes[modes.real > 0.0]

    @property
    def critical(self) -> complex:
        """See critical_eigenvalue."""
        return critical_eigenvalue(self.eigenvalues)

    @property
    def growth(self) -> float:
        """Real part of the critical eigenvalue, 1/s: positive where a whirl grows; NaN without a resting position."""
        return self.critical.real

    def growth_of(self, number: int) -> float:
        """That of the whirl number 0, 1, ... by falling growth; of the critical eigenvalue where none oscillates."""
        return hopf.growth_of(self.eigenvalues, number) if len(self.oscillating) else self.growth


def eigenvalues(rotor: LinearRotor, omega: float, stiffness: Array, damping: Array) -> Eigenvalues:
    """(2 n,) eigenvalues in 1/s of the rotor at omega rad/s on bearings of stiffness and damping (films, 2, 2).

    Ascending in |imaginary part|, then in the real part, of a pair the one with positive imaginary part first.
    """
    values = np.linalg.eigvals(state_matrix(rotor, omega, stiffness, damping)).astype(complex)
    # frequencies that are equal but for round-off are one, and the real parts decide
    frequency = np.abs(values.imag)
    equal = ranks(frequency, float(np.max(np.abs(values))))
    return values[np.lexsort((-values.imag, frequency, values.real, equal))]


def critical_eigenvalue(values: Eigenvalues) -> complex:
    """The eigenvalue with the largest real part among those that oscillate, or among all where none does; NaN of
    none."""
    whirling = hopf.oscillating(values)
    candidates = values[whirling] if whirling.any() else values
    return complex(candidates[fastest_first(candidates)[0]]) if len(candidates) else complex(math.nan, math.nan)


def machine_eigenvalues(machine: MachineAtRest, films: FilmsAtRest) -> Eigenvalues:
    """(2 n,) eigenvalues in 1/s of a machine at rest with its films as they are solved, on its own mesh or another."""
    stiffness, damping = (
        -np.array([getattr(force, name) for force in films.forces]).reshape(-1, 2, 2)
        for name in ("by_displacement", "by_velocity")
    )
    system = machine.system
    return eigenvalues(without_spins(system.rotor, system.ring_count), machine.omega, stiffness, damping)


def point_at_rest(machine: MachineAtRest, speed: float) -> StabilityPoint:
    """The point at a speed in Hz of a machine that rests."""
    rings = tuple((machine.at_rest.position.ring_speeds / (2 * math.pi)).tolist())
    values = machine_eigenvalues(machine, machine.at_rest)
    return StabilityPoint(speed, machine.films, values, ring_speeds_Hz=rings, warm=machine.warm)
