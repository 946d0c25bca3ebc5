"""What changes during a run: clearances, in steps by heat or wear, unbalance by a loss, inputs over time, the drive.

Sudden changes have times, values and the case after each of them; inputs and the drive their lines in a plan, times and
faults. The rotor keeps its displacement and velocity at a sudden change, a mass-conserving film its oil
(runs/start.py). The motion of the gap while it changes is left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TypeVar

from frbcli.case.film import FilmGeometry
from frbcli.case.model import Model, altered
from frbcli.case.reading.time_tables import inputs_of
from frbcli.case.rotor import Loss, Losses
from frbcli.case.schema import Case
from frbcli.errors import Fault
from frbcli.scene.films import film_places
from frbcli.scene.machine.rotor import span_faults
from frbcli.units import ANGLE, display

Unbalanced = TypeVar("Unbalanced", bound=Model)  # a rotor or a disk


def step_times(case: Case) -> tuple[float, ...]:
    """Times in s at which a clearance changes, ascending."""
    return tuple(sorted({step.time for film in case.films for step in film.clearance_steps}))


def losses_in_time(case: Case) -> tuple[tuple[float, str], ...]:
    """Times in s at which an unbalance joins the others during a run, ascending, each with the name of its disk."""
    return tuple(sorted({(loss.time, name) for name, loss in _losses(case) if loss.time > 0.0}))


def loss_times(case: Case) -> tuple[float, ...]:
    """Times in s at which an unbalance joins the others during a run, ascending."""
    return tuple(dict.fromkeys(time for time, _ in losses_in_time(case)))


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
    disks = tuple(_lost(disk, disk.losses, time) for disk in case.disks)
    rotor = _lost(case.rotor, getattr(case.rotor, "losses", ()), time)
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
    own: Losses = getattr(case.given_rotor, "losses", ())
    named = [(disk.name or str(number), disk.losses) for number, disk in enumerate(case.disks, start=1)]
    return ((name, loss) for name, losses in (("", own), *named) for loss in losses)


def _lost(part: Unbalanced, losses: Losses, time: float) -> Unbalanced:
    """A rotor or a disk with its losses until a time in s from the beginning on."""
    if not any(loss.time <= time for loss in losses):
        return part
    joined = tuple(altered(loss, {"time": 0.0}) if loss.time <= time else loss for loss in losses)
    return altered(part, {"losses": joined})


def _film_at(film: FilmGeometry, time: float) -> FilmGeometry:
    passed = [step.clearance for step in film.clearance_steps if step.time <= time]
    return altered(film, {"given_clearance": passed[-1], "clearance_steps": ()}) if passed else film


AXIAL_LOAD = "axial.load"


def input_times(case: Case) -> Sequence[float]:
    """The times in s of all rows of the inputs of a case."""
    return sorted({time for each in inputs_of(case) for time in each.values.time})


def input_faults(case: Case, begin: float, end: float) -> Iterator[Fault]:
    """The faults of inputs over time that do not last from begin to end of a run, in s."""
    for each in inputs_of(case):
        yield from span_faults(each.key, each.values.source, each.values.time, begin, end)


def input_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """What the plan says of inputs over time: choice, value, reason."""
    for each in inputs_of(case):
        if each.key == AXIAL_LOAD:  # shown in the line of the thrust bearing
            continue
        x, time = each.values.x, each.values.time
        value = f"{each.key}: {display(min(x), each.unit)} to {display(max(x), each.unit)}"
        span = f"{each.values.origin}, {time[0]:g} to {time[-1]:g} s"
        yield "input", value, f"{span}; runs follow it, all other analyses have the largest value"


def drive_decisions(case: Case) -> Iterator[tuple[str, str, str]]:
    """What the plan says of a speed that is free: choice, value, reason."""
    drive, words = case.drive, case.speed_unit.words
    if drive is None:
        return
    reaction = "with" if drive.reaction else "without"
    turns = f"J = {1e6 * case.polar_inertia:.4g} kg*mm^2, from {words(drive.start)} on"
    yield "speed", "free", f"{turns}; {reaction} the reaction of the unbalance"
    if drive.points is not None:
        low, high = (display(limit(drive.points.torque), "N*m") for limit in (min, max))
        first, last = drive.points.at[0], drive.points.at[-1]
        span = case.speed_unit.span(first, last) if drive.points.over == "speed" else f"{first:g} to {last:g} s"
        points = f"{len(drive.points.at)} points over the {drive.points.over}"
        yield "drive", f"{low} to {high}", f"{points}, {span}, constant beyond"
    else:
        value = display(drive.torque, "N*m") if drive.torque else "no torque"
        yield "drive", value, f"for {display(drive.duration, 's')}" if drive.torque else "the rotor runs down"
    powers = {"N*m": drive.load.constant, "N*m*s": drive.load.linear, "N*m*s^2": drive.load.square}
    load = " + ".join(display(size, unit) for unit, size in powers.items() if size)
    if load:
        yield "load", load, "brakes the rotor; times powers of its speed in rad/s"
    if drive.end is not None:
        yield "governor", words(drive.end), "takes the torque away below this speed"
    reason = "the most that is expected, without friction of films"
    yield "top speed", words(max(case.speed.start, case.speed.end)), reason
