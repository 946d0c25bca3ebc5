"""The remedy for a name that is not known."""

import pytest

from frbcli.errors import InputError, did_you_mean, nearest
from frbcli.results.records import Signal
from frbcli.results.store import Run

POINTS = ("journal_front", "journal_rear", "disk_turbine", "disk_compressor")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("compressor", ("disk_compressor",)),
        ("compresor", ("disk_compressor",)),
        ("journal_frnt", ("journal_front",)),
        ("journal_", ("journal_rear", "journal_front")),
        ("pressure", ()),
        ("", ()),
        (" ", ()),
    ],
)
def test_the_nearest_names(name: str, found: tuple[str, ...]) -> None:
    assert nearest(name, POINTS) == found


def test_few_names_are_listed_whole_and_many_by_their_command() -> None:
    assert did_you_mean("q", ["a", "b"]) == "There are: a, b."
    many = [f"signal_{k}" for k in range(46)]
    assert did_you_mean("q", many, "`frb cases` lists them.") == "`frb cases` lists them."
    assert did_you_mean("q", many).endswith("signal_11 and 34 more.")
    assert did_you_mean("signal_7x", many) == 'Did you mean "signal_7", "signal_17" or "signal_27"?'
    assert did_you_mean("q", []) == ""


def run_with(names: tuple[str, ...]) -> Run:
    import numpy as np

    samples = np.zeros(8)
    signals = {"time_s": Signal(np.arange(8.0), "s"), "speed_Hz": Signal(samples, "Hz")}
    signals |= {f"{name}_{axis}_m": Signal(samples, "m") for name in names for axis in "xy"}
    return Run(
        path="run.h5", title="", command="runup", case_name="", case_text="", versions={}, signals=signals,  # type: ignore[arg-type]
        status="finished", t_end_s=7.0, events=[], cost={}, error={}, references={}, checkpoint=None,
    )  # fmt: skip


def test_a_point_is_found_by_its_name_alone() -> None:
    from frbcli.analysis.signals import located, point_of

    run = run_with(POINTS)
    assert point_of(run, "compressor") == "disk_compressor"
    assert located(run, "front") == ("journal", "front")
    assert point_of(run, "journal") == "journal_front"
    with pytest.raises(InputError, match='Did you mean "disk_compressor"'):
        point_of(run, "compresor")
    assert point_of(run_with((*POINTS, "ring_front")), "front") == "journal_front"
    both = run_with(("journal_1", "disk_1"))
    with pytest.raises(InputError, match="There are: journal_1, disk_1"):
        point_of(both, "1")
    with pytest.raises(InputError, match='no signal "force"'):
        run["force"]
