"""The sheet of a thrust bearing over gap, load and speed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from frbcli.case.schema import Case
from frbcli.columns import Table, table_of
from frbcli.errors import Fault, InputError, NotConverged
from frbcli.html import Tabular
from frbcli.linear.thrust.columns import THRUST
from frbcli.linear.thrust.faults import no_gap, require_sheet
from frbcli.linear.thrust.state import BOTH, ThrustFilms, ThrustState, thrust_films

Observer = Callable[[int, int], None]

LEAST_GAP = 1e-7  # m, of a load that is searched: thinner films lie below the roughness of any pad
WIDER = 1.2  # than a gap whose film becomes too hot
WIDEST = 100.0  # gap over the taper
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
        Gaps in m over the lands, of a runner without tilt; by default, without `loads`, ten over the range of the
        bearing: up to 2.5 times the taper, or to half of the end play of pads on both sides.
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
    found: list[ThrustState] = []
    for bearing in case.thrust_bearings:
        films = thrust_films(case, bearing)
        asked = _gaps(films) if gaps is None and not loads else sorted(gaps or ())
        count = len(case.thrust_bearings) * len(speeds) * (len(asked) + len(loads))
        for speed in speeds:
            omega = 2.0 * math.pi * speed
            for gap in (*asked, *(_gap_of(case, films, load, omega) for load in sorted(loads, reverse=True))):
                found.append(films.state(gap, omega))
                if observe is not None:
                    observe(len(found), count)
    return ThrustSheet(case, tuple(bearing.name for bearing in case.thrust_bearings), tuple(found))


def _gap_of(case: Case, films: ThrustFilms, load: float, omega: float) -> float:
    """The gap in m that carries a load in N. Raises InputError if there is none."""
    play = films.bearing.end_play
    wide = 0.5 * play if films.bearing.side == BOTH and play is not None else WIDEST * films.bearing.taper
    thin = min(LEAST_GAP, 0.01 * wide)
    thin, high = _thinnest(films, thin, wide, omega)
    low = films.load(wide, omega)
    if not low <= load <= high:
        raise no_gap(case, load, (thin, high), (wide, low))

    def missing(logarithm: float) -> float:
        return films.load(math.exp(logarithm), omega) / load - 1.0

    return math.exp(float(brentq(missing, math.log(thin), math.log(wide), xtol=1e-12, rtol=1e-12)))


def _thinnest(films: ThrustFilms, thin: float, wide: float, omega: float) -> tuple[float, float]:
    """The thinnest gap in m from `thin` on whose film does not become too hot, and its load in N."""
    while thin < wide:
        try:
            return thin, films.load(thin, omega)
        except NotConverged:
            if films.heat is None:
                raise
        thin *= WIDER
    return wide, films.load(wide, omega)


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
    raise InputError(case.name or "case", (Fault("speed", "", None, problem, remedy),))
