"""Force laws that are added from Python: against springs of the program, closed forms, and what is refused."""

import math
import re
import runpy
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from marches import control, march, start
from scipy.integrate import quad

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.elements.spring import LAWS, SpringForce
from frbcli.errors import InputError
from frbcli.rotor.loads import speed_profile
from frbcli.rotor.port import ANSWER, D_X, F_X, MOTION, XX
from frbcli.rotor.port_function import evaluate
from frbcli.scene.machine.system import make_system
from frbcli.scene.planning.plan import make_plan

M, K, P = 2.0, 1e6, 1e25  # kg, N/m of both bearings, N/m^5


@dataclass(frozen=True)
class Cubic(frbcli.ForceLaw):
    """The cubic spring of the program, without derivatives."""

    stiffness: float
    cubic: float
    damping: float

    units: ClassVar = {"stiffness": "N/m", "cubic": "N/m^3", "damping": "N*s/m"}
    length = 1e-5

    @staticmethod
    def push(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, law: Any) -> tuple[float, float]:  # noqa: ARG004
        along = law.stiffness + law.cubic * (d_x * d_x + d_y * d_y)
        return -along * d_x - law.damping * v_x, -along * d_y - law.damping * v_y


@dataclass(frozen=True)
class FifthPower(frbcli.ForceLaw):
    """F_x = -p d_x^5, with derivatives."""

    p: float

    units: ClassVar = {"p": "N/m^5"}
    length = 1e-5

    @staticmethod
    def force(numbers: Any, memory: Any, motion: Any, answer: Any) -> None:  # noqa: ARG004
        for i in range(len(answer)):
            answer[i] = 0.0
        answer[F_X], answer[XX] = -numbers[0] * motion[D_X] ** 5, -5.0 * numbers[0] * motion[D_X] ** 4


@pytest.fixture(autouse=True)
def laws() -> Iterator[None]:
    frbcli.add_force_law("own-cubic", Cubic)
    frbcli.add_force_law("fifth-power", FifthPower)
    yield
    frbcli.remove_force_law("own-cubic")
    frbcli.remove_force_law("fifth-power")


def sprung(spring: dict[str, Any], **more: Any) -> frbcli.Case:
    """A rigid rotor in two linear bearings, with one spring at each of its journals."""
    data = {
        "rotor": {"kind": "rigid", "mass": f"{M} kg", "unbalance": "20 g*mm"},
        "bearing": {"kind": "coefficients", "stiffness": f"{0.5 * K!r} N/m"},
        "spring": [{"at": "journal", **spring}],
        "speed": {"from": "20 Hz", "to": "40 Hz", "duration": "0.1 s"},
    }
    return case_from_dict(data | more, "sprung")


GIVEN = {"stiffness": "1e5 N/m", "cubic": "5e14 N/m^3", "damping": "30 N*s/m"}
OWN = {"law": "own-cubic", "numbers": GIVEN}


def test_a_law_by_differences_is_the_spring_of_the_program() -> None:
    own, program = sprung(OWN).springs[0].own_law, SpringForce(sprung(GIVEN).springs[0])
    for motion in np.random.default_rng(1).uniform(-1.0, 1.0, (10, MOTION)) * [2e-5, 2e-5, 0.01, 0.01, 900.0, 6.0]:
        known, found = evaluate(program, motion), evaluate(own, motion)
        np.testing.assert_allclose(found[:XX], known[:XX], rtol=1e-14)
        np.testing.assert_allclose(found[XX:], known[XX:], rtol=1e-6, atol=1e-6 * np.abs(known[XX:]).max())
        np.testing.assert_allclose(own.plainly(motion), found, rtol=1e-9, atol=1e-9 * np.abs(found).max())


def test_rest_eigenvalues_response_and_run_have_it(tmp_path: Path) -> None:
    own, program = sprung(OWN), sprung(GIVEN)
    one, other = (frbcli.stability(case, [30.0]).points[0].eigenvalues for case in (own, program))
    np.testing.assert_allclose(one, other, rtol=1e-7)
    one, other = (frbcli.response(case, [30.0]).motion for case in (own, program))
    np.testing.assert_allclose(one, other, rtol=1e-7)
    runs = [frbcli.runup(case, tmp_path / f"{name}.h5") for name, case in (("own", own), ("program", program))]
    one, other = (run["journal_y_m"] for run in runs)
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-7 * np.abs(other).max())
    np.testing.assert_allclose(
        runs[0]["spring_force_1_y_N"], runs[1]["spring_force_1_y_N"], rtol=0,
        atol=1e-6 * np.abs(runs[1]["spring_force_1_y_N"]).max(),
    )  # fmt: skip
    assert re.fullmatch("own-cubic with forces [0-9a-f]{16}", runs[0].versions[LAWS])
    assert LAWS not in runs[1].versions


