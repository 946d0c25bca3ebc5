"""The sheet of a thrust bearing over gap, load and speed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from frbcli.case.schema import Case
from frbcli.columns import Table, table_of
from frbcli.elements.collar.collar import BOTH, Collar, NotCarried, collar_of, collar_under
from frbcli.errors import input_error
from frbcli.html import Tabular
from frbcli.linear.thrust.columns import THRUST
from frbcli.linear.thrust.faults import no_gap, require_sheet
from frbcli.linear.thrust.state import ThrustFilms, ThrustState, thrust_films
from frbcli.units import display

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
    require_sheet(case, gaps or ())
    speeds = sorted(_speeds(case) if speeds_Hz is None else speeds_Hz)
    states: list[ThrustState] = []
    for bearing in case.thrust_bearings:
        films = thrust_films(case, bearing)
        collar = collar_of(case) or collar_under(case, bearing, 0.0)
        acts = case.axial is not None and gaps is None and not loads
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
        raise no_gap(load, f"is below the {low:.4g} N that the film carries at a gap of {display(collar.wide, 'm')}.")
    try:
        return replace(collar, load=load).rest(omega).gap
    except NotCarried as error:
        raise no_gap(load, f"is not carried. {error}") from None


def _gaps(films: ThrustFilms) -> list[float]:
    """Gaps in m over the range of a thrust bearing."""
    bearing = films.bearing
    if bearing.side == BOTH and bearing.end_play is not None:
        return [bearing.end_play * share for share in np.linspace(0.05, 0.5, POINTS).tolist()]
    return [bearing.taper * share for share in np.geomspace(0.25, 2.5, POINTS).tolist()]


def _speeds(case: Case) -> tuple[float, ...]:
    if case.given_speed is not None:
        return (max(abs(case.speed.start), abs(case.speed.end)),)
    problem, remedy = "is missing.", 'Give --speed, e.g. --speed "900 Hz", or add [speed].'
    raise input_error(case.name or "case", "speed", "", problem, remedy)
