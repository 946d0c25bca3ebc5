"""Errors of cycles and folds by the mesh of their films, beside the same cycles and folds on other films.

The rigid rotor in short bearings with another viscosity stands for the same rotor on another mesh: its branches are
followed on their own.
"""

import math
from functools import cache

import numpy as np
import pytest
from cycle_machines import WIDTH, UNIT_Hz, machine_of, rigid
from marches import planned_system

import frbcli
from frbcli.case.schema import Case
from frbcli.columns import table_of
from frbcli.cycles.branch import first_place, follow_branch
from frbcli.cycles.columns import CyclePoint, LimitCycles, special_columns
from frbcli.cycles.diagram import Walk, diagram, point_of
from frbcli.cycles.limit_cycles import Family, resting_over
from frbcli.cycles.method.equilibria import MachineCourse, resting_curve
from frbcli.cycles.method.follower import FoldFollower, Follower, OtherMesh, hopf_error
from frbcli.plot.machine.limit_cycles import limit_cycles_figure

GAMMA, LOW, HIGH, SHARE = 4.538, 2.55, 2.76, 1.5
ASKED = 2.7 * UNIT_Hz
LOWER, SOFT = 3.8, 1.0  # of a fold at a higher speed; of a soft threshold without a fold
WIDER = 1.02


class Plain(FoldFollower):
    """Follows branches without multipliers, as closely as those with them."""

    tail, tail_of_folds = Follower.tail, Follower.tail_of_folds


def short(gamma: float) -> Case:
    return rigid(gamma, LOW, HIGH)


def followed(case: Case, *others: Case) -> LimitCycles:
    """The diagram of a case without multipliers, with errors from the films of others."""
    low, high, asked = (2.0 * math.pi * speed for speed in (LOW * UNIT_Hz, HIGH * UNIT_Hz, ASKED))
    machine = machine_of(case)
    resting = resting_curve(planned_system(case), machine, low, high)
    own, *twins = (MachineCourse(each) for each in (machine, *map(machine_of, others)))
    meshes = tuple(OtherMesh(Follower(twin, low / high), SHARE) for twin in twins)
    walk = Walk(resting, Plain(own, low / high, asked=(asked / high,)), meshes)
    return diagram(case, walk, None, lambda: 0.0)


@cache
def beside(gamma: float) -> tuple[LimitCycles, LimitCycles]:
    """The diagram with errors from films of another gamma, and the diagram of these."""
    return followed(short(GAMMA), short(gamma)), followed(short(gamma))


def at_asked(found: LimitCycles) -> list[CyclePoint]:
    return [point for point in found.branches[0].points if point.kind == "asked"]


def test_a_fold_is_as_uncertain_as_it_is_off() -> None:
    (own,), (other,) = (found.of("fold") for found in beside(LOWER))
    assert own.certain
    assert own.value_uncertainty == pytest.approx(SHARE * abs(own.speed_Hz - other.speed_Hz), rel=0.01)
    assert own.frequency_uncertainty_Hz == pytest.approx(SHARE * abs(own.frequency_Hz - other.frequency_Hz), rel=0.01)
    assert own.eccentricity_max_uncertainty is not None
    off = abs(own.eccentricity_max[0] - other.eccentricity_max[0])
    assert own.eccentricity_max_uncertainty[0] == pytest.approx(SHARE * off, abs=1e-4)


def test_a_cycle_is_compared_at_its_speed() -> None:
    """Both the small cycle and the large one."""
    pairs = list(zip(*map(at_asked, beside(LOWER)), strict=True))
    assert len(pairs) == 2
    for own, other in pairs:
        off = SHARE * abs(own.frequency_Hz - other.frequency_Hz)
        assert own.frequency_uncertainty_Hz == pytest.approx(off, rel=0.01)
        assert own.eccentricity_max_uncertainty is not None
        off = SHARE * abs(own.eccentricity_max[0] - other.eccentricity_max[0])
        assert own.eccentricity_max_uncertainty[0] == pytest.approx(off, rel=0.01)


def test_cycles_at_speeds_at_which_the_other_films_have_none_are_uncertain() -> None:
    """The other films have large cycles above their fold, and small ones from there to their Hopf point."""
    own, other = beside(LOWER)
    (fold,), (hopf,) = other.of("fold"), other.of("hopf")
    points = own.branches[0].points
    turn = [point.kind for point in points].index("fold")
    for part, highest in ((points[:turn], hopf.speed_Hz), (points[turn + 1 :], math.inf)):
        there = [fold.speed_Hz < point.speed_Hz < highest for point in part]
        assert set(there) == {True, False}
        assert [math.isfinite(point.frequency_uncertainty_Hz) for point in part] == there
    assert not any("uncertain" in note for note in own.notes)


