"""The table of the cavitation laws: each has its own form, which is compiled, documents name all, users add theirs."""

import re
import runpy
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from paths import DOCS

import frbcli
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case
from frbcli.errors import InputError
from frbcli.film.cavitation import table
from frbcli.film.cavitation.conditions import HalfSommerfeld
from frbcli.film.cavitation.law import FilmOil, Law, Scales
from frbcli.film.cavitation.table import SHIPPED, law_named
from frbcli.scene.films import film_places, film_section, make_law

SCALES = Scales(reference=900.0, cavitation=-60.0, ambient=500.0)
W = np.concatenate([np.linspace(-1.4, 0.6, 801), [-1e-9, 0.0, 1e-9]])
RESULTS = ("pressure", "fraction", "source")
SHORT = ("speed.duration=2 ms", "speed.from=40 Hz", "speed.to=41 Hz", "accuracy.mesh=[3, 24]",
         "accuracy.tolerance=1e-5")  # fmt: skip


def default_of(law: type[Law]) -> Law:
    """A law with the defaults of its keys, in a film of table 4.1, where the journal is half way to the shell."""
    given = SimpleNamespace(**{key.name: key.default for key in law.keys})
    return law.scaled(given, FilmOil(200.0, 1e5, 0.88e5, 850.0)).followed(0.5, 600.0)


@pytest.fixture
def added() -> Iterator[None]:
    """Takes away what a test adds."""
    yield
    for law in table.laws():
        if law not in SHIPPED:
            frbcli.remove_law(law.name)


@pytest.mark.parametrize("law", SHIPPED)
def test_every_law_has_a_compiled_form_of_its_own_that_is_the_plain_one(law: type[Law]) -> None:
    assert "cell" in vars(law) or law.name == "half-sommerfeld"  # which differs in what its loads take
    own = default_of(law)
    compiled, numbers = own.cells(W, SCALES), own.parameters + (0.0, 0.0) * law.carries_gas
    plain = np.transpose([own.cell(float(w), numbers, SCALES) for w in W])
    for expected, name in zip(plain, (*RESULTS, *(f"{name}_slope" for name in RESULTS)), strict=False):
        size = float(np.max(np.abs(expected)))
        assert getattr(compiled, name) == pytest.approx(expected, rel=1e-9, abs=1e-9 * size + 1e-300), name


def test_a_name_without_a_row_raises() -> None:
    case = load_case("jeffcott-two-phase")
    section = film_section(case, film_places(case)[0].geometry)
    for law in SHIPPED:
        assert isinstance(make_law(case, law.name, section), law)
    with pytest.raises(KeyError, match="no cavitation law 'two-fase'; there are sommerfeld, half-sommerfeld"):
        make_law(case, "two-fase", section)


def test_documents_have_a_row_for_every_law() -> None:
    theory = (DOCS / "theory.md").read_text(encoding="utf-8")
    for law in SHIPPED:
        name = f"`{law.name}` {law.equation}".rstrip()
        words = law.cell_words.replace("`p_cav`", r"$p_\mathrm{cav}$").replace("`theta(p)`", r"$\theta(p)$")
        assert f"| {name} | {words} | {'yes' if law.keeps_oil else 'no'} |" in theory


def example() -> str:
    """The law of docs/adding-a-model.md."""
    page = (DOCS / "adding-a-model.md").read_text(encoding="utf-8")
    (found,) = (text for text in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "add_law" in text)
    return str(found)


