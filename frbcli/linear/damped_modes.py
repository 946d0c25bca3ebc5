"""Damped modes of a rotor in its films at one speed: frequency, growth, sense of whirl, and shape."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from frbcli.arrays import Array, Complex
from frbcli.case.schema import Case
from frbcli.columns import Table, table_of
from frbcli.equilibrium.coefficients import coefficients_of
from frbcli.equilibrium.hopf import oscillating
from frbcli.equilibrium.linearised import eigenpairs
from frbcli.equilibrium.static_machine import MachineAtRest, StaticMachines
from frbcli.errors import NotConverged, input_error
from frbcli.html import Tabular
from frbcli.linear.columns import DAMPED_MODES
from frbcli.linear.critical_speeds import larger_semi_axis, whirl_direction
from frbcli.linear.stability import check_machine
from frbcli.linear.stability_point import machine_rotor, point_at_rest, with_errors
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.loads import first_largest, ranks
from frbcli.scene.remedies import advised
from frbcli.scene.shafts.table import shaft_of

UNMOVED = 1e-12  # of a ring that turns on its pin, in m over rad, below which nothing else moves


@dataclass(frozen=True)
class DampedMode:
    """One oscillating mode.

    eigenvalue: 1/s, imaginary part positive; direction: "forward" | "backward", or "mixed" where some points whirl
    forward and others backward, or all move to and fro in a line; motion: (p, 2) complex amplitudes of x and y of the
    points of a run, the largest semi-axis of all being 1; shape: (s, 2) the same along the shaft, its largest
    displacement being real; error: 1/s, expected distance of the eigenvalue from the true one.
    """

    eigenvalue: complex
    direction: str
    motion: Complex
    shape: Complex
    error: float = math.nan

    @property
    def frequency_Hz(self) -> float:
        """Damped frequency."""
        return self.eigenvalue.imag / (2.0 * math.pi)

    @property
    def damping_ratio(self) -> float:
        """-Re / |.|, negative where the mode grows."""
        return 0.0 - self.eigenvalue.real / abs(self.eigenvalue)

    @property
    def logarithmic_decrement(self) -> float:
        """Logarithm of the ratio of two amplitudes a period apart."""
        return 0.0 - 2.0 * math.pi * self.eigenvalue.real / self.eigenvalue.imag


@dataclass(frozen=True, repr=False)
class DampedModes(Tabular):
    """The oscillating modes at a rotor speed, those that grow first, then the least damped ones.

    points: the names of the p points; positions: (s,) along the shaft in m, or over its length where a case has no
    length (`to_scale` is False); marks: names and positions of bearings and disks; coefficient_error: expected one of
    the films' stiffness and damping, over the largest entry.
    """

    case: Case
    speed_Hz: float
    points: tuple[str, ...]
    positions: Array
    to_scale: bool
    marks: tuple[tuple[str, float], ...]
    modes: tuple[DampedMode, ...]
    coefficient_error: float = math.nan

    def table(self) -> Table:
        """One row per mode."""
        return table_of(DAMPED_MODES, self.modes)


def damped_modes(case: Case, speed_Hz: float) -> DampedModes:
    """Compute the damped modes of a case about its static equilibrium at a rotor speed.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    speed_Hz : float
        Rotor speed in Hz, above 0.

    Returns
    -------
    DampedModes
        Eigenvalues in 1/s and shapes.

    Raises
    ------
    InputError
        As `stability` does.
    NotConverged
        Where there is no static equilibrium.

    Examples
    --------
    >>> import frbcli
    >>> case = frbcli.load_case("jeffcott", ["film.theory=short"])
    >>> found = frbcli.damped_modes(case, 100.0)  # doctest: +SKIP
    """
    check_machine(case, [speed_Hz])
    try:
        with advised(case):
            machine = StaticMachines(case, memory=True).at(2.0 * math.pi * speed_Hz)
    except NotConverged as none:
        raise input_error(case.name or "case", "speed", f"{speed_Hz:g} Hz", str(none), "") from none
    rotor = machine_rotor(machine)
    stations = shaft_of(case).stations(rotor)
    point = with_errors(point_at_rest(machine, speed_Hz), machine)
    shapes = []
    for value, vector in _eigenvectors(rotor, machine):
        motion: Complex = np.array([place @ vector for _, place in rotor.points], dtype=np.complex128)
        shape = np.einsum("sij,j->si", stations.maps, vector)
        size = float(np.max(larger_semi_axis(np.concatenate([motion, shape]))))
        if size > UNMOVED * float(np.abs(vector).max()):
            there = shape.ravel()[first_largest(shape.ravel())]
            unit = size * there / abs(there)  # its displacement is real: eigenvectors have any phase
            own = motion / unit
            shapes.append(DampedMode(value, whirl_direction(own), own, shape / unit, point.error_of(value)))
    keys = [ranks(np.array(each)) for each in zip(*((m.frequency_Hz, m.damping_ratio) for m in shapes), strict=True)]
    shapes = [shapes[i] for i in np.lexsort(keys)] if shapes else []
    names = tuple(name for name, _ in rotor.points)
    error = max((film.error for film in point.films), default=math.nan)
    return DampedModes(
        case, speed_Hz, names, stations.positions, stations.to_scale, stations.marks, tuple(shapes), error
    )


def _eigenvectors(rotor: LinearRotor, machine: MachineAtRest) -> list[tuple[complex, Complex]]:
    """Eigenvalues with positive imaginary part in 1/s, and displacements (n,), as eigenvalues of stability.py."""
    if machine.dynamic:
        return [(value, vector) for value, vector in machine.modes if oscillating(np.array([value]))[0]]
    values, motions = eigenpairs(rotor, machine.omega, *coefficients_of(machine.films))
    return [(complex(values[i]), motions[:, i]) for i in np.flatnonzero(oscillating(values))]
