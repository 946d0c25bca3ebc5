"""The machine at other viscosities and clearances than those of its case, without new tables.

The pressure of a film is homogeneous in the velocity w and in the pressures that are given: with s times the scale
12 eta / psi^2 it is that of the velocity s w. So a table serves for every uniform viscosity and every clearance.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.model import altered
from frbcli.case.schema import Case
from frbcli.scene.films import film_places
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.planned import Plan


def warm_system(case: Case, plan: Plan, system: System, viscosities: Array, clearances: Array) -> System:
    """The system of a case with viscosities in Pa s and clearances in m, (films,) each."""
    places = [place.geometry for place in film_places(case)]
    thicker = viscosities / [case.viscosity(film) for film in places]
    wider = clearances / system.clearances
    films = system.films.scaled(thicker / wider**2, clearances)
    if films is None:
        return make_system(warm_case(case, viscosities, clearances), plan, system.rotor)
    return replace(system, films=films, drags=tuple((np.array(system.drags) * thicker / wider).tolist()))


def warm_case(case: Case, viscosities: Array, clearances: Array) -> Case:
    """The case without heat, its films with these viscosities in Pa s and clearances in m, (films,) each."""
    values = (
        {"viscosity": float(eta), "given_clearance": float(c)} for eta, c in zip(viscosities, clearances, strict=True)
    )
    films = [altered(film, value) for film, value in zip(case.films, values, strict=True)]
    return altered(case.with_films(films), {"thermal": None})