def test_errors_over_the_viscosity_are_those_of_films_that_make_it_larger() -> None:
    """Short films that are as much wider as gives them WIDER times the force whirl as the narrow ones do in WIDER times
    the viscosity: their Hopf point and fold lie at 1 / WIDER of the value, with the same frequency and amplitude."""
    case, omega = short(GAMMA), 2.0 * math.pi * 2.72 * UNIT_Hz
    key, high, lowest = "oil.viscosity", 1.1 * float(case.oil.viscosity), 0.6
    wide = case.with_settings(f"bearing.width={WIDTH * WIDER ** (1.0 / 3.0)!r} m")
    own, other = (Family(each, key, high, "Pa*s", omega) for each in (case, wide))
    resting, meshes = resting_over(own, lowest), (OtherMesh(Follower(other, lowest), SHARE),)
    walk = Walk(resting, Plain(own, lowest), meshes)
    branch = follow_branch(walk.follower, first_place(resting.hopf[0]), until=lambda cycle: cycle.kind == "fold")
    (fold,) = (cycle for cycle in branch.cycles if cycle.kind == "fold")
    off = SHARE * (1.0 - 1.0 / WIDER)
    before = other.machine_at.cache_info().misses
    found = point_of(walk, fold)
    assert other.machine_at.cache_info().misses == before + 3
    assert found.value_uncertainty == pytest.approx(off * found.value, rel=1e-3)
    assert found.frequency_uncertainty_Hz < 2e-4 * found.frequency_Hz
    assert found.eccentricity_max_uncertainty is not None
    assert found.eccentricity_max_uncertainty[0] < 1e-3
    cycle = next(each for each in branch.cycles if each is not fold)
    point_of(walk, cycle)
    assert other.machine_at.cache_info().misses == before + 4, (cycle.y[-1], len(branch.cycles))
    value, frequency = hopf_error(own, meshes, resting.hopf[0])
    assert value == pytest.approx(off * resting.hopf[0].equilibrium.value, rel=0.02)  # to first order
    assert frequency < 2e-4 * resting.hopf[0].nu


def test_a_fold_that_the_other_films_do_not_have_is_uncertain() -> None:
    """Films whose threshold is soft have no fold, and no cycles below the threshold."""
    found, other = beside(SOFT)
    (fold,), (hopf,) = found.of("fold"), other.of("hopf")
    assert other.of("fold") == ()
    assert fold.certain is False
    assert math.isnan(fold.value_uncertainty)
    assert any(note.startswith("The fold at") and "is uncertain" in note for note in found.notes)
    assert table_of(special_columns(found.films), [fold]).cells()[0][-1] == "uncertain"
    below = [point for point in found.branches[0].points if point.speed_Hz < hopf.speed_Hz - 1e-3]
    assert all(math.isnan(point.frequency_uncertainty_Hz) for point in below)
    limit_cycles_figure(found)


@pytest.mark.nightly  # 7 s; stated errors of other films: this file
def test_stated_errors_of_a_coarse_table_hold_a_fine_one() -> None:
    """Films of finite length on 3 x 48 elements, beside 12 x 192: the fold, and the cycles at 2.7."""
    finite = short(GAMMA).with_settings("film.theory=finite")
    coarse = frbcli.limit_cycles(finite.with_settings("accuracy.mesh=[3, 48]"), [ASKED])
    fine = followed(finite.with_settings("accuracy.mesh=[12, 192]"))
    (fold,), (true_fold,) = coarse.of("fold"), fine.of("fold")
    assert fold.certain
    assert abs(fold.speed_Hz - true_fold.speed_Hz) <= fold.value_uncertainty < 1e-3 * fold.speed_Hz
    for own, true in [(fold, true_fold), *zip(at_asked(coarse), at_asked(fine), strict=True)]:
        assert abs(own.frequency_Hz - true.frequency_Hz) <= own.frequency_uncertainty_Hz < 1e-3 * own.frequency_Hz
        stated = own.eccentricity_max_uncertainty
        assert stated is not None
        assert np.all(np.abs(own.eccentricity_max - true.eccentricity_max) <= stated)
        assert stated[0] < 5e-3
