"""Bearings and films for the film tests: table 4.1 (B 20 mm, D 25 mm, C 40 um, 10 mPa s) and what departs from it."""

import functools
import math
from dataclasses import replace

import numpy as np

from frbcli.film.gap import AxialGroove, Section, whole_width
from frbcli.film.grid import Mesh
from frbcli.film.kinds.contract import TableFilms
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.film.rectangles.film_force import FilmData
from frbcli.rotor.assembly import LinearRotor
from frbcli.scene.films import HOUSING, ROTOR
from frbcli.scene.machine.system import System
from frbcli.scene.planning.film_choice import DEFAULT_MESH

CLEARANCE, RADIUS, VISCOSITY, AMBIENT = 40e-6, 12.5e-3, 10e-3, 1e5
# Settings of a case with rough surfaces
ROUGH = (
    "contact.model=asperities",
    "contact.roughness=0.4 um",
    "contact.summit_radius=20 um",
    "contact.summit_density=5e9 1/m^2",
    "contact.friction=0.12",
)


def rectangular(
    width: float, diameter: float, clearance: float, viscosity: float, ambient_pressure: float,
    cavitation_pressure: float, *, groove: int = 0, far_pressure: float = 0.0, grooves: tuple[AxialGroove, ...] = (),
) -> Section:  # fmt: skip
    """The section of a bearing over its whole width in an oil bath, or between its end and a circumferential groove,
    on `groove` sides of which a section lies."""
    copies, far = (groove, "groove") if groove else (1, "oil-bath")
    return whole_width(Section(
        0.5 * diameter, width / copies, width, clearance, viscosity, ambient_pressure, cavitation_pressure, copies,
        "oil-bath", far, far_pressure, grooves,
    ))  # fmt: skip


GROOVED = rectangular(20e-3, 2 * RADIUS, CLEARANCE, VISCOSITY, AMBIENT, AMBIENT, groove=2)
PLAIN = rectangular(20e-3, 2 * RADIUS, CLEARANCE, VISCOSITY, AMBIENT, AMBIENT)
SUPPLIED = replace(GROOVED, far_pressure=1e5)

# Every kind of film: name -> bearing, theory, cavitation
KINDS = {
    "short": (GROOVED, "short", "half-sommerfeld"),
    "short, Sommerfeld": (GROOVED, "short", "sommerfeld"),
    "short, 2 bar": (SUPPLIED, "short", "half-sommerfeld"),
    "finite": (GROOVED, "finite", "half-sommerfeld"),
    "finite, Sommerfeld": (GROOVED, "finite", "sommerfeld"),
    "finite, 2 bar": (SUPPLIED, "finite", "half-sommerfeld"),
}
EQUAL_PRESSURES = [name for name in KINDS if "2 bar" not in name]


@functools.cache
def film_of(bearing: Section, theory: str, cavitation: str, mesh: Mesh = DEFAULT_MESH) -> FilmData:
    """The film, made once per test process."""
    return make_film(bearing, theory, cavitation, mesh)


def force(kind: str, d: np.ndarray, v: np.ndarray, omega: float) -> np.ndarray:
    """(2,) force in N of a film in KINDS; d over the clearance, v in clearances per second."""
    bearing = KINDS[kind][0]
    return evaluate(film_of(*KINDS[kind]), bearing.clearance, d * bearing.clearance, v * bearing.clearance, omega).force


def polar(radius: float, angle: float) -> np.ndarray:
    """(2,) vector of a length and an angle in rad from the x-axis."""
    return radius * np.array([math.cos(angle), math.sin(angle)])


def sommerfeld_number(bearing: Section, force_N: float, omega: float) -> float:
    """So = psi^2 F / (D B eta omega), (3.14)."""
    psi = bearing.clearance / bearing.radius
    return psi**2 * force_N / (2.0 * bearing.radius * bearing.bearing_width * bearing.viscosity * omega)


def system_of(rotor: LinearRotor, bearings: tuple[Section, ...], films: tuple[FilmData, ...]) -> System:
    """A rotor on single films in shells at rest."""
    count = len(films)
    return System(
        rotor=rotor,
        films=TableFilms(tuple(bearing.clearance for bearing in bearings), films, bearings),
        names=tuple(str(i) for i in range(count)),
        bodies=np.tile([[ROTOR, HOUSING]], (count, 1)),
        turning=np.tile([[[1.0], [1.0], [0.0]]], (count, 1, 1)),
        drags=(0.0,) * count,
    )
