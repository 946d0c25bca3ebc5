"""Pairs of nasty values in every command that takes a case: each is done, refused, or ended early with a reason."""

import json
from pathlib import Path

import nasty_pairs
import pytest
from nights import printed, seeds_tonight

from frbcli.case.reading.load import load_case
from frbcli.cli.main import COMMANDS
from frbcli.errors import InputError
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import BEARING, CYCLES, ROTATION, RUN, STABILITY, WHIRL
from frbcli.scene.planning.plan import make_plan

PAIRS, INPUTS, NIGHTS = 384, 48, 8  # two in a night to each command, one to each, and of surfaces one
SURFACES = 200  # cases with nasty values of contact, free gas, limited flow and baths
SEEDS = range(nasty_pairs.SURFACES, nasty_pairs.SURFACES + SURFACES)
ELEMENTS = range(nasty_pairs.ELEMENTS, nasty_pairs.ELEMENTS + SURFACES)
ANALYSES = RUN, ROTATION, WHIRL, BEARING, STABILITY, CYCLES


def tried(folder: Path, seeds: range) -> None:
    lines = printed(nasty_pairs.__file__, str(folder), *map(str, seeds), limited=True)
    results = [json.loads(line) for line in lines]
    assert [result["seed"] for result in results] == list(seeds)
    bad = [result for result in results if result["bad"]]
    assert not bad, "\n\n".join(f"{result['words']}\n{result['bad']}" for result in bad)
    assert len({result["code"] for result in results}) > 1  # neither harmless nor hopeless


def test_every_command_that_takes_a_case_is_tried() -> None:
    of_cases = set(COMMANDS) - {"balance", "waterfall", "report", "export", "cases", "schema", "docs"}
    assert {command[0] for command in nasty_pairs.COMMANDS} == of_cases
    assert PAIRS // NIGHTS % len(nasty_pairs.COMMANDS) == 0


@pytest.mark.nightly
@pytest.mark.parametrize("first", [0, nasty_pairs.ELEMENTS])
def test_two_nasty_values_break_no_command(first: int, tmp_path: Path) -> None:
    tried(tmp_path, seeds_tonight(range(first, first + PAIRS), NIGHTS))


@pytest.mark.nightly
def test_an_input_over_time_and_a_nasty_value_break_no_command(tmp_path: Path) -> None:
    """Pressures, temperatures, speeds, forces and motions of the ground: points and files, good and bad ones."""
    first = nasty_pairs.OVER_TIME
    tried(tmp_path, seeds_tonight(range(first, first + INPUTS), INPUTS // len(nasty_pairs.COMMANDS)))


def refused(seed: int) -> InputError | None:
    """Why the case of a seed is refused; None if it is planned. Any other exception passes, and is a bug."""
    _, source, settings = nasty_pairs.trial(seed)
    try:
        case = load_case(source, settings)
        require(case, ANALYSES[seed % len(ANALYSES)])
        make_plan(case)
    except InputError as error:
        return error
    return None


@pytest.mark.parametrize("seeds", [SEEDS, ELEMENTS], ids=["surfaces", "elements"])
def test_nasty_surfaces_gas_and_elements_are_refused_or_planned(seeds: range) -> None:
    """With key, problem and remedy, before a film is made."""
    vague, planned = [], 0
    for seed in seeds:
        try:
            error = refused(seed)
        except Exception as bug:
            bug.add_note(f"seed {seed}: {nasty_pairs.trial(seed)}")
            raise
        planned += error is None
        for fault in () if error is None else error.faults:
            if not (fault.key and fault.problem and fault.remedy):
                vague.append((nasty_pairs.trial(seed), str(fault)))
    assert not vague
    assert 0.2 < planned / SURFACES < 0.8  # neither harmless nor hopeless


@pytest.mark.nightly
def test_nasty_surfaces_and_gas_break_no_command(tmp_path: Path) -> None:
    tried(tmp_path, seeds_tonight(SEEDS, NIGHTS))
