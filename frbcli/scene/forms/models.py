"""Bearing models in a case: the chosen model, and what it is not made for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError
from frbcli.film.bearing_model.model import BearingModel
from frbcli.film.bearing_model.table import model_named
from frbcli.film.cavitation.table import law_named
from frbcli.scene.films import film_places
from frbcli.scene.forms.form import FilmForm, SolveCounts
from frbcli.scene.gate.rule import (
    ALL,
    KINEMATIC,
    RUN,
    SHEETS,
    SPEED_CYCLES,
    Rule,
    motion_omega,
    oil_flow_signal,
    refusal,
    run_omega,
    sheet_omega,
)
from frbcli.scene.keys import film_keys
from frbcli.scene.tilt import tilt_refusal

WHY = "set in the case; added from Python"
WHOLE_BEARING = "the whole bearing by one function of displacement, velocity and speed; derivatives by {}"


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
        ("film", str(GIVEN), WHOLE_BEARING.format(by)),
    )


def _flowless(case: Case) -> str | None:
    """The model, where heat leaves with an oil flow that it does not give."""
    model = chosen_model(case)
    asked = case.heat is not None and case.heat.side_flow == "film"
    return case.film.theory if asked and model is not None and model.flow is None else None


def _with_heat(case: Case) -> str | None:
    return None if case.heat is None else case.film.theory


def _key_faults(case: Case) -> Iterator[Fault]:
    """Keys that are set and have no effect on a bearing model."""
    film = case.film
    cavitation = next((law for law in case.cavitations if not law_named(law).closed), "")
    asked = {
        "solution": ("" if film.solution == "auto" else film.solution, "Write auto."),
        "grid": (film.grid if film.grid == "half-speed" else "", "Write auto."),
        "cavitation": (cavitation, "Leave it out, or write half-sommerfeld."),
        "coupling": (film.coupling if film.coupling == "monolithic" else "", "Write dynamic-static or auto."),
    }
    problem = f"has no effect with film.theory = {film.theory}, a bearing model, which gives the whole force."
    for key, (value, remedy) in asked.items():
        if value:
            yield Fault(f"film.{key}", value, None, problem, remedy)


def _geometry_faults(case: Case) -> Iterator[Fault]:
    """Parts of bearings that a model cannot represent."""
    for key, place in zip(film_keys(case), film_places(case), strict=True):
        yield from _parts_faults(key, place.geometry)


def _parts_faults(key: str, film: FilmGeometry) -> Iterator[Fault]:
    supply, remedy = film.supply, "Leave it out: the model represents the whole bearing."
    if not supply.plain:
        problem = "is a supply that a bearing model cannot represent."
        yield Fault(f"{key}.supply.kind", supply.kind, None, problem, remedy)
    elif supply.rise_time > 0.0:
        problem = "is a ramp of the pressure, which a bearing model cannot represent."
        yield Fault(f"{key}.supply.ramp", f"{supply.rise_time:g} s", None, problem, "Write 0 s.")
    if film.shell is not None:
        problem = "is a shape of the shell that a bearing model cannot represent."
        yield Fault(f"{key}.{film.shell.key}", film.shell.words, None, problem, remedy)


def _force_faults(case: Case, omega: float) -> Iterator[Fault]:
    """A function that gives forces that cannot be used; omega: highest rotor speed in rad/s. Raises InputError if this
    process does not have the model."""
    model = chosen_model(case)
    if model is None:
        return
    from frbcli.scene.machine.machine_films import force_problems  # numba takes longer to import than a plan

    remedy = "Correct the function of the model, and add it again."
    for problem in force_problems(case, model, omega):
        yield Fault("film.theory", model.name, None, f"{problem}.", remedy)


RULES = (
    refusal(
        ALL, "film.theory", _flowless, "does not give the oil flow that leaves its film with the heat",
        "Give BearingModel a function flow(d_x, d_y, v_x, v_y, omega, bearing) that returns it in m^3/s "
        '(docs/adding-a-model.md), or write thermal.side_flow = "concentric".',
    ),
    refusal(
        KINEMATIC, "film.theory", _with_heat, "gives these tests its force alone, without the heat of its film",
        'Write thermal.model = "none" here, or call `frb bearing` or `frb runup`.',
    ),
    refusal(
        (SPEED_CYCLES,), "film.theory", _with_heat,
        "may follow the viscosity in any way, and in limit cycles with heat forces are multiples of each other",
        'Write thermal.model = "none", with the viscosity at the temperature of the film, or take a run-up.',
    ),
    Rule(_key_faults, (RUN, *KINEMATIC, *SHEETS)),
    tilt_refusal(
        "has no effect on a bearing model, whose force depends on one displacement and one velocity of the journal",
        'Write film.theory = "finite", or leave the tilt out.',
    ),
    Rule(_geometry_faults, (RUN, *KINEMATIC, *SHEETS)),
    refusal(
        (RUN,), "output.signals", oil_flow_signal,
        "is not known of a bearing model, which gives forces alone", "Write finite, short or auto for film.theory.",
    ),
    Rule(lambda case: _force_faults(case, run_omega(case)), (RUN,), last=True),
    Rule(lambda case: _force_faults(case, motion_omega(case)), KINEMATIC, last=True),
    Rule(lambda case: _force_faults(case, sheet_omega(case)), SHEETS, last=True),
)  # fmt: skip


@dataclass(frozen=True)
class ModelForm(FilmForm):
    """The force of a bearing model, which has no mesh."""

    solved: ClassVar[bool] = False
    same_in_tests: ClassVar[bool] = True
    follows_supply: ClassVar[bool] = False
    rules: ClassVar[tuple[Rule, ...]] = RULES

    def parts_in_tests(self, case: Case) -> tuple[tuple[int, int], str] | None:
        return (0, 0), ""

    def remedies(self, case: Case) -> tuple[str, ...]:
        return (f"a force of film.theory = {case.film.theory} without jumps, or with derivatives of its own",)


GIVEN: FilmForm = ModelForm("force of a bearing model", SolveCounts(1.0, 1.0, 1.6, (1.0, 2.0)), 1.0)
