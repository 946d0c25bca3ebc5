"""Heat of the machine, and whether it is warm.

The heat of a machine: its nodes, conductances and clearances as arrays, made of a case (docs/heat.md).

The machine at viscosities and clearances that differ from its case, without new tables.

The pressure of a film is homogeneous in the velocity w and in the pressures that are given: with s times the scale 12
eta / psi^2 it equals the pressure of the velocity s w. So a table serves for every uniform viscosity and every
clearance. """

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from frbcli.arrays import Array
from frbcli.case.bearing import FilmBearing, FloatingRingBearing, SingleFilmBearing
from frbcli.case.film import ColdClearance, FilmGeometry
from frbcli.case.model import altered
from frbcli.case.oil import QUASI_STEADY, Thermal, WallNode
from frbcli.case.over_time import OverTime, largest
from frbcli.case.schema import Case
from frbcli.case.surroundings import Damper
from frbcli.elements.supports import DamperElement
from frbcli.film.gap import ring_rotation_strains, shaft_rotation_strain
from frbcli.materials import SOLIDS
from frbcli.scene.films import coupled, film_places, opens_to_groove, turning_rings
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.film_choice import Plan
from frbcli.thermal.model import FROM_SUPPLY, OIL_AT, HeatModel


@dataclass(frozen=True)
class RingNodes:
    """The nodes of a ring: name of its bearing; numbers of its inner and outer node; of its body as it turns, -1 if it
    is blocked."""

    name: str
    inner: int
    outer: int
    turning: int


@dataclass(frozen=True)
class Heat:
    """The model of a machine. nodes: names of all nodes, films first; rings; start (n,) K; concentric (F,): Q eta / C^3
    of the formula of a concentric film, m Pa s / s, by which oil leaves the films if by_formula; supplies (F,):
    temperatures of the oil that films are supplied with, and walls: nodes of given temperature with it, in K or over
    time."""

    model: HeatModel
    nodes: tuple[str, ...]
    rings: tuple[RingNodes, ...]
    start: Array
    concentric: Array
    by_formula: bool
    supplies: tuple[float | OverTime, ...]
    walls: tuple[tuple[int, float | OverTime], ...]

    def side_flow(self, own: Array, viscosities: Array, clearances: Array) -> Array:
        """(F,) m^3/s that leave the films: their own flow, or that of concentric films of these viscosities in Pa s
        and clearances in m."""
        return np.asarray(self.concentric * clearances**3 / viscosities) if self.by_formula else own


def heat_of(case: Case, value: Callable[[float | OverTime], float] = largest) -> Heat:
    """The heat of a case with [thermal]. value: of temperatures that change over time, the largest or the first one."""
    assert case.heat is not None
    return _Builder(case, case.heat, value).heat()


