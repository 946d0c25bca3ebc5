"""A collar at rest under the axial load of a case: its films, and the motion of the rotor along its axis.

The axis moves by itself, for pads all around do not couple it to tilts: m z'' + c z' + k z = 0 with the mass m of the
rotor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from frbcli.case.schema import Case
from frbcli.elements.collar import collar_at_rest, collar_of
from frbcli.linear.thrust.state import ThrustState, thrust_films
from frbcli.scene.shafts.table import shaft_of


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
