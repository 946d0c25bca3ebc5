"""How a run begins, how exact it is, and what it keeps."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from frbcli.case.model import Model
from frbcli.case.quantities import Count, Displacement, Duration, Hold, Quantity
from frbcli.units import NUMBER

OUTPUT_STEP = 5e-5  # resolves 10 kHz
STEPS_PER_REVOLUTION = 40
MACRO_STEP = 1e-6  # table 6.2
MOST_FRAMES = 200  # of films that a run keeps

FilmSignal = Literal["force", "film-thickness", "power", "torque", "oil-flow"]


class Start(Model):
    """Position of the journal at the start of a run."""

    position: Literal["centre", "resting"] = Field(
        default="centre", description="middle of the bearings, or static equilibrium at the first speed"
    )
    displacement: tuple[Displacement, Displacement] | None = Field(default=None, description="x, y over clearance")


class Accuracy(Model):
    """One target, or mesh and tolerance."""

    target: Annotated[float, Quantity(NUMBER, "1e-3", above=0, most=0.1)] = Field(
        default=1e-3, description="error of the eccentricities"
    )
    budget: Annotated[float, Quantity("s", "60 s", above=0)] | None = Field(
        default=None, description="CPU time of a run-up, if the target needs more: the most exact plan within it"
    )
    mesh: tuple[Annotated[int, Count(1, 400, 10)], Annotated[int, Count(4, 2000, 20)]] | None = Field(
        default=None, description="elements along the axis and, at least, around the circumference"
    )
    tolerance: Annotated[float, Quantity(NUMBER, "1e-6", above=0, most=0.1)] | None = Field(
        default=None, description="of the time integration, over clearance"
    )
    steps_per_revolution: Annotated[int, Count(1, 100_000, 40)] = Field(
        default=STEPS_PER_REVOLUTION, description="at least; finite-volume films take fewer by default"
    )
    macro_step: Annotated[float, Quantity("s", "1e-6 s", above=0)] = Field(
        default=MACRO_STEP, description="longest, of a co-simulation"
    )


class FilmFrames(Model):
    """Recorded oil fractions and free gas of all cells, for pictures."""

    begin: Hold = Field(alias="from", description="first and last time")
    end: Duration = Field(alias="to", description="first and last time")
    frames: Annotated[int, Count(2, MOST_FRAMES, 80)] = Field(default=80, description="number, at even times")


class Output(Model):
    """Output of a run."""

    step: Annotated[float, Quantity("s", "5e-5 s", above=0)] = Field(
        default=OUTPUT_STEP, description="between samples"
    )
    signals: tuple[FilmSignal, ...] = Field(
        default=(),
        description="further signals of each film",
    )
    films: FilmFrames | None = Field(default=None, description="record oil and gas of mass-conserving films")
