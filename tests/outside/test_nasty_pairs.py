"""Pairs of nasty values in every command that takes a case: each is done, refused, or ended early with a reason."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import nasty_pairs
import pytest
from paths import ROOT

from frbcli.cli.main import COMMANDS

BATCH, BATCHES = 48, 8
BATCH_s = 1800.0
MEMORY = 4 * 1024**3


def limited() -> None:
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))


def tried(folder: Path, seeds: range) -> None:
    worker = Path(nasty_pairs.__file__)
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-W", "error", str(worker), str(folder), *map(str, seeds)], capture_output=True, text=True,
        timeout=BATCH_s, check=False, preexec_fn=limited, env=os.environ | {"PYTHONPATH": path, "MPLBACKEND": "Agg"},
    )  # fmt: skip
    results = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0, f"after {results[-1:]}: {done.returncode}\n{done.stderr[-3000:]}"
    assert [result["seed"] for result in results] == list(seeds)
    bad = [result for result in results if result["bad"]]
    assert not bad, "\n\n".join(f"{result['words']}\n{result['bad']}" for result in bad)
    assert len({result["code"] for result in results}) > 1  # neither harmless nor hopeless


def test_every_command_that_takes_a_case_is_tried() -> None:
    of_cases = set(COMMANDS) - {"waterfall", "report", "export", "cases", "schema"}
    assert {command[0] for command in nasty_pairs.COMMANDS} == of_cases
    assert BATCH % len(nasty_pairs.COMMANDS) == 0


@pytest.mark.nightly
@pytest.mark.parametrize("batch", range(BATCHES))
def test_two_nasty_values_break_no_command(batch: int, tmp_path: Path) -> None:
    tried(tmp_path, range(batch * BATCH, (batch + 1) * BATCH))


@pytest.mark.nightly
def test_an_input_over_time_and_a_nasty_value_break_no_command(tmp_path: Path) -> None:
    """Pressures, temperatures, speeds, forces and motions of the ground: points and files, good and bad ones."""
    tried(tmp_path, range(nasty_pairs.OVER_TIME, nasty_pairs.OVER_TIME + BATCH))
