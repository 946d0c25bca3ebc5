"""What a notebook shows of cases, plans, runs and results."""

import inspect
from importlib import import_module
from importlib.resources import files
from pathlib import Path

import pytest

import frbcli
from frbcli.plot.picture import PICTURES, picture

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def case() -> frbcli.Case:
    return frbcli.load_case("jeffcott", ["film.theory=short", "speed.duration=0.3 s"])


def test_text_of_everything_is_a_few_lines(case: frbcli.Case, tmp_path: Path) -> None:
    run = frbcli.runup(case, tmp_path / "run.h5")
    found = frbcli.stability(case)
    plan = frbcli.make_plan(case)
    begins = {"Case jeffcott: ": case, "Plan\n": plan, "Run ": run, "Stability of jeffcott: ": found}
    for words, thing in begins.items():
        text = repr(thing)
        assert text.startswith(words)
        assert len(text.splitlines()) <= 20
        assert max(map(len, text.splitlines())) < 300
    assert "finished at 0.3 s" in repr(run)
    assert picture(found)._repr_png_().startswith(PNG)  # type: ignore[attr-defined]
    assert frbcli.picture(run).axes


def test_what_has_no_picture_says_what_has(case: frbcli.Case) -> None:
    with pytest.raises(frbcli.InputError, match=r"Case: has no picture. There are pictures of: AccuracyLadder"):
        picture(case)
    assert len(PICTURES) == 17


@pytest.mark.parametrize("kind", PICTURES)
def test_a_picture_is_of_the_result_that_its_function_takes(kind: str) -> None:
    module, _, name = PICTURES[kind].partition(":")
    draw = getattr(import_module(f"frbcli.plot.{module}"), name)
    taken = next(iter(inspect.signature(draw).parameters.values())).annotation
    assert taken == kind


def test_types_are_told() -> None:
    assert files("frbcli").joinpath("py.typed").is_file()
