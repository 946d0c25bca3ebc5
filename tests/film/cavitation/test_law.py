"""theta(p) of the conserving models: limits, the laws that the films are solved with, and the picture of them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from frbcli.case.reading.load import load_case
from frbcli.cli.main import run
from frbcli.film.cavitation.barotropic import vapour_fraction
from frbcli.film.cavitation.conditions import Elrod
from frbcli.film.cavitation.law import Law, Scales
from frbcli.film.cavitation.two_phase import Peeken, TwoPhase
from frbcli.plot.machine.film import law_figure

CAVITY = 5.0  # 1/s, absolute
SCALES = Scales(reference=3.0, cavitation=0.0, ambient=CAVITY)


def curve(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """p / p_cav and theta (n,) of what a film is solved with."""
    state = law.cells(np.linspace(-1.5, 0.5, 401), SCALES)
    ratio, kept = 1.0 + state.pressure / CAVITY, state.fraction > 1e-3
    return ratio[kept], state.fraction[kept]


def test_curves_are_those_of_the_films() -> None:
    ratio, fraction = curve(TwoPhase(0.9))
    np.testing.assert_allclose(TwoPhase(0.9).curve(ratio), fraction, atol=1e-9)
    ratio, fraction = curve(Peeken(0.1))
    np.testing.assert_allclose(Peeken(0.1).curve(ratio), fraction, atol=1e-12)
    ratio, fraction = curve(Elrod(bulk_modulus=20.0 * CAVITY))
    full = ratio > 1.0
    np.testing.assert_allclose(Elrod(20.0).curve(ratio[full]), fraction[full], rtol=1e-12)
    assert np.all(ratio[~full] == 1.0)  # every fraction at p_cav itself


@pytest.mark.parametrize("model", ["two-phase", "peeken", "elrod", "half-sommerfeld"])
def test_picture_names_the_case_and_its_model(model: str) -> None:
    settings = [f"film.cavitation={model}", "film.peeken.bunsen=0.3", "film.two-phase.steepness=0.97"]
    figure = law_figure(load_case("bearing", settings))
    assert figure.get_suptitle().startswith("Journal bearing, groove at one end")
    left, right = figure.axes
    assert "bar" in left.get_xlabel()
    labels = [text.get_text() for axes in (left, right) for text in axes.get_legend().get_texts()]
    own = [label for label in labels if label.endswith("(the case)")]
    assert len(own) == {"two-phase": 2, "peeken": 1, "elrod": 1, "half-sommerfeld": 0}[model]
    assert any("0.97" in label for label in labels)
    assert any("0.3" in label for label in labels)
    thick = [line for line in right.lines if line.get_linewidth() > 1.5]
    assert len(thick) == (0 if model == "half-sommerfeld" else 1)


def test_laws_that_this_oil_cannot_have_are_left_out() -> None:
    """A vapour as stiff as the oil, and one that is nowhere lighter: no law of Bayada and Chupin."""
    with pytest.raises(ValueError, match="lighter than the liquid"):
        vapour_fraction(8.3e-4 * 350.0**2, 8.3e-4 * 1400.0**2, 1e5)
    speeds = ["film.barotropic.vapour_sound_speed=1400 m/s", "film.barotropic.liquid_sound_speed=1400 m/s"]
    labels = [text.get_text() for text in law_figure(load_case("bearing", speeds)).axes[1].get_legend().get_texts()]
    assert not any("Bayada" in label for label in labels)
    assert any("Peeken" in label for label in labels)


def test_command_draws_a_case(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["plot", "bearing", "--what", "law", "--set", "film.cavitation=elrod", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found == {"command": "plot", "case": "bearing", "output": "bearing-law.png", "what": "law"}
    assert (tmp_path / "bearing-law.png").stat().st_size > 10_000
