"""Options that several commands have are one option; the example in each help can be called; what a shell completes."""

import os
import re
import shlex
import subprocess
import sys
from typing import get_args

import click
import pytest
from click.shell_completion import ShellComplete
from click.testing import CliRunner

from frbcli.case.film import THEORIES, Coupling
from frbcli.cli.main import COMMANDS, GROUPS, command_named, frb, run
from frbcli.cli.options import UnitOption
from frbcli.cli.process import main
from frbcli.film.cavitation.table import names as cavitations
from frbcli.scene.planning.kinematic_plan import TESTS

SHARED = ("--set", "--json", "--quiet", "--csv", "--picture", "--size", "--dpi", "--xlim", "--ylim", "--rpm",
          "--signal", "--cavitation", "--theory", "--coupling", "--format", "--speed", "--from", "--to", "--list",
          "--columns", "--force", "--jobs", "--points")  # fmt: skip
# Values of a grid; formats; of a law alone; the run in the run file is replaced, too; a case; of a cluster
OWN = {("sweep", "--set"), ("sweep", "--format"), ("plot", "--set"), ("cases", "--set"), ("runup", "--force"),
       ("rundown", "--force"), ("cases", "--force"), ("sweep", "--jobs")}  # fmt: skip


def options(name: str) -> dict[str, click.Option]:
    params = command_named(name).params
    return {opt: param for param in params if isinstance(param, click.Option) for opt in param.opts}


@pytest.mark.parametrize("option", SHARED)
def test_an_option_means_one_thing(option: str) -> None:
    found = {name: options(name)[option] for name in COMMANDS if option in options(name) and (name, option) not in OWN}
    assert found
    helps = {(each.help or "").partition(" [")[0] for each in found.values()}
    assert len(helps) == 1
    assert len({(type(each.type), each.metavar, tuple(each.opts)) for each in found.values()}) == 1


def test_an_axis_is_a_quantity_in_all_commands() -> None:
    given = {name: options(name).get("--over") for name in COMMANDS}
    axes = {name: option.type.to_info_dict()["choices"] for name, option in given.items() if option is not None}
    assert set(axes) == {"waterfall", "plot", "bearing"}
    assert set().union(*axes.values()) == {"time", "speed", "eccentricity"}


def test_choices_are_shown_and_defaults_have_one_style() -> None:
    for name in COMMANDS:
        for opt, param in options(name).items():
            assert "[" not in (param.help or "").replace("frbcli[", ""), (name, opt)  # click writes defaults
            assert param.metavar != "INTEGER RANGE", (name, opt)
    for opt, known in (("--cavitation", cavitations()), ("--theory", THEORIES), ("--coupling", get_args(Coupling)),
                       ("--thermal", ("none", "lumped"))):  # fmt: skip
        *_, listed = (options("compare")[opt].help or "").rstrip(".").partition(": ")
        assert sorted(listed.split(", ")) == sorted(known)
    assert options("compare")["--test"].type.to_info_dict()["choices"] == ("runup", "rundown", *TESTS)


@pytest.mark.parametrize("words", [
    ["waterfall", "--foo"], ["nothing"], ["plot"], ["runup", "jeffcott", "-o", "run.txt"], ["check", "nothing"],
    ["limit-cycles", "jeffcott", "--parameter", "speed"],
])  # fmt: skip
def test_errors_have_one_form(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Subject, then a line for each fault: what it is of, what is wrong, what to do."""
    assert run(words) == 2
    said = capsys.readouterr()
    subject, *faults = said.err.splitlines()
    assert said.out == ""
    assert re.fullmatch(r"frb: .+", subject)
    assert faults
    assert all(re.fullmatch(r"  [^:]+: .+[.?]", fault) for fault in faults), faults


@pytest.mark.parametrize("name", COMMANDS)
def test_the_example_of_a_command_can_be_called(name: str) -> None:
    program, command, *words = shlex.split(COMMANDS[name][2].partition(" > ")[0])
    assert (program, command) == ("frb", name)
    with command_named(name).make_context(f"frb {name}", words):
        pass
    assert COMMANDS[name][2] in command_named(name).get_help(click.Context(command_named(name)))


def test_the_help_shows_every_command_in_one_group() -> None:
    named = [name for names in GROUPS.values() for name in names]
    assert sorted(named) == sorted(COMMANDS)
    told = CliRunner().invoke(frb, ["--help"]).output
    places = [told.index(f"{group}:") for group in GROUPS]
    assert places == sorted(places)
    assert max(map(len, told.splitlines())) <= 80
    assert [told.index(f"\n  {name} ") for name in named] == sorted(told.index(f"\n  {name} ") for name in named)


@pytest.mark.parametrize(
    ("given", "metres"), [("um", 1e-6), ("m", 1.0), ("1 mm", 1e-3), ("125 um", 125e-6), (" in ", 0.0254)]
)
def test_a_unit_is_given_alone_or_as_a_multiple(given: str, metres: float) -> None:
    assert UnitOption("length", "m", "um")(given) == pytest.approx(metres, rel=1e-12)


@pytest.mark.parametrize("given", ["s", "nan", "inf", "parsnip", "", "-1 um"])
def test_what_is_no_unit_of_the_kind_is_refused(given: str) -> None:
    with pytest.raises(click.BadParameter):
        UnitOption("length", "m", "um")(given)


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


@pytest.mark.parametrize("command", ["check", "stability", ])
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


def test_an_option_of_other_commands_leads_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["limit-cycles", "jeffcott", "--over", "oil.viscosity='8..14 mPa*s'"]) == 2
    assert "`frb limit-cycles --parameter`" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize("words", [["response", "seal", "--map"], ["stability", "seal", "-o", "a.png"]])
def test_a_picture_that_is_asked_for_is_not_left_out(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*words, "--no-picture"]) == 2
    assert "names the picture that --no-picture leaves out" in capsys.readouterr().err
