"""Influence coefficients: the synchronous motion of points by a unit of unbalance in each plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from frbcli.arrays import Complex
from frbcli.case.schema import Case
from frbcli.equilibrium.coefficients import coefficients_of
from frbcli.errors import NotConverged, input_error
from frbcli.linear.response import Response, forced_motion, response
from frbcli.nearest import did_you_mean
from frbcli.scene.shafts.shaft import BalancingPlane
from frbcli.scene.shafts.table import shaft_of


def planes_named(case: Case, names: Sequence[str]) -> tuple[BalancingPlane, ...]:
    """The planes of a case with these names. Raises InputError for one that it does not have."""
    known = {plane.name: plane for plane in shaft_of(case).planes}
    for name in names:
        if name not in known:
            problem = f"is no disk of {case.name or 'the case'}."
            raise input_error("balance", "planes", name, problem, did_you_mean(name, known))
    return tuple(known[name] for name in names)


def computed_influence(
    case: Case, planes: Sequence[BalancingPlane], speeds_Hz: Sequence[float], points: Sequence[str]
) -> tuple[Response, Complex]:
    """The response of a case at s speeds, and (s, p, 2, k) in m/(kg m) what p points move along x and y by a unit of
    unbalance in each of k planes, at the angle 0 of the rotor, linearised about the static equilibria.

    Raises InputError as response does, NotConverged if the rotor does not rest at a speed."""
    linear = response(case, speeds_Hz)
    if len(linear.speeds_Hz) < len(set(speeds_Hz)):
        raise NotConverged("The rotor has no static equilibrium at some of the speeds. Choose others, by --at.")
    influence = []
    for point in linear.resting:
        rotor, omega = point.rotor, 2.0 * np.pi * point.speed_Hz
        if rotor is None:
            continue
        nodes = dict(rotor.points)
        pull = np.stack([omega**2 * (nodes[plane.node][1] + 1j * nodes[plane.node][0]) for plane in planes], axis=-1)
        motion = forced_motion(rotor, omega, (omega, pull), *coefficients_of(point.films))
        influence.append([nodes[name] @ motion for name in points])
    return linear, np.array(influence)
