"""Mass and inertia of a floating ring from its material, width and diameters."""

import math

import numpy as np
import pytest

from frbcli import Case, InputError, load_case, make_plan
from frbcli.case.bearing import FloatingRingBearing
from frbcli.scene.machine.rotor import make_rotor

BRASS = 8860.0  # kg/m^3


def without(*keys: str) -> Case:
    case = load_case("floating-ring")
    return case.with_settings({f"bearing.ring.{key}": None for key in keys}, {"bearing.ring.material": "brass"})


def ring_of(case: Case) -> FloatingRingBearing:
    (bearing,) = case.bearings
    assert isinstance(bearing, FloatingRingBearing)
    return bearing


def test_a_hollow_cylinder_has_its_mass_and_inertia() -> None:
    """By the sum over thin shells of mass 2 pi rho B r dr, and r^2 times it."""
    bearing = ring_of(without("mass", "inertia"))
    inner, outer, width = 0.5 * bearing.inner.diameter, 0.5 * bearing.outer.diameter, bearing.inner.width
    edges = np.linspace(inner, outer, 20_001)
    middle = 0.5 * (edges[1:] + edges[:-1])
    shells = 2.0 * math.pi * BRASS * width * middle * np.diff(edges)
    assert bearing.ring_mass == pytest.approx(shells.sum(), rel=1e-9)
    assert bearing.ring_inertia == pytest.approx((shells * middle**2).sum(), rel=1e-8)
    wide = ring_of(without("mass", "inertia").with_settings({"bearing.ring.width": 2.0 * width}))
    assert wide.ring_mass == pytest.approx(2.0 * bearing.ring_mass)


def test_what_is_given_is_kept_and_what_follows_is_said() -> None:
    given = ring_of(load_case("floating-ring"))
    assert (given.ring_mass, given.ring_inertia) == (given.ring.given_mass, given.ring.given_inertia)
    half = without("inertia")
    bearing = ring_of(half)
    squares = bearing.inner.diameter**2 + bearing.outer.diameter**2
    assert bearing.ring_inertia == pytest.approx(given.ring_mass * squares / 8.0)
    (said,) = (one for one in make_plan(half).decisions if one.choice == "ring")
    assert said.value == f"inertia {1e6 * bearing.ring_inertia:.4g} kg*mm^2"
    (said,) = (one for one in make_plan(without("mass", "inertia")).decisions if one.choice == "ring")
    assert said.value.startswith("mass ")
    assert "a cylinder of brass" in said.reason
    assert [one for one in make_plan(load_case("floating-ring")).decisions if one.choice == "ring"] == []


def test_the_machine_has_the_mass_of_the_ring() -> None:
    case = without("mass")
    heavier = np.trace(make_rotor(case).mass) - np.trace(make_rotor(load_case("floating-ring")).mass)
    more = ring_of(case).ring_mass - ring_of(load_case("floating-ring")).ring_mass
    assert heavier == pytest.approx(4.0 * more, rel=1e-9)  # two rings, each in x and y


def test_a_ring_needs_a_mass_or_a_material() -> None:
    with pytest.raises(InputError, match=r'bearing.ring.mass: is missing. Add e.g. mass = "30 g", or material'):
        load_case("floating-ring").with_settings({"bearing.ring.mass": None})
    with pytest.raises(InputError, match=r'bearing.ring.width = "10 mm": has no effect'):
        load_case("floating-ring").with_settings({"bearing.ring.width": "10 mm"})
