"""The Stribeck curve of a rotation under a load: coefficient of friction of film and summits over the speed, from
boundary friction to the film alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.bearing_tests.resting import COARSE_CELLS
from frbcli.bearing_tests.tested_film import tested_film
from frbcli.case.schema import Case
from frbcli.errors import NotConverged
from frbcli.film.cells.motion import Motion
from frbcli.film.operating import friction_coefficient
from frbcli.scene.machine.system import rubbing_of
from frbcli.scene.planning.kinematic_plan import KinematicPlan

RATIO, MOST = 10.0**0.2, 24  # of two speeds of a curve, and points on either side of the speed of the test
BOUNDARY = 0.9  # share of the summits in the load, from which on they carry it
FILM_ALONE = 10.0  # times the largest speed at which summits touch: the right end


@dataclass(frozen=True)
class StribeckCurve:
    """Numbers (n,) over the speed: speed in Hz, rising; friction_coefficient: |T| / (R F) of the torque on the journal;
    asperity_share: of the load that the summits carry."""

    speed: Array
    friction_coefficient: Array
    asperity_share: Array

    @property
    def least(self) -> tuple[float, float]:
        """The least coefficient of friction, and its speed in Hz."""
        k = int(np.argmin(self.friction_coefficient))
        return float(self.friction_coefficient[k]), float(self.speed[k])


class _Point(NamedTuple):
    speed: float
    friction: float
    share: float


def stribeck_curve(case: Case, plan: KinematicPlan) -> StribeckCurve | None:
    """The curve of a planned rotation; None without a load, a speed, rough surfaces or a known torque.

    Finite-volume films have COARSE_CELLS. It ends where a journal has no static equilibrium. Raises NotConverged if it
    has none at the speed of the test.
    """
    motion = case.motion
    if motion is None or motion.load is None or not motion.speed or not case.contact.rough or not plan.form.solved:
        return None
    fast = replace(plan, cells=COARSE_CELLS) if plan.on_cells else plan
    point = partial(_point, case, fast, motion.load)
    down = _walk(point, [point(motion.speed)], 1.0 / RATIO, lambda points: points[-1].share > BOUNDARY)
    whole = _walk(point, down[::-1], RATIO, _film_alone)
    speed, friction, share = np.array(whole).T
    return StribeckCurve(np.abs(speed), friction, share)


def _film_alone(points: Sequence[_Point]) -> bool:
    """Whether the last speed is far above the speeds at which summits touch."""
    touching = [abs(each.speed) for each in points if each.share > 0.0] or [abs(points[0].speed)]
    return abs(points[-1].speed) > FILM_ALONE * max(touching)


def _walk(
    point: Callable[[float], _Point], begun: list[_Point], ratio: float, ends: Callable[[Sequence[_Point]], bool]
) -> list[_Point]:
    """Given points and further ones, at speeds that grow by a ratio, up to one that ends them."""
    points = list(begun)
    while len(points) < len(begun) + MOST and not ends(points):
        try:
            points.append(point(points[-1].speed * ratio))
        except NotConverged:
            break
    return points


def _point(case: Case, plan: KinematicPlan, load: float, speed: float) -> _Point:
    """The film under a load in N at a speed in Hz. Raises NotConverged."""
    film, omega, section = tested_film(plan), 2.0 * math.pi * speed, plan.section
    place = film.rest(case, plan, load, omega)
    x, y = place.tolist()
    torque = film.moment(case, plan, Motion((x, y), (0.0, 0.0), omega)).loads.torque.journal
    own = rubbing_of(case).force(section.clearance * place, np.zeros(2), omega).force
    return _Point(speed, friction_coefficient(torque, load, section.radius), 0.0 + float(own[1]) / load)
