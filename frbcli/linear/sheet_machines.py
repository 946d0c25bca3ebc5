"""The machines whose films a bearing's sheet tells: of a rotor, or of one film under a load; with heat, warm.

Films are on finite volumes, finer than those of a run, and once more on half the cells, for the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.cells.data import volume_films
from frbcli.linear.heat import Machine, machine_finder
from frbcli.linear.resting import resting_position
from frbcli.rotor.linear import LinearRotor
from frbcli.scene.film_choice import CELLS as ON_CELLS
from frbcli.scene.films import FilmPlace, film_places, turning, volume_film
from frbcli.scene.plan import make_plan
from frbcli.scene.system import System, film_drag, make_system
from frbcli.scene.warm import warm_case

Array = NDArray[np.float64]

CELLS = (144, 20)  # around and along a section, equal: 0.1 % of the force up to an eccentricity of 0.9


@dataclass(frozen=True)
class MachineAt:
    """The machine at one speed, on fine and coarse cells, at rest in the displacements `resting` (n,) in m.

    temperatures: (films,) K, NaN without heat; warm: the machine on the films of a run whose heat balances."""

    fine: System
    coarse: System
    resting: Array
    temperatures: tuple[float, ...]
    warm: Machine | None = None


def machines(case: Case, load: float | None, top_Hz: float) -> Callable[[float, MachineAt | None], MachineAt]:
    """A function that finds the machine at omega rad/s from one near it; it raises NotConverged."""
    if case.heat is None:
        fine, coarse = systems(case, load, top_Hz)
        unknown = (math.nan,) * len(fine.names)
        return lambda omega, near: MachineAt(
            fine, coarse, resting_position(fine, omega, None if near is None else near.resting), unknown
        )
    plan = make_plan(case)
    find = machine_finder(case, plan, make_system(case, plan))

    def warm(omega: float, near: MachineAt | None) -> MachineAt:
        machine = find(omega, None if near is None else near.warm)
        assert machine.warm is not None
        films = machine.warm.films
        viscosities, clearances = (np.array([getattr(film, n) for film in films]) for n in ("viscosity", "clearance"))
        fine, coarse = systems(warm_case(case, viscosities, clearances), load, top_Hz)
        resting = resting_position(fine, omega, machine.resting)
        return MachineAt(fine, coarse, resting, tuple(film.temperature for film in films), machine)

    return warm


def systems(case: Case, load: float | None, top_Hz: float) -> tuple[System, System]:
    """The machine on CELLS and on half of them, for the error. top_Hz: largest rotor speed."""
    return _system(case, CELLS, load, top_Hz), _system(case, (CELLS[0] // 2, CELLS[1] // 2), load, top_Hz)


def _system(case: Case, cells: tuple[int, int], load: float | None, top_Hz: float) -> System:
    """load: of a single film in N; None for the rotor's, or that of [motion]."""
    alone = len(film_places(case)) == 1
    if case.given_rotor is not None and (load is None or not alone):
        return make_system(case, replace(make_plan(case), cells=cells, form=ON_CELLS))
    if load is None and case.motion is not None:
        load = case.motion.load
    if load is None:
        remedy = "Give --load, or --over eccentricity, or add [rotor]."
        raise InputError(case.name or "case", (Fault("motion.load", "", None, "is missing.", remedy),))
    return _single(case, film_places(case)[0], cells, load, top_Hz)


def _single(case: Case, place: FilmPlace, cells: tuple[int, int], load: float, top_Hz: float) -> System:
    """One film under a load along -y in N, without a rotor."""
    film = volume_film(case, place, cells, top_Hz)
    rotor = LinearRotor(
        mass=np.eye(2),
        damping=np.zeros((2, 2)),
        gyroscopic=np.zeros((2, 2)),
        stiffness=np.zeros((2, 2)),
        static_load=np.array([0.0, -load]),
        unbalance_cos=np.zeros(2),
        unbalance_sin=np.zeros(2),
        journals=np.eye(2)[None],
        multiplicity=np.ones(1),
        points=(),
    )
    return System(
        rotor=rotor,
        films=volume_films([film]),
        names=(place.name,),
        clearances=(place.geometry.clearance,),
        bodies=np.array([[place.inside, place.outside]], dtype=np.int64),
        turning=turning((place,), 0, [False]),
        drags=(film_drag(case, place.geometry),),
        volumes=(film,),
        laws=case.cavitations,
        torque=case.film.torque,
    )
