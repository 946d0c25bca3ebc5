"""A planned case as a rotor, its speed and its films: what every study starts from."""

from __future__ import annotations

import math
from dataclasses import dataclass

from frbcli.case.bearing import AxialGrooves, SingleFilmBearing
from frbcli.case.rotor import JeffcottRotor, RigidRotor
from frbcli.case.schema import Case
from frbcli.film.bearing import RectangularBearing, make_film
from frbcli.film.gap import AxialGroove
from frbcli.film.kernel import FilmData
from frbcli.film.table import Mesh
from frbcli.rotor.excitation import SpeedProfile, speed_profile
from frbcli.rotor.jeffcott import jeffcott_rotor
from frbcli.rotor.linear import LinearRotor
from frbcli.rotor.rigid import rigid_rotor
from frbcli.scene.plan import Plan


@dataclass(frozen=True)
class System:
    """rotor: the linear system; bearings: their dimensions and oil; films: ready to be evaluated, one per bearing."""

    rotor: LinearRotor
    bearings: tuple[RectangularBearing, ...]
    films: tuple[FilmData, ...]

    @property
    def clearances(self) -> tuple[float, ...]:
        """Clearance of each film, m."""
        return tuple(bearing.clearance for bearing in self.bearings)


def make_system(case: Case, plan: Plan) -> System:
    """The system of a case; its films are tabulated here."""
    single = [bearing for bearing in case.bearings if isinstance(bearing, SingleFilmBearing)]
    bearings = tuple(_bearing(case, bearing, plan) for bearing in single)
    return System(make_rotor(case), bearings, tuple(planned_film(plan, bearing, plan.mesh) for bearing in bearings))


def planned_film(plan: Plan, bearing: RectangularBearing, mesh: Mesh) -> FilmData:
    """The film that the plan has chosen for a bearing, on a mesh of its own."""
    return make_film(bearing, plan.theory, plan.cavitation, mesh)


def make_rotor(case: Case) -> LinearRotor:
    """The linear system of a case's rotor."""
    rotor = case.rotor
    if isinstance(rotor, RigidRotor):
        return rigid_rotor(rotor.mass, rotor.unbalance, rotor.external_damping, rotor.gravity)
    assert isinstance(rotor, JeffcottRotor)
    return jeffcott_rotor(
        rotor.mass,
        rotor.journal_mass,
        rotor.shaft_stiffness,
        rotor.unbalance,
        rotor.external_damping,
        rotor.shaft_damping,
        rotor.gravity,
    )


def run_up_profile(case: Case) -> SpeedProfile:
    """From the first to the last speed of the case."""
    speed = case.speed
    return speed_profile([0.0, speed.duration], [2 * math.pi * speed.start, 2 * math.pi * speed.end])


def run_down_profile(case: Case) -> SpeedProfile:
    """Up, hold, and back down (section 7.2.2)."""
    speed = case.speed
    times, speeds = [0.0, speed.duration], [speed.start, speed.end]
    if speed.hold > 0.0:
        times.append(times[-1] + speed.hold)
        speeds.append(speed.end)
    times.append(times[-1] + speed.down_duration)
    speeds.append(speed.start)
    return speed_profile(times, [2 * math.pi * value for value in speeds])


def _bearing(case: Case, bearing: SingleFilmBearing, plan: Plan) -> RectangularBearing:
    supply = bearing.supply
    grooves: tuple[AxialGroove, ...] = ()
    if isinstance(supply, AxialGrooves):
        gauge = supply.pressure - case.oil.ambient_pressure
        turn = 2 * math.pi / supply.count
        grooves = tuple(
            AxialGroove(supply.position + turn * i, supply.opening_angle, gauge) for i in range(supply.count)
        )
    return RectangularBearing(
        width=bearing.width,
        diameter=bearing.diameter,
        clearance=bearing.clearance,
        viscosity=case.viscosity(bearing),
        sections=plan.sections,
        ambient_pressure=case.oil.ambient_pressure,
        cavitation_pressure=case.oil.cavitation_pressure,
        supply_pressure=None if isinstance(supply, AxialGrooves) else getattr(supply, "pressure", None),
        grooves=grooves,
    )
