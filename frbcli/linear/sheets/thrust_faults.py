"""Cases whose sheet of thrust bearings cannot be computed, each with its reason."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from frbcli.case.schema import Case
from frbcli.errors import Fault, InputError, input_error
from frbcli.film.pad_geometry import LAWS
from frbcli.units import display


def require_sheet(case: Case, gaps: Sequence[float] = ()) -> None:
    """Raises InputError with every reason why thrust bearings of a case have no sheet at some gaps in m."""
    if reasons := [*_faults(case), *_beyond_play(case, gaps)]:
        raise case.refused(*reasons)


def _faults(case: Case) -> Iterator[Fault]:
    if not case.thrust_bearings:
        yield Fault("thrust_bearing", "", None, "is missing.", "Add a table [[thrust_bearing]]; see docs/thrust.md.")
    if case.film.cavitation not in LAWS:
        problem = "is not modelled in thrust bearings, whose pressure is found without oil fractions and history."
        remedy = f"Write film.cavitation = {' or '.join(LAWS)}; in converging pads they agree."
        yield Fault("film.cavitation", case.film.cavitation, None, problem, remedy)


def _beyond_play(case: Case, gaps: Sequence[float]) -> Iterator[Fault]:
    for bearing in case.thrust_bearings:
        play = bearing.end_play
        for gap in gaps if bearing.side == "both" and play is not None else ():
            if play is not None and gap >= play:
                problem = f"leaves no gap on the other side: the end play is {display(play, 'm')}."
                yield Fault("--gap", display(gap, "m"), None, problem, "Give a gap below it, up to half for a load.")


def no_gap(load: float, problem: str) -> InputError:
    """The error of a load in N that no gap carries."""
    remedy = "Give another load, or change the pads, the oil or the speed."
    return input_error("case", "--load", f"{load:.6g} N", problem, remedy)
