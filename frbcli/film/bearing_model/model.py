"""A bearing model: the force of one whole bearing as a function of displacement, velocity and speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

from frbcli.errors import Fault, InputError
from frbcli.film.cavitation.law import Key


@dataclass(frozen=True)
class BearingDimensions:
    """Dimensions of a bearing from its case, SI units: the first fields of the record that a model's functions take.

    width: of the whole bearing; clearance: radial; sections: equal rectangles of the developed gap side by side, 2 with
    a circumferential groove in the middle, else 1; section_width: width / sections; pressures are absolute, that of the
    supply is the ambient one if there is none.
    """

    width: float
    diameter: float
    clearance: float
    viscosity: float
    sections: float
    section_width: float
    ambient_pressure: float
    cavitation_pressure: float
    supply_pressure: float


DIMENSIONS = tuple(field.name for field in fields(BearingDimensions))


@dataclass(frozen=True, eq=False)
class BearingModel:
    """A bearing of one's own, for film.theory.

    name: in film.theory, its keys stand in [film.NAME]; label: in pictures.
    force(d_x, d_y, v_x, v_y, omega, bearing) -> (F_x, F_y): force in N on the journal by one whole bearing, of the
    displacement d of the journal against its shell in m, its rate v in m/s, and omega = omega_J + omega_S in rad/s, the
    sum of the angular speeds of journal and shell. bearing: a record of BearingDimensions and then the keys, in SI; a
    key with choices counts them from 0, one that is not given is NaN. It is asked within the clearance only, |d| < C.
    derivatives: takes the same and returns eight numbers, those of F_x, then F_y by d_x, d_y in N/m, and those of F_x,
    then F_y by v_x, v_y in N s/m; if it is not given they are taken by central differences.
    flow: takes the same and returns the oil that leaves the open ends of one whole bearing, in m^3/s; a case with heat
    needs it, unless its thermal.side_flow is "concentric". sheared: share of the gap in which the slip of journal and
    shell shears oil: 0 of a damper, whose journal does not spin. The power of the film follows from it and the force.
    All are functions compiled by numba.njit, or plain ones that numba can compile; see docs/adding-a-model.md.
    keys: of the table [film.NAME]; meaning: of that table, a sentence.
    """

    name: str
    label: str
    force: Callable[..., Any]
    derivatives: Callable[..., Any] | None = None
    keys: tuple[Key, ...] = ()
    meaning: str = ""
    flow: Callable[..., Any] | None = None
    sheared: float = 1.0

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the fields of the record that the functions take."""
        return (*DIMENSIONS, *(key.name for key in self.keys))


def wrong(model: BearingModel, key: str, problem: str, remedy: str) -> InputError:
    """The error of a model that cannot be added."""
    return InputError(f"bearing model {model.name}", (Fault(key, "", None, problem, remedy),))
