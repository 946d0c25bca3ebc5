"""Balance quality grades of ISO 21940-11, for rotors that do not bend at their speed.

A grade G is the permissible speed of the centre of mass about the axis, so that a rotor of the mass m may have

    U_per = G m / Omega.

Between two tolerance planes at the bearings, U_per is divided by the levers of the centre of mass,

    U_A = U_per L_B / L,    U_B = U_per L_A / L,

but none has less than 0.3 of it, nor more than 0.7, or 1.3 where the centre of mass overhangs. What the case has is
transferred to these planes by the same levers, each unbalance as a vector."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from frbcli.arrays import Array
from frbcli.case.schema import Case
from frbcli.columns import Column, Shown, Table, Tabular, table_of
from frbcli.errors import input_error
from frbcli.scene.gate.gate import require
from frbcli.scene.machine.shaft import Shaft
from frbcli.scene.machine.turbocharger import shaft_of
from frbcli.units import SPEED, ValueFault, quantity

GRADE = re.compile(r"\s*[Gg]?\s*([\d.eE+-]+)\s*(?:mm/s)?\s*")
LARGEST = 1e4  # mm/s; the standard ends at 4000
LEAST_SHARE, MOST_INBOARD, MOST_OVERHUNG = 0.3, 0.7, 1.3  # of U_per, in a plane
DISK, SUM, BEARING = "disk", "sum", "bearing"  # kinds of rows


@dataclass(frozen=True)
class PlaneUnbalance:
    """Unbalance in a plane. kind: "disk", what the case has there; "sum", of all as vectors; "bearing", a tolerance
    plane. unbalance in kg m with its angle on the rotor; permissible: in kg m, None of a disk."""

    plane: str
    kind: str
    unbalance: complex
    permissible: float | None = None

    @property
    def size(self) -> float:
        """In kg m."""
        return abs(self.unbalance)

    @property
    def angle_deg(self) -> float | None:
        """On the rotor; None without unbalance."""
        return math.degrees(cmath.phase(self.unbalance)) if self.unbalance else None

    @property
    def ratio(self) -> float | None:
        """Over the permissible one."""
        return None if self.permissible is None else self.size / self.permissible

    @property
    def within(self) -> bool | None:
        """Whether it is permissible, None of a disk."""
        return None if self.ratio is None else self.ratio <= 1.0


COLUMNS = (
    Column("plane", "", "disk, `sum` of all as vectors, or bearing as a tolerance plane", shown=(Shown("plane"),)),
    Column("kind", "", "`disk`, `sum` or `bearing`", shown=(Shown("kind"),)),
    Column("unbalance", "kg m", "unbalance", attrgetter("size"), shown=(Shown("g mm", lambda u: f"{1e6 * u:.4g}"),)),
    Column("angle", "deg", "its angle on the rotor", attrgetter("angle_deg"), more="none without unbalance",
           shown=(Shown("deg", ".1f"),)),
    Column("permissible", "kg m", "permissible unbalance", attrgetter("permissible"), more="none of a disk",
           shown=(Shown("permissible", lambda u: f"{1e6 * u:.4g}"),)),
    Column("ratio", "", "unbalance over the permissible one", shown=(Shown("ratio", ".3g"),)),
    Column("within", "", "whether it is permissible", shown=(Shown("", lambda it: "within" if it else "too much"),)),
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class BalanceQuality(Tabular):
    """The unbalance of a case compared with a balance quality grade.

    grade_mm_s: asked for; speed_Hz: at which; mass: kg; centre_of_mass: along the shaft in m, None where bearings have
    no positions; planes: disks, their sum, and the bearings where the permissible unbalance is divided.
    """

    case: Case
    grade_mm_s: float
    speed_Hz: float
    mass: float
    centre_of_mass: float | None
    planes: tuple[PlaneUnbalance, ...]

    @property
    def permissible(self) -> float:
        """Of the whole rotor, kg m."""
        return permissible_unbalance(self.grade_mm_s, self.mass, self.speed_Hz)

    @property
    def reached_mm_s(self) -> float:
        """The smallest grade that the unbalance in all tolerance planes meets, mm/s."""
        return self.grade_mm_s * max(plane.ratio for plane in self.planes if plane.ratio is not None)

    @property
    def within(self) -> bool:
        """Whether sum and tolerance planes are permissible."""
        return all(plane.within is not False for plane in self.planes)

    def table(self) -> Table:
        """A row for each disk, their sum, and each tolerance plane."""
        return table_of(COLUMNS, self.planes)


def read_grade(given: str | float) -> float:
    """A grade in mm/s: "G6.3", "G 2.5" or "1". Raises ValueFault for anything else."""
    parts = GRADE.fullmatch(str(given))
    try:
        grade = float(parts[1]) if parts else math.nan
    except ValueError:
        grade = math.nan
    if not 0.0 < grade <= LARGEST:
        raise ValueFault("is no balance quality grade.", "Write e.g. G6.3, G2.5, G1 or 0.4, in mm/s.")
    return grade


def permissible_unbalance(grade_mm_s: float, mass: float, speed_Hz: float) -> float:
    """U_per in kg m of a rotor of a mass in kg."""
    return 1e-3 * grade_mm_s * mass / (2.0 * math.pi * speed_Hz)


def balance_quality(case: Case, grade: str | float, speed_Hz: float | None = None) -> BalanceQuality:
    """Compare the unbalance of a case with a balance quality grade of ISO 21940-11.

    Parameters
    ----------
    case : Case
        The machine, see `load_case`.
    grade : str or float
        Such as "G6.3", or 6.3, in mm/s.
    speed_Hz : float, optional
        The highest speed of operation in Hz; by default from the case.

    Returns
    -------
    BalanceQuality
        Unbalance of disks, of their sum, and of both bearings, with what the grade permits.

    Raises
    ------
    InputError
        If the case cannot be modelled, there is no such grade, or the rotor does not turn.

    Examples
    --------
    >>> import frbcli
    >>> found = frbcli.balance_quality(frbcli.load_case("jeffcott"), "G2.5")
    >>> found.within, round(1e6 * found.permissible, 2)  # in g mm
    (True, 8.09)
    """
    require(case)
    try:
        grade_mm_s = read_grade(grade)
        speed = case.speed.top if speed_Hz is None else quantity(speed_Hz, SPEED)
    except ValueFault as fault:
        raise input_error(case.name or "case", "grade", str(grade), fault.problem, fault.remedy) from None
    if not speed > 0.0:
        raise input_error(case.name or "case", "speed", f"{speed:g} Hz", "is not above 0.", "Give one of operation.")
    shaft = shaft_of(case)
    whole = permissible_unbalance(grade_mm_s, shaft.mass, speed)
    disks = [PlaneUnbalance(plane.name, DISK, plane.unbalance) for plane in shaft.planes]
    total = PlaneUnbalance(SUM, SUM, sum((plane.unbalance for plane in shaft.planes), 0j), whole)
    planes = (*disks, total, *_at_bearings(case, shaft, whole))
    return BalanceQuality(case, grade_mm_s, speed, shaft.mass, shaft.centre_of_mass, planes)


def _at_bearings(case: Case, shaft: Shaft, whole: float) -> tuple[PlaneUnbalance, ...]:
    """The tolerance planes of a rotor in two bearings: of all, or those with a film. Empty for other numbers of them,
    and for symmetric rotors, whose bearings have half of the sum each."""
    centre, bearings = shaft.centre_of_mass, case.placed_bearings
    pair: Sequence[object] = bearings if len(bearings) == 2 else case.bearings
    if centre is None or len(pair) != 2:
        return ()
    places = {bearing.name: bearing.position or 0.0 for bearing in bearings if bearing in pair}
    first, second = sorted(places, key=places.__getitem__)
    low, high = places[first], places[second]
    if not high > low:
        return ()

    def levers(position: float) -> Array:
        share = (high - position) / (high - low)
        return np.array([share, 1.0 - share])

    most = MOST_INBOARD if low <= centre <= high else MOST_OVERHUNG
    permitted = whole * np.clip(levers(centre), LEAST_SHARE, most)
    parts = sum((plane.unbalance * levers(plane.position or 0.0) for plane in shaft.planes), np.zeros(2, complex))
    named = zip((first, second), parts.tolist(), permitted.tolist(), strict=True)
    return tuple(PlaneUnbalance(name, BEARING, part, limit) for name, part, limit in named)