def test_a_law_with_derivatives_moves_a_machine() -> None:
    """F = -p d^5: a quarter period from its energy."""
    numbers = {"p": f"{P!r} N/m^5"}
    weightless = {"kind": "rigid", "mass": f"{M} kg", "unbalance": "0 kg*m", "gravity": "0 m/s^2"}
    case = sprung({"law": "fifth-power", "numbers": numbers}, rotor=weightless)
    amplitude = 3e-5

    def quarter(angle: float) -> float:
        x = amplitude * math.sin(angle)
        rest = (amplitude**4 + amplitude**2 * x**2 + x**4) * 2.0 * P / 3.0  # of both journals
        return 1.0 / math.sqrt((K + rest) / M)

    period = 4.0 * quad(quarter, 0.0, 0.5 * math.pi, epsabs=0.0, epsrel=1e-12)[0]
    system = make_system(case, make_plan(case))
    profile = speed_profile([0.0, 5.0 * period], [0.0, 0.0])
    begin = start(system, profile, np.array([amplitude, 0.0]))
    result = march(system, profile, control(tolerance=1e-10, longest=1e-4, output=period), begin)
    np.testing.assert_allclose(result.q[:, 0], amplitude, rtol=1e-6)


def test_the_damper_of_the_documents_is_the_short_bearing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """docs/adding-a-model.md: in a circular whirl about the centre, half-Sommerfeld's damping and stiffness."""
    page = (Path(__file__).parents[2] / "docs" / "adding-a-model.md").read_text(encoding="utf-8")
    (example,) = (text for text in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "ForceLaw" in text)
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "own.py"
    file.write_text(example, encoding="utf-8")
    names = runpy.run_path(str(file))
    assert names["run"].status == "finished"
    (spring,) = names["case"].springs
    law, eccentricity, whirl = spring.own_law, 0.4, 200.0
    place = eccentricity * law.clearance
    motion = np.zeros(MOTION)
    motion[:4] = place, 0.0, 0.0, place * whirl
    f_x, f_y = evaluate(law, motion)[:XX] + np.array([law.spring * place, 0.0])
    size = law.viscosity * law.radius * law.width**3 / law.clearance**2 * whirl
    rest = 1.0 - eccentricity**2
    assert f_y == pytest.approx(-size * math.pi * eccentricity / (2.0 * rest**1.5), rel=2e-3)
    assert f_x == pytest.approx(-size * 2.0 * eccentricity**2 / rest**2, rel=2e-3)
    frbcli.remove_force_law("own-damper")


@pytest.mark.parametrize(
    ("spring", "key", "problem"),
    [
        ({"law": "own-quadratic"}, "spring.0.law", "is no force law of this process"),
        ({"law": "own-cubic"}, "spring.0.numbers", "lacks"),
        ({**OWN, "gap": "1 um"}, "spring.0.gap", "has no effect with a law"),
        ({**OWN, "numbers": GIVEN | {"cubic": 5e14}}, "spring.0.numbers.cubic", "has no unit"),
        ({**OWN, "numbers": GIVEN | {"cubic": "1 mm"}}, "spring.0.numbers.cubic", "cannot be turned into"),
        ({**OWN, "numbers": GIVEN | {"quartic": 1.0}}, "spring.0.numbers.quartic", "is no field"),
        ({"stiffness": "1 N/m", "numbers": {"p": 1.0}}, "spring.0.numbers", "has no effect without a law"),
    ],
)
def test_what_does_not_fit_is_refused(spring: dict[str, Any], key: str, problem: str) -> None:
    with pytest.raises(InputError) as refused:
        sprung(spring)
    faults = {fault.key: fault.problem for fault in refused.value.faults}
    assert problem in faults[key]


def test_forces_that_cannot_be_used_are_found_before_anything_runs() -> None:
    @dataclass(frozen=True)
    class Pole(frbcli.ForceLaw):
        p: float
        length = 1e-5

        @staticmethod
        def push(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, law: Any) -> tuple[float, float]:  # noqa: ARG004
            return -law.p / d_x, 0.0

    class Wrong(FifthPower):
        @staticmethod
        def force(numbers: Any, memory: Any, motion: Any, answer: Any) -> None:
            FifthPower.force(numbers, memory, motion, answer)
            answer[XX] *= 0.5

    for law, numbers, problem in ((Pole, {"p": 1.0}, "no finite force"), (Wrong, {"p": "1e25 N/m^5"}, "differ")):
        frbcli.add_force_law("own-cubic", law)
        with pytest.raises(InputError, match=problem):
            make_plan(sprung({"law": "own-cubic", "numbers": numbers}))
    assert len(Cubic(1.0, 1.0, 1.0).plainly(np.zeros(MOTION))) == ANSWER


@pytest.mark.parametrize(
    ("name", "law", "problem"),
    [("Own", Cubic, "small letters"), ("own", dict, "no dataclass"), ("own", frbcli.ForceLaw, "no dataclass")],
)
def test_what_is_no_law_is_not_added(name: str, law: Any, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        frbcli.add_force_law(name, law)
