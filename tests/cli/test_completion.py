"""What a shell completes: the words that click gives it, as bash, zsh and fish ask for them."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from click.shell_completion import ShellComplete

from frbcli.cli.main import COMMANDS, frb
from frbcli.cli.process import main


def completed(*words: str) -> list[str]:
    """What follows the words of a line; the last one is the one that is being written."""
    asked = ShellComplete(frb, {}, "frb", "_FRB_COMPLETE")
    return [item.value for item in asked.get_completions(list(words[:-1]), words[-1])]


def test_commands_and_options() -> None:
    assert set(COMMANDS) <= set(completed(""))
    assert completed("wat") == ["waterfall"]
    assert "--clearance" in completed("waterfall", "--cl")
    assert "--set" in completed("runup", "--s")
    assert completed("plot", "--what", "orb") == ["orbit"]


@pytest.mark.parametrize("command", ["check", "runup", "stability", "sweep", "bearing"])
def test_shipped_cases_and_files(command: str) -> None:
    found = completed(command, "floating-r")
    assert "floating-ring" in found
    assert found[-1] == "floating-r"  # stands for the files of the folder
    assert "jeffcott" not in found


def test_keys_of_the_case_on_the_line() -> None:
    found = completed("check", "floating-ring", "--set", "bearing.ring.")
    assert "bearing.ring.mass=" in found
    assert all(key.startswith("bearing.ring.") for key in found)
    assert completed("check", "--set", "oil.vi") == ["oil.viscosity="]
    assert completed("check", "no-such-case", "--set", "oil.vi") == ["oil.viscosity="]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_is_given_its_script(shell: str) -> None:
    code = f"import sys; sys.argv = ['frb']; from {main.__module__} import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "_FRB_COMPLETE": f"{shell}_source"}, capture_output=True,
        text=True, check=False,
    )  # fmt: skip
    assert "_FRB_COMPLETE" in done.stdout, done.stderr
