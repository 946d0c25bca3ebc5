"""What changes suddenly during a run: clearances, in steps by heat or wear, and the unbalance by a loss. Times, values,
and the case after each change.

The rotor keeps its displacement and velocity, a mass-conserving film its oil (runs/start.py). The motion of
the gap while it changes is left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TypeVar

from frbcli.case.film_geometry import FilmGeometry
from frbcli.case.model import Model, altered
from frbcli.case.rotor import Loss
from frbcli.case.schema import Case
from frbcli.scene.films import film_places
from frbcli.units import ANGLE, display

Unbalanced = TypeVar("Unbalanced", bound=Model)  # a rotor or a disk


def step_times(case: Case) -> tuple[float, ...]:
    """Times in s at which a clearance changes, ascending."""
    return tuple(sorted({step.time for film in case.films for step in film.clearance_steps}))


def loss_times(case: Case) -> tuple[float, ...]:
    """Times in s at which an unbalance joins the others during a run, ascending."""
    return tuple(sorted({loss.time for _, loss in _losses(case) if loss.time > 0.0}))


def change_times(case: Case) -> tuple[float, ...]:
    """Times in s of all sudden changes, ascending."""
    return tuple(sorted({*step_times(case), *loss_times(case)}))


def case_at(case: Case, time: float) -> Case:
    """The case with the clearances and the unbalance that it has at a time in s."""
    return after_losses(case.with_films([_film_at(film, time) for film in case.films]), time)


def after_losses(case: Case, time: float = math.inf) -> Case:
    """The case with the unbalance of all losses until a time in s."""
    if not any(begin <= time for begin in loss_times(case)):
        return case
    disks = tuple(_lost(disk, disk.loss, time) for disk in case.disks)
    rotor = _lost(case.rotor, getattr(case.rotor, "loss", None), time)
    return altered(case, {"given_rotor": rotor, "disks": disks})


def loss_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """The decisions about losses: choice, value, reason."""
    for name, loss in _losses(case):
        end = case.speed.course[0][-1]
        value = f"{display(loss.unbalance, 'kg*m')} at {display(loss.phase, ANGLE)} from {loss.time:g} s"
        happens = "joins the unbalance, which the rotor turns; its displacement and velocity stay"
        late = f"after the end of a run-up at {end:g} s, on which it has no effect"
        yield f"loss {name}".rstrip(), value, happens if loss.time < end else late


def has_lost(case: Case) -> bool:
    """Whether the unbalance of a loss is there from the beginning."""
    return any(loss.time == 0.0 for _, loss in _losses(case))


def loss_note(case: Case) -> str:
    """What an analysis without time has to say of losses that come in a run, "" without any."""
    times = loss_times(case)
    return f"The unbalance is that before the loss at {times[0]:g} s" if times else ""


def clearance_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """The decisions about clearances that change: choice, value, reason."""
    for place in film_places(case):
        steps = place.geometry.clearance_steps
        if steps:
            later = [f"{1e6 * step.clearance:.4g} um from {step.time:g} s" for step in steps]
            value = ", ".join([f"{1e6 * place.geometry.clearance:.4g} um", *later])
            yield f"clearance {place.name}".rstrip(), value, "set in the case; rotor and oil keep their state"


def _losses(case: Case) -> Iterator[tuple[str, Loss]]:
    """The losses of a case, each with the name of its disk, "" of a symmetric rotor."""
    own = getattr(case.given_rotor, "loss", None)
    named = [(disk.name or str(number), disk.loss) for number, disk in enumerate(case.disks, start=1)]
    return ((name, loss) for name, loss in (("", own), *named) if loss is not None)


def _lost(part: Unbalanced, loss: Loss | None, time: float) -> Unbalanced:
    """A rotor or a disk with its loss from the beginning on if that comes until a time in s."""
    return part if loss is None or loss.time > time else altered(part, {"loss": altered(loss, {"time": 0.0})})


def _film_at(film: FilmGeometry, time: float) -> FilmGeometry:
    passed = [step.clearance for step in film.clearance_steps if step.time <= time]
    return altered(film, {"given_clearance": passed[-1], "clearance_steps": ()}) if passed else film
