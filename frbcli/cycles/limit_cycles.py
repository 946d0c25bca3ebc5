"""Limit cycles of a case over its speed: resting positions, Hopf points, and the branches of cycles from them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

import numpy as np

from frbcli.case.bearing import Bores
from frbcli.case.schema import Case
from frbcli.cycles.balance import loads_along, unpacked
from frbcli.cycles.branch import FLIP, FOLD, HOPF, TORUS, Branch, Cycle, first_place, follow_branch
from frbcli.cycles.continuation import Place, Unreachable, oriented
from frbcli.cycles.criticality import lyapunov_coefficient
from frbcli.cycles.equilibria import Equilibrium, HopfPoint, resting_curve
from frbcli.cycles.faults import check
from frbcli.cycles.machine import Machine, make_machine
from frbcli.cycles.result import (
    SUBCRITICAL,
    SUPERCRITICAL,
    Cost,
    CycleBranch,
    CyclePoint,
    LimitCycles,
    RestingPoint,
    SpecialPoint,
)
from frbcli.cycles.seed import seed_cycle
from frbcli.errors import NotConverged
from frbcli.scene.films import film_places
from frbcli.scene.plan import make_plan
from frbcli.scene.remedies import advised
from frbcli.scene.system import make_system

Observer = Callable[[int, float, float], None]

SAME = 0.02  # relative: a branch that ends at rest at this distance from a Hopf point ends in it


def limit_cycles(case: Case, speeds_Hz: Sequence[float] = (), observe: Observer | None = None) -> LimitCycles:
    """The resting positions of a case over its speed range, its Hopf points, and the branches of limit cycles.

    speeds_Hz: at which cycles are computed exactly, of the kind "asked", for their orbits;
    observe: called with the number of cycles so far and the speed in Hz and the largest eccentricity of the latest one.
    Raises InputError if the films have no force that follows from the motion alone, or without a speed range;
    NotConverged without a resting position at the highest speed.
    """
    begun = time.process_time()
    slowest, fastest = check(case)
    system = make_system(case, make_plan(case))
    machine = make_machine(system, fastest)
    try:
        with advised(case):
            resting = resting_curve(system, machine, slowest, fastest)
    except Unreachable:
        raise NotConverged(
            f"The resting positions could not be followed down from {fastest / (2.0 * math.pi):.4g} Hz."
        ) from None
    branches: list[Branch | None] = []
    asked = [2.0 * math.pi * speed for speed in speeds_Hz]
    cycles = 0

    def tell(cycle: Cycle) -> None:
        nonlocal cycles
        cycles += 1
        if observe is not None:
            observe(cycles, _hertz(cycle.y[-1] * machine.pace), float(cycle.eccentricity_max.max()))

    for number, hopf in enumerate(resting.hopf):
        known = any(branch is not None and _ends_in(machine, branch, hopf) for branch in branches[:number])
        branches.append(
            None if known else follow_branch(machine, first_place(machine, hopf), slowest, fastest, asked, tell)
        )
    followed: list[tuple[int | None, Branch]] = [(i, branch) for i, branch in enumerate(branches) if branch is not None]
    numbers = {hopf: number for number, (hopf, _) in enumerate(followed)}
    notes = [resting.note]
    if any(isinstance(place.geometry.supply, Bores) for place in film_places(case)):
        notes.append("Bores that turn enter by their mean over the angle.")
    if not resting.hopf and not any(point.stable for point in resting.points):
        seeded = _seeded(
            machine, resting.points, lambda place: follow_branch(machine, place, slowest, fastest, asked, tell)
        )
        notes.append(_unstable(resting.points))
        if seeded is not None:
            followed.append((None, seeded))
    elif not resting.hopf:
        notes.append(_verdict(resting.points))
    special = [_hopf(machine, hopf, numbers.get(i)) for i, hopf in enumerate(resting.hopf)]
    for number, (_, branch) in enumerate(followed):
        special += [_special(machine, cycle, number) for cycle in branch.cycles if cycle.kind in (FOLD, FLIP, TORUS)]
    return LimitCycles(
        case=case,
        films=system.names,
        equilibria=tuple(_resting(machine, point) for point in resting.points),
        branches=tuple(
            CycleBranch(hopf, tuple(_cycle(machine, cycle) for cycle in branch.cycles), branch.note)
            for hopf, branch in followed
        ),
        special=tuple(special),
        notes=tuple(filter(None, notes)),
        cost=Cost(time.process_time() - begun, cycles),
    )


def _seeded(machine: Machine, points: tuple[Equilibrium, ...], both_ways: Callable[[Place], Branch]) -> Branch | None:
    """The branch through a cycle that no Hopf point in the range leads to, from its slow to its fast end."""
    for resting in (points[len(points) // 2], points[0], points[-1]):
        place = seed_cycle(machine, resting)
        if place is not None:
            break
    else:
        return None
    up, down = both_ways(place), both_ways(oriented(place, -place.tangent))
    notes = dict.fromkeys((down.note, up.note))
    return Branch((*reversed(down.cycles), *up.cycles), " ".join(notes), down.ends_at_rest or up.ends_at_rest)


def _unstable(points: tuple[Equilibrium, ...]) -> str:
    """What is to be said where the rotor whirls at all speeds."""
    low, high = _hertz(points[0].omega), _hertz(points[-1].omega)
    return f"Unstable at rest from {low:.4g} to {high:.4g} Hz: the whirl is born outside of the range."


def _verdict(points: tuple[Equilibrium, ...]) -> str:
    """What is to be said where no whirl is born."""
    low, high = _hertz(points[0].omega), _hertz(points[-1].omega)
    if all(point.stable for point in points):
        return f"No whirl is born between {low:.4g} and {high:.4g} Hz: every small motion decays there."
    return f"No whirl is born between {low:.4g} and {high:.4g} Hz."


def _ends_in(machine: Machine, branch: Branch, hopf: HopfPoint) -> bool:
    """Whether a branch comes back to rest in a Hopf point."""
    if not branch.ends_at_rest or not branch.cycles:
        return False
    last = branch.cycles[-1].y[-1] * machine.pace
    return bool(abs(last - hopf.equilibrium.omega) < SAME * hopf.equilibrium.omega)


def _resting(machine: Machine, point: Equilibrium) -> RestingPoint:
    films = 2 * machine.film_count
    rings = _hertz(machine.pace) * point.u[films:]
    return RestingPoint(_hertz(point.omega), point.u[:films].reshape(-1, 2), rings, point.eigenvalues, point.stable)


def _cycle(machine: Machine, cycle: Cycle) -> CyclePoint:
    films = 2 * machine.film_count
    motion, nu, omega = unpacked(cycle.y[:-2], machine.size), cycle.y[-2] * machine.pace, cycle.y[-1] * machine.pace
    loads, _ = loads_along(machine, motion, float(nu), float(omega))
    return CyclePoint(
        speed_Hz=_hertz(omega),
        frequency_Hz=_hertz(nu),
        eccentricity_max=cycle.eccentricity_max,
        ring_speeds_Hz=_hertz(machine.pace) * motion[0, films:].real,
        torque_N_m=float(loads.drive.mean()),
        stable=cycle.multipliers.stable,
        multipliers=cycle.multipliers.values,
        harmonics=motion[:, :films].reshape(len(motion), -1, 2),
        kind=cycle.kind,
    )


def _hopf(machine: Machine, hopf: HopfPoint, branch: int | None) -> SpecialPoint:
    d = hopf.equilibrium.u[: 2 * machine.film_count].reshape(-1, 2)
    coefficient = lyapunov_coefficient(machine, hopf).real
    return SpecialPoint(
        kind=HOPF,
        branch=branch,
        speed_Hz=_hertz(hopf.equilibrium.omega),
        frequency_Hz=_hertz(hopf.nu),
        eccentricity_max=np.hypot(d[:, 0], d[:, 1]),
        criticality=SUBCRITICAL if coefficient > 0.0 else SUPERCRITICAL,
        lyapunov=coefficient,
    )


def _special(machine: Machine, cycle: Cycle, branch: int) -> SpecialPoint:
    speed, frequency = _hertz(cycle.y[-1] * machine.pace), _hertz(cycle.y[-2] * machine.pace)
    return SpecialPoint(cycle.kind, branch, speed, frequency, cycle.eccentricity_max)


def _hertz(omega: float) -> float:
    return float(omega) / (2.0 * math.pi)
