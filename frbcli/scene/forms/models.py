"""Bearing models in a case: the chosen model, the faults of such a case, and the record of the model in a run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.bearing_model.model import BearingModel
from frbcli.film.bearing_model.table import model_named
from frbcli.scene.forms.form import FilmForm, SolveCounts

WHY = "set in the case; added from Python"
TOLD = "the whole bearing by one function of displacement, velocity and speed; derivatives by {}"


@dataclass(frozen=True)
class ModelForm(FilmForm):
    """The force of a bearing model, which has no mesh."""

    error_known: ClassVar[bool] = False


GIVEN: FilmForm = ModelForm("force of a bearing model", SolveCounts(1.0, 1.0, 1.6, (1.0, 2.0)), 1.0)


def chosen_model(case: Case) -> BearingModel | None:
    """The bearing model of a case, None for films of the program. Raises InputError if the process does not have it."""
    name = case.film.bearing_model
    if not name:
        return None
    try:
        return model_named(name)
    except KeyError:
        problem = "is a bearing model that this process does not have: another process added it from Python."
        fault = Fault("film.theory", name, None, problem, "Call frbcli.add_bearing with it first.")
        raise InputError(case.name or "case", (fault,)) from None


def model_decisions(model: BearingModel) -> tuple[tuple[str, str, str], ...]:
    """The decisions of the plan for a bearing model: choice, value, reason."""
    by = "differences" if model.derivatives is None else "the model"
    return (
        ("theory", model.name, f"{model.label}: {WHY}"),
        ("cavitation", "in the model", "film.cavitation and bearing.ends have no effect"),
        ("film", str(GIVEN), TOLD.format(by)),
    )
