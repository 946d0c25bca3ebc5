"""How a run begins, how exact it is, and what it keeps."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from frbcli.case.model import Count, Displacement, Duration, Hold, Model, Quantity
from frbcli.units import NUMBER

OUTPUT_STEP = 5e-5  # resolves 10 kHz
STEPS_PER_REVOLUTION = 40
MACRO_STEP = 1e-6  # table 6.2
MOST_FRAMES = 200  # of films that a run keeps

FilmSignal = Literal["force", "film-thickness", "power", "torque", "oil-flow"]


class Start(Model):
    """Position of the journal at the start of a run."""

    position: Literal["centre", "resting"] = Field(
        default="centre", description="in the middle of the bearings, or in static equilibrium at the first speed"
    )
    displacement: tuple[Displacement, Displacement] | None = Field(default=None, description="x, y over clearance")


class Accuracy(Model):
    """Accuracy of the result: one target, or mesh and tolerance."""

    target: Annotated[float, Quantity(NUMBER, "1e-3", above=0, most=0.1)] = Field(
        default=1e-3, description="error of the eccentricities that is aimed at"
    )
    budget: Annotated[float, Quantity("s", "60 s", above=0)] | None = Field(
        default=None, description="CPU time of a run-up, if the target needs more: the most exact plan within it"
    )
    mesh: tuple[Annotated[int, Count(1, 400, 10)], Annotated[int, Count(4, 2000, 20)]] | None = Field(
        default=None, description="elements along the axis, then around the circumference, where there are no fewer"
    )
    tolerance: Annotated[float, Quantity(NUMBER, "1e-6", above=0, most=0.1)] | None = Field(
        default=None, description="of the time integration, relative to the clearance"
    )
    steps_per_revolution: Annotated[int, Count(1, 100_000, 40)] = Field(
        default=STEPS_PER_REVOLUTION, description="at least; finite-volume films take fewer by default"
    )
    macro_step: Annotated[float, Quantity("s", "1e-6 s", above=0)] = Field(
        default=MACRO_STEP, description="longest macro step of a co-simulation"
    )


class FilmFrames(Model):
    """Oil fractions and free gas of all cells that a run keeps, for pictures of its films."""

    begin: Hold = Field(alias="from", description="time of the first ones")
    end: Duration = Field(alias="to", description="time of the last ones")
    frames: Annotated[int, Count(2, MOST_FRAMES, 80)] = Field(default=80, description="so many, at even times")


class Output(Model):
    """Output of a run."""

    step: Annotated[float, Quantity("s", "5e-5 s", above=0)] = Field(
        default=OUTPUT_STEP, description="between the samples of a run file"
    )
    signals: tuple[FilmSignal, ...] = Field(
        default=(),
        description="further signals of each film that a run records",
    )
    films: FilmFrames | None = Field(default=None, description="keep oil and gas of mass-conserving films")
