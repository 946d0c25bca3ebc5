"""Bearings and films for the film tests: table 4.1 (B 20 mm, D 25 mm, C 40 um, 10 mPa s) and what departs from it.

Plain solutions of what kernels compute, to which tests hold them."""

import functools
import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import quad
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementQuad2, LinearForm, MeshQuad, asm

from frbcli.arrays import Array
from frbcli.film.gap import AxialGroove, Section, whole_width
from frbcli.film.grid import Mesh
from frbcli.film.kinds.contract import TableFilms
from frbcli.film.rectangles.film import evaluate, make_film
from frbcli.film.rectangles.film_force import FilmData
from frbcli.film.roughness.asperities import LAST, Asperities, reach
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


@dataclass(frozen=True)
class PlainFilm:
    """Pressure at the nodes of the mesh. phi, z: (n,) coordinates of the n nodes; pressure: (n,) scaled, gauge."""

    phi: Array
    z: Array
    pressure: Array


def solve_plain(
    phi_vertices: Array,
    z_vertices: Array,
    radius_to_width: float,
    displacement: tuple[float, float],
    squeeze: tuple[float, float],
    edge_pressure: tuple[float, float] = (0.0, 0.0),
) -> PlainFilm:
    """Sommerfeld's pressure (3.9) of one film section on quadratic quadrilaterals of scikit-fem, periodic in phi.

    phi_vertices: (m,) element boundaries of one turn, in [0, 2 pi); z_vertices: (k,) from 0 to 1;
    displacement: d = D/C; squeeze: w = d' - (omega/2) J d in 1/s; edge_pressure: scaled gauge pressure at z = 0 and 1.
    """
    turn = np.append(phi_vertices, phi_vertices[0] + 2 * np.pi)
    basis = Basis(MeshQuad.init_tensor(turn, z_vertices), ElementQuad2(), intorder=5)
    d, w, aspect = displacement, squeeze, radius_to_width**2

    @BilinearForm
    def diffusion(p, q, s):
        gap = 1 + d[0] * np.sin(s.x[0]) - d[1] * np.cos(s.x[0])  # (4.4)
        return gap**3 * (p.grad[0] * q.grad[0] + aspect * p.grad[1] * q.grad[1])

    @LinearForm
    def motion(q, s):
        return -(w[0] * np.sin(s.x[0]) - w[1] * np.cos(s.x[0])) * q  # (4.5)

    phi, z = basis.doflocs
    # The seam: every node at the end of the turn is the node at its beginning.
    seam = np.isclose(phi, turn[-1])
    master = np.arange(len(phi))
    start = np.flatnonzero(np.isclose(phi, turn[0]))
    master[seam] = start[np.argmin(np.abs(z[seam][:, None] - z[start][None, :]), axis=1)]
    kept, column = np.unique(master, return_inverse=True)
    join = csr_matrix((np.ones(len(phi)), (np.arange(len(phi)), column)))
    matrix = (join.T @ asm(diffusion, basis) @ join).tocsr()
    load = join.T @ asm(motion, basis)

    pressure = np.where(np.isclose(z[kept], 1.0), edge_pressure[1], edge_pressure[0])
    inner = np.flatnonzero((z[kept] > 1e-12) & (z[kept] < 1 - 1e-12))
    fixed = pressure.copy()
    fixed[inner] = 0.0
    pressure[inner] = spsolve(matrix[inner][:, inner].tocsc(), (load - matrix @ fixed)[inner])
    return PlainFilm(phi[kept], z[kept], pressure)


def short_pressure(theta, z, eccentricity, w_r, w_t, slenderness, sigma):
    """Sommerfeld's pressure (B.3) on the grid theta (n,) x z (m,), scaled, gauge."""
    theta, z = np.asarray(theta)[:, None], np.asarray(z)[None, :]
    gap = 1.0 + eccentricity * np.cos(theta)
    rhs = w_r * np.cos(theta) + w_t * np.sin(theta)
    return -slenderness * rhs / (2.0 * gap**3) * z * (1.0 - z) + sigma * z


def summit_integral(n: float, x: float) -> float:
    """F_n(x) of the summits of a rough surface as the integral that defines it."""

    def density(u: float) -> float:
        return float(u**n * math.exp(-u * x - 0.5 * u * u) if x > 0.0 else u**n * math.exp(-0.5 * (u + x) ** 2))

    middle = max(-x, 1.0)
    whole = sum(quad(density, *ends, epsabs=0.0, epsrel=1e-12)[0] for ends in ((0.0, middle), (middle, middle + 12.0)))
    return float(whole / math.sqrt(2.0 * math.pi) * (math.exp(-0.5 * x * x) if x > 0.0 else 1.0))


def plain_pressure(asperities: Asperities, gap: float) -> float:
    """Pressure in Pa of the summits over a gap in m."""
    x = (gap - asperities.mean_height) / asperities.roughness
    if x >= LAST:
        return 0.0
    elastic = asperities.elastic * summit_integral(2.5, x)
    return min(elastic, asperities.plastic * summit_integral(2.0, x)) if math.isfinite(asperities.plastic) else elastic


def plain_touch(asperities: Asperities, f: int, clearance: float, eccentricity: float) -> tuple[float, float]:
    """Integrals in N of the pressure over a bearing, and of its part along the line of centres."""
    area = 2.0 * asperities.radii[f] * asperities.widths[f]
    arc = math.acos(max(-1.0, min(1.0, (clearance - reach(asperities)) / eccentricity)))

    def along(power: int) -> float:
        def density(theta: float) -> float:
            return plain_pressure(asperities, clearance - eccentricity * math.cos(theta)) * math.cos(theta) ** power

        return float(area * quad(density, 0.0, arc, epsabs=0.0, epsrel=1e-9, limit=200)[0])

    return along(0), along(1)