class _Builder:
    """Collects nodes and links, bearing by bearing."""

    def __init__(self, case: Case, thermal: Thermal, value: Callable[[float | OverTime], float]) -> None:
        self._case, self._thermal, self._places, self._value = case, thermal, film_places(case), value
        self._names = [place.name or "film" for place in self._places]
        oil, films = case.oil, len(self._places)
        first, last = (case.oil.density * oil.heat_capacity_at(t) for t in OIL_AT)
        slope = (last - first) / (OIL_AT[1] - OIL_AT[0])
        self._oil_heat = np.array([first - slope * OIL_AT[0], slope])
        initial = thermal.start_temperature or value(thermal.supply_temperature)
        self._initial = initial
        self._start = [initial] * films
        at_start = float(self._oil_heat[0] + self._oil_heat[1] * initial)
        gaps = (place.geometry for place in self._places)
        self._capacity = [at_start * (math.pi * gap.diameter * gap.width * gap.clearance) for gap in gaps]
        self._links: list[tuple[int, int, float, int]] = []
        self._rings: list[RingNodes] = []
        self._walls: list[tuple[int, float | OverTime]] = []
        self._expansions: list[tuple[int, int, float]] = []  # film, node, m/K
        self._base = np.array([place.geometry.clearance for place in self._places])
        self._growth = np.zeros((films, 1 + len(turning_rings(case))))
        dampers = tuple(DamperElement.of(case))
        self._dampers = {each.bearing: films - len(dampers) + i for i, each in enumerate(dampers)}  # their films

    def heat(self) -> Heat:
        film = 0
        for bearing in self._case.bearings:
            if bearing.kind == "single-film":
                self._single(bearing, film)
                film += 1
            else:
                self._floating(bearing, film)
                film += 2
        for name, damper in self._dampers.items():
            if all(bearing.name != name for bearing in self._case.bearings):  # around given coefficients
                self._shell(name, damper, self._thermal.housing)
        count = len(self._capacity)
        expansion = np.zeros((len(self._places), count))
        for f, node, rate in self._expansions:
            expansion[f, node] += rate
        thermal, law = self._thermal, self._case.oil.law
        assert law is not None  # the checks of a case see to it
        own = {bearing.name: bearing.supply_temperature for bearing in self._case.bearings}
        feeding = [*self._bearings(), *self._dampers]
        supplies = tuple(own.get(name) or thermal.supply_temperature for name in feeding)
        model = HeatModel(
            capacity=np.array(self._capacity),
            links=np.array([link[:2] for link in self._links], dtype=np.int64).reshape(-1, 2),
            conductance=np.array([link[2] for link in self._links]),
            of_film=np.array([link[3] for link in self._links], dtype=np.int64),
            supply=np.array([self._value(given) for given in supplies]),
            inlet=np.array(self._inlets(), dtype=np.int64),
            mixing=thermal.mixing,
            oil_heat=self._oil_heat,
            viscosity=np.array([law.eta_0, law.a, law.c]),
            clearance=self._base,
            reference=np.array([place.geometry.clearance for place in self._places]),
            expansion=expansion,
            growth=self._growth,
            hottest=thermal.hottest_film,
            balanced=thermal.films == QUASI_STEADY,
        )
        concentric = np.array([_concentric(self._case, place.geometry) for place in self._places])
        nodes, rings, walls = tuple(self._names), tuple(self._rings), tuple(self._walls)
        by_formula = thermal.side_flow == "concentric"
        return Heat(model, nodes, rings, np.array(self._start), concentric, by_formula, supplies, walls)

    def _bearings(self) -> list[str]:
        """The name of the bearing of each film between turning surfaces."""
        return [bearing.name for bearing in self._case.bearings for _ in bearing.films]

    def _inlets(self) -> list[int]:
        """The film that feeds each film: an outer film that coupled channels join to the inner one, unless they open to
        its groove, whose oil comes from the supply."""
        inlets: list[int] = []
        for bearing in self._case.bearings:
            if bearing.kind == "floating-ring":
                through = coupled(bearing) and not opens_to_groove(bearing)
                inlets += [len(inlets) + 1 if through else FROM_SUPPLY, FROM_SUPPLY]
            else:
                inlets.append(FROM_SUPPLY)
        return inlets + [FROM_SUPPLY] * len(self._dampers)

    def _single(self, bearing: SingleFilmBearing, film: int) -> None:
        shaft = self._wall(film, bearing.shaft or self._thermal.shaft, f"{bearing.name} shaft".lstrip())
        housing = self._housing(film, bearing)
        self._follow(film, bearing, (shaft,), (housing,), self._shaft_expansion, self._housing_expansion)
        self._grow_shaft(film, bearing)

    def _floating(self, bearing: FloatingRingBearing, film: int) -> None:
        ring, inner, outer = bearing.ring, bearing.inner, bearing.outer
        solid, half = ring.solid, 0.5 * bearing.ring_mass * ring.solid.heat_capacity
        inside, outside = (self._node(f"{bearing.name} ring {side}".lstrip(), half) for side in ("inner", "outer"))
        resistance = math.log(outer.diameter / inner.diameter) / (2.0 * math.pi * solid.conductivity * inner.width)
        self._links.append((inside, outside, 1.0 / resistance, -1))
        self._to_film(film, inside)
        self._to_film(film + 1, outside)
        turning = self._places[film + 1].inside
        self._rings.append(RingNodes(bearing.name, inside, outside, turning))
        shaft = self._wall(film, bearing.shaft or self._thermal.shaft, f"{bearing.name} shaft".lstrip())
        housing = self._housing(film + 1, bearing)
        both = (inside, outside)
        self._follow(film, inner, (shaft,), both, self._shaft_expansion, solid.expansion)
        self._follow(film + 1, outer, both, (housing,), solid.expansion, self._housing_expansion)
        self._grow_shaft(film, inner)
        if self._thermal.centrifugal_growth == "follows" and turning >= 0:
            radii = 0.5 * inner.diameter, 0.5 * outer.diameter
            strains = ring_rotation_strains(solid, 1.0, *radii)
            self._growth[film, 1 + turning] += radii[0] * strains[0]
            self._growth[film + 1, 1 + turning] -= radii[1] * strains[1]

    def _housing(self, film: int, bearing: FilmBearing) -> int:
        """The node outside of the last film of a bearing: its housing, or its shell in a damper."""
        wall = bearing.housing or self._thermal.housing
        if bearing.name not in self._dampers:
            return self._wall(film, wall, f"{bearing.name} housing".lstrip())
        shell = self._shell(bearing.name, self._dampers[bearing.name], wall)
        self._to_film(film, shell)
        return shell

    def _shell(self, name: str, damper: int, wall: str | float | OverTime | WallNode) -> int:
        """The node of a shell in a damper, which stores heat and passes it on to the film of the damper."""
        place = self._places[damper].geometry
        assert isinstance(place, Damper)
        heat_capacity = SOLIDS[self._thermal.housing_material].heat_capacity
        shell = self._node(f"{name} shell".lstrip(), place.mass * heat_capacity)
        self._to_film(damper, shell)
        housing = self._wall(damper, wall, f"{name} housing".lstrip())
        expansion = self._housing_expansion
        self._follow(damper, place, (shell,), (housing,), expansion, expansion)
        return shell

    def _grow_shaft(self, film: int, geometry: FilmGeometry) -> None:
        if self._thermal.centrifugal_growth == "follows":
            radius = 0.5 * geometry.diameter
            self._growth[film, 0] -= radius * shaft_rotation_strain(SOLIDS[self._thermal.shaft_material], 1.0, radius)

    @property
    def _shaft_expansion(self) -> float:
        return SOLIDS[self._thermal.shaft_material].expansion

    @property
    def _housing_expansion(self) -> float:
        return SOLIDS[self._thermal.housing_material].expansion

    def _node(self, name: str, capacity: float, temperature: float | None = None) -> int:
        self._names.append(name)
        self._capacity.append(capacity)
        self._start.append(self._initial if temperature is None else temperature)
        return len(self._capacity) - 1

    def _to_film(self, film: int, node: int) -> None:
        """h A between a film and a wall, h = Nu k / C."""
        geometry = self._places[film].geometry
        transfer = self._thermal.nusselt * self._case.oil.thermal_conductivity / geometry.clearance
        self._links.append((film, node, transfer * math.pi * geometry.diameter * geometry.width, film))

    def _given(self, name: str, temperature: float | OverTime) -> int:
        """A node of given temperature."""
        node = self._node(name, math.inf, self._value(temperature))
        self._walls.append((node, temperature))
        return node

    def _wall(self, film: int, wall: str | float | OverTime | WallNode, name: str) -> int:
        """The node of a shaft or housing at a film; an adiabatic one has the temperature of its film, and no node."""
        match wall:
            case str():
                return film
            case WallNode():
                node = self._node(name, wall.capacity)
                place = self._given(f"beyond {name}", wall.temperature)
                self._links.append((node, place, wall.conductance, -1))
            case _:
                node = self._given(name, wall)
        self._to_film(film, node)
        return node

    def _follow(
        self, film: int, geometry: FilmGeometry, inside: tuple[int, ...], outside: tuple[int, ...], journal: float,
        shell: float,
    ) -> None:  # fmt: skip
        """(4.24) of one film. inside, outside: nodes whose mean is the temperature of journal and shell; journal,
        shell: their coefficients of expansion, 1/K, where the clearance has none."""
        if self._thermal.clearance == "fixed":
            return
        given, radius, at = geometry.given_clearance, 0.5 * geometry.diameter, self._thermal.reference_temperature
        if isinstance(given, ColdClearance):
            journal, shell, at = given.journal_expansion, given.shell_expansion, given.reference_temperature
            self._base[film] = given.cold
        self._base[film] -= radius * (shell - journal) * at
        for nodes, rate in ((inside, -radius * journal), (outside, radius * shell)):
            self._expansions += [(film, node, rate / len(nodes)) for node in nodes]


def _concentric(case: Case, film: FilmGeometry) -> float:
    """Q eta / C^3 with Q = 2 beta 2 pi R C^3 dp / (12 eta B/2); of a groove at one end a quarter: one land of B."""
    supply = film.supply
    gauge = supply.gauge(case.oil.ambient_pressure)
    share = film.side_flow_factor
    if share is None:
        share = supply.side_flow_factor
    return 2.0 * film.sealed * share * supply.land_share * math.pi * film.diameter * gauge / (6.0 * film.width)


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
