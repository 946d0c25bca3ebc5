"""Options that several commands have are one option, with the unit of speeds; the example in each help can be called;
what a shell completes; what a process of `frb` imports."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import get_args

import click
import numpy as np
import pytest
from click.shell_completion import ShellComplete
from click.testing import CliRunner
from commands import Frb

from frbcli.case.film import THEORIES, Coupling
from frbcli.case.reading.load import load_case
from frbcli.cli.main import COMMANDS, GROUPS, command_named
from frbcli.cli.main import frb as group
from frbcli.cli.options import UnitOption
from frbcli.cli.process import main
from frbcli.film.cavitation.table import names as cavitations
from frbcli.scene.planning.kinematic_plan import TESTS
from frbcli.units import SpeedUnit

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
def test_errors_have_one_form(words: list[str], frb: Frb) -> None:
    """Subject, then a line for each fault: what it is of, what is wrong, what to do."""
    said = frb(*words, code=2)
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
    told = CliRunner().invoke(group, ["--help"]).output
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
    asked = ShellComplete(group, {}, "frb", "_FRB_COMPLETE")
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


def test_an_option_of_other_commands_leads_there(frb: Frb) -> None:
    said = frb("limit-cycles", "jeffcott", "--over", "oil.viscosity='8..14 mPa*s'", code=2)
    assert "`frb limit-cycles --parameter`" in " ".join(said.err.split())


@pytest.mark.parametrize("words", [["response", "seal", "--map"], ["stability", "seal", "-o", "a.png"]])
def test_a_picture_that_is_asked_for_is_not_left_out(words: list[str], frb: Frb) -> None:
    assert "names the picture that --no-picture leaves out" in frb(*words, "--no-picture", code=2).err


PER_MINUTE = ("--set", "speed.to=18000 rpm")
HERTZ = ("--set", "speed.to=300 Hz")
# the command, with how its text names a speed in rpm
SPOKEN: dict[str, tuple[tuple[str, ...], str]] = {
    "stability": (("stability", "jeffcott", "--threshold", "--no-picture"), r"above 10632 rpm the rotor whirls"),
    "bearing": (("bearing", "jeffcott", "--no-picture"), r"rpm: rotor speed;"),
    "balls": (("bearing", "turbocharger-ball", "--load", "60 N", "--no-picture"), r"rpm: rotor speed;"),
    "thrust": (("thrust", "turbocharger-car-thrust", "--no-picture"), r"rpm: rotor speed;"),
    "runup": (("runup", "jeffcott", "--no-picture", "--set", "speed.duration=2 s", "-o", "run.h5", "--force"),
              r"speed, rpm"),
}  # fmt: skip


@pytest.mark.parametrize("name", list(SPOKEN))
def test_text_is_in_the_unit_of_the_case_and_json_in_hertz(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    monkeypatch.chdir(tmp_path)
    words, told = SPOKEN[name]
    documents = {}
    for unit, settings in (("rpm", PER_MINUTE), ("Hz", HERTZ)):
        text = " ".join(frb(*words, *settings).out.split())
        assert (re.search(told, text) is not None) == (unit == "rpm"), text
        documents[unit] = without_times(frb(*words, *settings, "--json", "--quiet").document)
    assert documents["rpm"] == documents["Hz"]


def without_times(document: object) -> object:
    """A document without what follows the clock."""
    if isinstance(document, dict):
        return {key: without_times(value) for key, value in document.items() if key not in ("cost", "resumes")}
    return [without_times(value) for value in document] if isinstance(document, list) else document


def test_an_option_in_rpm_turns_the_text_to_rpm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb) -> None:
    monkeypatch.chdir(tmp_path)
    for asked in (("--speed", "3000 rpm"), ("--speed", "50 Hz", "--rpm")):
        said = frb("stability", "jeffcott", "--no-picture", *asked).out
        assert re.search(r"^ +rpm ", said, re.MULTILINE)
        assert re.search(r"^ +3000 ", said, re.MULTILINE)


@pytest.mark.parametrize(
    ("settings", "per_minute"),
    [(("speed.to=3000 r/min",), True), (("speed.to=3 krpm",), True), (("speed.to=300 rad/s",), False), ((), False),
     ((r'speed={points=[["0 s", "0 rpm"], ["1 s", "900 rpm"]]}',), True), (("speed.duration=1 min",), False),
     (('motion={eccentricity=0.5, speed="600 rpm"}',), True), (('motion={eccentricity=0.5, speed="6 Hz"}',), False)],
)  # fmt: skip
def test_unit_of_a_case(settings: tuple[str, ...], per_minute: bool) -> None:
    assert load_case("jeffcott", settings).speed_unit.rpm is per_minute


def test_speeds_in_words() -> None:
    hertz, per_minute, both = SpeedUnit(), SpeedUnit(rpm=True), SpeedUnit(both=True)
    assert (hertz.words(177.2), per_minute.words(177.2)) == ("177.2 Hz", "10632 rpm")
    assert (hertz.number(0.5), per_minute.number(0.5)) == ("0.5", "30")
    assert (hertz.cell(204.43, 1.8), per_minute.cell(204.43, 1.8)) == ("204.4(18)", "12266(108)")
    assert both.words(200.0) == "200.0 Hz, 12000 rpm"
    assert per_minute.span(10.0, 20.0) == "600 to 1200 rpm"
    assert per_minute.cell(None) == "-"


def test_a_measurement_with_speeds_per_minute_is_shown_in_them(tmp_path: Path, frb: Frb) -> None:
    time = np.arange(20_000) * 2.5e-4
    speed = 600.0 + 3000.0 * time
    angle = np.cumsum(speed / 60.0) * 2.5e-4 * 2.0 * np.pi
    whirl = np.where(time > 3.0, 15.0, 0.0)
    x, y = (3.0 * of(angle) + whirl * of(0.48 * angle) for of in (np.cos, np.sin))
    file = tmp_path / "measured.csv"
    np.savetxt(file, np.c_[time, speed, x, y], delimiter=",", header="time_s,speed_rpm,x_um,y_um", comments="")
    words = ["waterfall", str(file), "--x", "x_um", "--y", "y_um", "--time", "time_s", "--speed-column", "speed_rpm"]
    assert "speed, rpm" in frb(*words, "--clearance", "30 um", "-o", str(tmp_path / "w.svg")).out
    assert "rotor speed in rpm" in (tmp_path / "w.svg").read_text(encoding="utf-8")
    frb(*words, "--linear", "-o", str(tmp_path / "linear.svg"))  # amplitudes refer to no clearance


# A command as the console script calls it, and which of some libraries it has imported
SCRIPT = """
import sys
from frbcli.cli.process import main
sys.argv = ["frb", *sys.argv[1:]]
try:
    main()
