"""Advice at the end of a run: what happened, the cause if known, and remedies.

Advice follows from the end of the run and from the case; settings that the case already has are not advised.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from frbcli.analysis.signals import films, joined, piece
from frbcli.case.schema import Case
from frbcli.elements.thrust import COLLAR
from frbcli.results.records import WHOLE
from frbcli.results.store import Run
from frbcli.runs.header import forcing
from frbcli.runs.heat import hot_film
from frbcli.runs.interruption import number_of
from frbcli.runs.march import UNBOUNDED
from frbcli.scene.changes import case_at, step_times
from frbcli.scene.coupling import coupling_of
from frbcli.scene.films import film_places
from frbcli.scene.planning.cell_choice import expected_eccentricity, gap_ratio
from frbcli.scene.planning.film_choice import choose_films, form_of
from frbcli.scene.supply import film_remedies, remedies_sentence, unfed_films
from frbcli.solve.state import STEP
from frbcli.solve.step import SMALLEST_STEP
from frbcli.units import display

THIN = 0.99  # eccentricity above which the cause of a film without solution is its small gap
AT_ONCE = 1e-9  # s within which a run ends at a step of the clearance
SHORTER = 10.0  # divisor of a macro step
STIFFNESS = "1e9 N/m"  # suggested contact stiffness
CLOSER = 1.5  # expected smallest gap over the gap that was reached, from which on both are reported
FINER, SMALLER = 4.0, 0.7  # divisor of the target; error of the cells, if that is worth it


@dataclass(frozen=True)
class RunEnd:
    """The end of a run: speed in Hz; film: the name of that with the largest eccentricity, which is given; step: the
    last one in s that was tried, None if not known; whirl: the latest onset in it, an event of the run, or None;
    hot_film: the name of a film that became too hot; on_pads: whether a collar touched its pads; grown: the largest
    displacement over the length of a machine without films, 0 with films."""

    status: str
    t_s: float
    speed_Hz: float
    film: str
    eccentricity: float
    step_s: float | None
    whirl: dict[str, Any] | None
    hot_film: str = ""
    on_pads: bool = False
    grown: float = 0.0

    @property
    def journal(self) -> str:
        """The journal of the film in a sentence; of an outer film that is the ring."""
        return f"journal in the film {self.film}" if self.film else "journal"


def run_end(run: Run) -> RunEnd:
    """How a run ended, from its last sample, its events and its state. Raises RunFileError for a state that is none."""
    last = {name: float(run[joined("eccentricity", name)][-1]) for name in films(run.signals) if len(run)}
    film = max(last, key=last.__getitem__, default="")
    whirls = [event for event in run.events if event["kind"] in ("onset", "offset") and event["film"] in (film, None)]
    return RunEnd(
        status=run.status,
        t_s=run.t_end_s,
        speed_Hz=float(run["speed_Hz"][-1]) if len(run) else 0.0,
        film=film,
        eccentricity=last.get(film, 0.0),
        step_s=number_of(run, "numbers", STEP),
        whirl=whirls[-1] if whirls and whirls[-1]["kind"] == "onset" else None,
        hot_film=hot_film(run),
        on_pads=any(event["kind"] == "contact" and event.get("point") == COLLAR for event in run.events),
        grown=_grown(run),
    )


def _grown(run: Run) -> float:
    """The largest displacement in the last sample over the length of a machine without films, 0 with films."""
    length, end = run.references.get("length_m"), len(run)
    if not length or not end:
        return 0.0
    places = (name for name in run.signals if name.endswith(("_x_m", "_y_m")))
    return max((abs(float(piece(run, name, end - 1, end)[0])) for name in places), default=0.0) / length


def run_advice(case: Case, end: RunEnd) -> tuple[str, ...]:
    """Sentences on the end of a run of a case; may be none."""
    if end.status == "interrupted":
        return ("Go on with the same command and --resume.",)
    if end.status == "starved":
        return _starved(case)
    if end.status == "overheated":
        return _overheated(case, end)
    if end.status == "contact":
        return _contact(case, end)
    if end.status in WHOLE:
        return tuple(film.remark for film in unfed_films(case) if not film.keeps)
    return _stuck(case, end)


def accuracy_advice(case: Case, run: Run) -> tuple[str, ...]:
    """A sentence on a run on cells whose journal came nearer to its shell, before a whirl, than the plan was made for,
    and which states an error above the target; may be none."""
    if not form_of(case).by_cells or case.accuracy.mesh is not None:
        return ()
    expected, stated, until = expected_eccentricity(case), run.error.get("eccentricity"), run.error.get("quiet_until_s")
    if expected is None or stated is None or until is None or stated <= case.accuracy.target:
        return ()
    quiet = int(np.searchsorted(run["time_s"], until, side="right"))
    reached = max(float(np.max(run[joined("eccentricity", name)][:quiet], initial=0.0)) for name in films(run.signals))
    if gap_ratio(expected, reached) < CLOSER:
        return ()
    target = case.accuracy.target
    sentence = (
        f"The eccentricity reached {reached:.2f} where the plan expected {expected:.2f}: the error of up to "
        f"{stated:.1e} may be above the target of {target:g}."
    )
    finer = target / FINER
    helps = choose_films(case, finer).error <= SMALLER * choose_films(case, target).error
    return (f"{sentence} For less, accuracy.target = {finer:g}." if helps else sentence,)


def forced_advice(case: Case) -> tuple[str, ...]:
    """A sentence on tables over time that shake a machine without distinct frequencies; may be none."""
    names = forcing(case)[1]
    sentence = f"The motion that {' and '.join(names)} force is not separated from whirl in the events"
    return (f"{sentence}: the table changes with no distinct frequencies.",) if names else ()


def _starved(case: Case) -> tuple[str, ...]:
    """A mass-conserving film without a pressurised supply has lost its load."""
    sentences = []
    for film in unfed_films(case):
        if film.keeps:
            name = f"The film {film.name}" if film.name else "The film"
            sentences.append(f"{name} starved: {film.cause}, so that more oil left than flowed in. {film.remedy}")
    return tuple(sentences)


def _overheated(case: Case, end: RunEnd) -> tuple[str, ...]:
    """A film that became too hot, or whose gap heat has closed."""
    thermal = case.heat
    limit = "" if thermal is None else f" ({display(thermal.hottest_film, 'K')}, thermal.hottest_film)"
    follows = thermal is not None and thermal.clearance == "follows"
    gap = ", or heat closed its gap" if follows else ""
    film = "the film" if end.hot_film == "film" else f"the film {end.hot_film}"
    return (
        f"At {case.speed_unit.words(end.speed_Hz)} the oil in {film} became too hot{limit}{gap}{_while(end)}. "
        "Give it more flow, a cooler supply, more clearance, or a wall that takes heat.",
    )


def _contact(case: Case, end: RunEnd) -> tuple[str, ...]:
    if closed := _closed_shell(case, end):
        return (closed,)
    if end.on_pads:
        at = case.speed_unit.words(end.speed_Hz)
        touched = f"The collar of the thrust bearing touched its pads at {at}{_while(end)}"
        return (f"{touched}: its tilt and the axial load left less than the roughness of surfaces.",)
    limit = f"contact.eccentricity = {case.contact.eccentricity:g}"
    touched = f"The {end.journal} reached the shell at {case.speed_unit.words(end.speed_Hz)} ({limit})"
    through = () if case.contact.gives_way else (_through_contact(case),)
    return (f"{touched}{_before(end)}.", *_missing_oil(case), *through)


def _closed_shell(case: Case, end: RunEnd) -> str:
    """The sentence on a clearance step below the displacement of the journal, else empty."""
    if not any(abs(time - end.t_s) <= AT_ONCE for time in step_times(case)):
        return ""
    names = [
        f"{place.name} to {display(step.clearance, 'm')}".strip()
        for place in film_places(case)
        for step in place.geometry.clearance_steps
        if abs(step.time - end.t_s) <= AT_ONCE
    ]
    return (
        f"The step of the clearance {', '.join(names)} at {end.t_s:g} s is below the displacement of the journal. "
        "Take a larger clearance, or a time with a smaller eccentricity."
    )


def _before(end: RunEnd) -> str:
    """The motion before the contact."""
    if end.whirl is None:
        return "; there was no whirl before: the film could not carry weight and unbalance"
    frequency, begun = end.whirl["frequency_Hz"], f"since {end.whirl['t_s']:.3f} s"
    return f", whirling {begun}" + ("" if frequency is None else f" with about {frequency:.3g} Hz")


def _through_contact(case: Case) -> str:
    stiffness = "" if case.contact.stiffness is not None else f" --set contact.stiffness='{STIFFNESS}'"
    return f"To continue through contact: --set contact.policy=elastic{stiffness}."


def _missing_oil(case: Case) -> tuple[str, ...]:
    """Films without a pressurised supply, a frequent cause."""
    return tuple(film.remark for film in unfed_films(case))


def _stuck(case: Case, end: RunEnd) -> tuple[str, ...]:
    """Sentences on a run whose equations had no solution with the smallest step size, or without films had no bound."""
    speed = case.speed_unit.words(end.speed_Hz)
    if not case.films and end.grown > math.sqrt(UNBOUNDED):  # in the last sample, before the step that was beyond
        grown = f"The motion grew beyond {UNBOUNDED:.0e} times the length of the plan at {speed}"
        return (f"{grown}: given coefficients do not bound it. `frb stability` shows the speed from which one grows.",)
    step = f"{SMALLEST_STEP:.0e} s" if end.step_s is None or end.step_s < SMALLEST_STEP else f"{end.step_s:.1e} s"
    if not case.films:
        return (f"The rotor had no solution at {speed} with a step size below {step}.",)
    touching = end.eccentricity >= case.contact.eccentricity
    place = "in contact with the shell" if touching else "not in contact"
    sentence = (
        f"Rotor and films had no solution at {speed} with a step size below {step}: the "
        f"{end.journal} was {place}, at an eccentricity of {end.eccentricity:.4f}{_while(end)}."
    )
    remedies = (*_contact_remedies(case, end, touching), *_numerics(case), *film_remedies(case))
    return (sentence, *_missing_oil(case), *_thin_film(case, end, touching), remedies_sentence(remedies))


def _while(end: RunEnd) -> str:
    return "" if end.whirl is None else f", whirling since {end.whirl['t_s']:.3f} s"


def _thin_film(case: Case, end: RunEnd, touching: bool) -> tuple[str, ...]:
    """The gap of a journal close to contact."""
    if touching or end.eccentricity < THIN:
        return ()
    gap = (1.0 - end.eccentricity) * _clearance(case_at(case, end.t_s), end.film)
    return (f"The smallest gap is {1e6 * gap:.2g} um, and the stiffness of the film is very large there.",)


def _contact_remedies(case: Case, end: RunEnd, touching: bool) -> tuple[str, ...]:
    """How a run ends in contact instead of being stuck in it or close to it."""
    remedies = []
    if not touching and end.eccentricity >= THIN:
        remedies.append(f"contact.eccentricity = {THIN:g}, with which contact begins earlier")
    if case.contact.policy == "elastic":
        remedies.append("contact.policy = stop, with which the run ends at its first contact")
    return tuple(remedies)


def _clearance(case: Case, film: str) -> float:
    return next((place.geometry.clearance for place in film_places(case) if place.name == film), 0.0)


def _numerics(case: Case) -> tuple[str, ...]:
    """Settings of the time integration that may help. The tolerance does not: steps of 1e-12 s have no error, and what
    has no solution with one tolerance has none with a smaller one."""
    if not coupling_of(case).in_turn:
        return ()
    smaller = display(case.accuracy.macro_step / SHORTER, "s")
    return (f"accuracy.macro_step = {smaller}, or film.coupling = auto",)
