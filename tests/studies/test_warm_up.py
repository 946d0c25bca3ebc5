"""Kernels are compiled ahead of time, once, and not by a check: with an empty cache of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import frbcli
from frbcli.case.reading.shipped import shipped_names
from frbcli.cli.main import run
from frbcli.compilation import counted
from frbcli.studies.kernels.short_analyses import CELLS, OTHERS, ShortAnalysis, short_analyses
from frbcli.studies.kernels.warm_up import _compile

# A run-up in which nothing may be compiled
RUN = """
import sys, frbcli
from frbcli.compilation import counted
with counted() as compilations:
    frbcli.runup(frbcli.load_case("seal", ["speed.duration=0.01 s"]), sys.argv[1])
assert compilations.functions == 0, compilations.functions
"""


def cold(words: list[str], cache: Path) -> Any:
    """The JSON document of a command whose kernels lie in `cache`."""
    done = subprocess.run(
        [sys.executable, "-m", "frbcli", *words, "--json"],
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache)}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return json.loads(done.stdout)


def test_kernels_are_compiled_once(tmp_path: Path) -> None:
    """The machine without films has the fewest kernels. Afterwards nothing is missing, also not in a longer run."""
    cache = tmp_path / "cache"
    first = cold(["warm-up", "seal"], cache)
    assert first["cases"] == ["seal"]
    assert first["functions"] == sum(each["functions"] for each in first["compiled"]) > 20
    assert 0.0 < first["cpu_s"] == pytest.approx(sum(each["cpu_s"] for each in first["compiled"]))
    again = cold(["warm-up", "seal"], cache)
    assert (again["compiled"], again["functions"]) == ([], 0)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    subprocess.run([sys.executable, "-c", RUN, str(tmp_path / "run.h5")], env=environment, check=True)


def test_rough_surfaces_have_kernels_of_their_own() -> None:
    """They are compiled beside those of the same machine with smooth ones."""
    rough = ["contact.model=asperities", "contact.roughness=0.5 um", "contact.summit_radius=20 um",
             "contact.summit_density=4e10 1/m^2"]  # fmt: skip
    kinds = [{short.kind for short in short_analyses(frbcli.load_case("jeffcott", given))} for given in ([], rough)]
    assert {kind[0] for kind in kinds[1]} == {"run", "bearing sheet"}
    assert not kinds[0] & kinds[1]


def test_a_fresh_kernel_is_counted() -> None:
    from numba import njit

    kernel = njit(lambda x: x + 2.0)
    with counted() as compilations:
        assert kernel(1.0) == 3.0
    assert compilations.functions == 1
    assert compilations.cpu_s > 0.0
    with counted() as later:
        assert kernel(1.0) == 3.0
    assert later.functions == 0


def test_every_shipped_case_has_moments_of_what_it_can_be_asked_for() -> None:
    found = {name: list(short_analyses(frbcli.load_case(name))) for name in shipped_names()}
    assert [name for name, each in found.items() if not each] == ["thrust"]  # has no compiled kernels
    analyses = {name: [short.analysis for short in each] for name, each in found.items()}
    assert analyses["jeffcott"] == ["run", "stability", "bearing sheet"]
    assert analyses["seal"] == ["run", "stability"]
    assert analyses["bearing"] == ["rotation"]
    assert {"squeeze", "whirl"} & set(analyses["squeeze"])
    assert {short.family for short in found["jeffcott"]} == {CELLS, OTHERS}
    assert {short.family for short in found["floating-ring"]} == {CELLS}
    kinds = [short.kind for name in ("jeffcott", "run-down", "turbocharger-car-heat") for short in found[name]]
    assert len(set(kinds)) == 6  # the first two have the same films


def test_a_moment_without_a_solution_has_compiled_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    def compute(_: ShortAnalysis) -> None:
        raise frbcli.NotConverged("nowhere")

    monkeypatch.setattr(ShortAnalysis, "compute", compute)
    (short, *_) = short_analyses(frbcli.load_case("jeffcott"))
    assert _compile(short).functions == 0


def test_what_is_no_case_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["warm-up", "nothing"]) == 2
    assert "neither a file nor a shipped case" in capsys.readouterr().err