@pytest.mark.usefixtures("added")
def test_the_law_of_the_page_works_in_rotation_and_run_up(tmp_path: Path) -> None:
    page = tmp_path / "page.py"
    page.write_text(example(), encoding="utf-8")
    names = runpy.run_path(str(page))
    case, force = names["case"], np.array(names["force"])
    assert case.film.given("linear").depth == 5e3
    assert "film.linear.depth" in {value.key for value in values(case)}
    alike = load_case("bearing-axial-groove", ["film.cavitation=two-phase", "film.two-phase.steepness=0.975"])
    expected = frbcli.rotation(alike).results[0].loads
    assert force == pytest.approx(expected.force, abs=0.02 * np.linalg.norm(expected.force))
    settings = ("film.cavitation=linear", "film.linear.depth=1e-4 bar", *SHORT)
    run = frbcli.runup(load_case("axial-groove-two-phase", settings), tmp_path / "linear.h5")
    other = frbcli.runup(load_case("axial-groove-two-phase", ("film.cavitation=elrod", *SHORT)), tmp_path / "elrod.h5")
    assert run.status == other.status == "finished"
    assert run["oil_fraction"][-1] < 1.0
    assert run["eccentricity"] == pytest.approx(other["eccentricity"], abs=1e-3 * float(other["eccentricity"].max()))
    # what the last step leaves of a steep law, see test_what_an_iteration_leaves_of_a_curved_law_does_not_add_up
    assert abs(run.error["oil_balance_relative"]) < 1e-5


@pytest.mark.usefixtures("added")
def test_a_changed_law_is_the_one_that_is_solved() -> None:
    """In films and in the compiled form alone: nothing compiled of the one before is met again."""

    def with_slope(share: float) -> type[Law]:
        @dataclass(frozen=True)
        class Mine(Law):
            name = "mine"
            label = "mine"
            keeps_oil = False

            @staticmethod
            def cell(w: float, parameters: Any, scales: Scales) -> Any:  # noqa: ARG004
                return scales.cavitation + share * w * scales.reference, 1.0, 0.0, share * scales.reference, 0.0, 0.0

        return Mine

    forces, pressures = [], []
    for share in (1.0, 0.5):
        mine = with_slope(share)
        frbcli.add_law(mine)
        motion = "motion={ eccentricity = 0.4, speed = '20 Hz' }"
        case = load_case("bearing-axial-groove", ["film.cavitation=mine", motion])
        forces.append(np.array(frbcli.rotation(case).results[0].loads.force))
        pressures.append(mine().cells(W, SCALES).pressure - SCALES.cavitation)
    assert pressures[1] == pytest.approx(0.5 * pressures[0])
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)  # the same linear film in another unknown


@pytest.mark.usefixtures("added")
def test_what_is_no_law_is_refused() -> None:
    @dataclass(frozen=True)
    class Named(Law):
        name = "elrod"
        label = "mine"

    with pytest.raises(ValueError, match="has the name of a shipped law, elrod"):
        frbcli.add_law(Named)
    Named.name = "mine"
    with pytest.raises(ValueError, match="has no `cell`"):
        frbcli.add_law(Named)
    with pytest.raises(ValueError, match="no frozen dataclass"):
        frbcli.add_law(int)  # type: ignore[type-var]
    with pytest.raises(InputError, match="is not known here"):
        load_case("bearing", ["film.cavitation=mine"])
    assert law_named("elrod") in SHIPPED


@pytest.mark.usefixtures("added")
def test_coefficients_of_a_law_that_clips_and_keeps_oil_are_those_of_its_forces() -> None:
    """Half-Sommerfeld with oil that is a state and never missing: its coefficients are differences of settled films,
    and those of half-Sommerfeld on the same cells."""

    @dataclass(frozen=True)
    class Keeping(HalfSommerfeld):
        name = "keeping"
        label = "keeping"
        closed = False
        keeps_oil = True

    frbcli.add_law(Keeping)
    free = ("bearing.ends=oil-bath", "bearing.supply={ kind = 'none' }", "film.solution=cells")
    films = []
    for law in ("keeping", "half-sommerfeld"):
        case = load_case("jeffcott", [f"film.cavitation={law}", *free[: 2 if law == "keeping" else 3]])
        (film,) = frbcli.bearing_sheet(case, [20.0], load=30.0).points
        films.append(film)
    mine, known = films
    assert mine.displacement == pytest.approx(known.displacement, abs=1e-8)
    for name in ("stiffness", "damping"):
        own, expected = getattr(mine, name), getattr(known, name)
        assert own == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())