except SystemExit as ended:
    assert not ended.code, ended.code
heavy = {"scipy.linalg", "scipy.special", "scipy.sparse", "scipy.optimize", "matplotlib", "pandas", "pint", "rich"}
heavy |= {"numba.np.arraymath", "numba.np.linalg"}  # among what numba needs to compile
print(*sorted(heavy & set(sys.modules)))
"""
# In such a process, how matplotlib tells a class of its own to take its properties, and a picture
DRAWS = """
import sys
from frbcli.cli.process import prepare_libraries
if sys.argv[1] == "prepared":
    prepare_libraries()
import matplotlib.artist
from frbcli.plot.style import new_figure, save_figure
figure = new_figure("title", "subtitle")
axes = figure.subplots()
axes.plot([0.0, 1.0], [0.0, 2.0], label="line")
axes.legend().set(visible=True)
axes.set(xlabel="x", xlim=(0.0, 1.0))
save_figure(figure, sys.argv[1] + ".png")
print(len(axes.set.__doc__ or ""))
"""
RUN = ("runup", "jeffcott", "--set", "speed.duration=0.05 s", "--force", "--quiet", "--no-picture", "-o", "x.h5")


def python(place: Path, *words: str) -> str:
    return subprocess.run([sys.executable, *words], cwd=place, capture_output=True, text=True, check=True).stdout


def test_a_run_whose_tables_are_kept_imports_no_library_that_it_does_not_use(tmp_path: Path) -> None:
    """The first run may make tables and modes of the film, which need scipy; the second finds them on the disk."""
    python(tmp_path, "-c", SCRIPT, *RUN)
    assert python(tmp_path, "-c", SCRIPT, *RUN).split() == []


def test_matplotlib_draws_the_same_without_the_docstrings_of_its_classes(tmp_path: Path) -> None:
    assert int(python(tmp_path, "-c", DRAWS, "plain")) > 0
    assert int(python(tmp_path, "-c", DRAWS, "prepared")) == 0
    assert (tmp_path / "prepared.png").read_bytes() == (tmp_path / "plain.png").read_bytes()
