"""frb check, schema, cases; and how errors leave the command line."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import click
import pytest
from commands import Frb

from frbcli.case.reading.load import load_case
from frbcli.case.reading.shipped import find_shipped
from frbcli.case.schema import Case
from frbcli.cli import main as cli
from frbcli.cli.common import Terminal
from frbcli.cli.main import COMMANDS, run
from frbcli.errors import FrbError, NotConverged
from frbcli.scene.planning import plan


@pytest.fixture
def _planned(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plan of one known decision, so that only the command is tested."""

    def make(case: Case) -> plan.Plan:
        return replace(planned(case), decisions=(plan.Decision("theory", "finite", f"[width] of {case.name}"),))

    planned = plan.make_plan
    monkeypatch.setattr(plan, "make_plan", make)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_of_the_table_has_help(name: str, frb: Frb) -> None:
    shown = frb(name, "--help").out
    assert f"frb {name}" in shown
    assert "--json" in shown
    assert max(map(len, shown.splitlines())) <= 80


def test_check_refuses_a_table_that_ends_before_the_run(frb: Frb) -> None:
    table = 'bearing.supply.pressure=[["0 s", "1 bar"], ["2 s", "3 bar"]]'
    said = frb("check", "jeffcott", "--set", "film.theory=short", "--set", table, code=2)
    assert "ends at 2 s, and the run ends at 10 s" in " ".join(said.err.split())


@pytest.mark.usefixtures("_planned")
def test_check_as_json(frb: Frb) -> None:
    captured = frb("check", "jeffcott", "--json", "--quiet")
    assert captured.err == ""
    found = json.loads(captured.out)
    assert (found["command"], found["case"], found["status"]) == ("check", "jeffcott", "ok")
    values = {value["key"]: (value["value"], value["unit"]) for value in found["values"]}
    assert values["oil.viscosity"] == (0.012, "Pa*s")
    assert found["plan"] == [{"choice": "theory", "value": "finite", "reason": "[width] of jeffcott"}]
    assert 0.0 < found["expected"]["film_force_error_relative"] < found["expected"]["eccentricity_error"] * 10.0 < 0.1
    assert found["expected"]["steps"] > 1500 * 40  # revolutions by steps of each at least
    assert 0.05 < found["expected"]["cpu_s"] < 5.0


def test_wrong_case_is_exit_code_2_with_every_fault(tmp_path: Path, frb: Frb) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(find_shipped("jeffcott").replace("6 kg", "6 mm").replace("35 um", "35 kg"))
    captured = frb("check", str(file), "--set", "speed.too=3", code=2)
    assert captured.out == ""
    for key in ("rotor.mass", "bearing.clearance", "speed.too"):
        assert key in captured.err
    found = frb("check", "--json", str(file), code=2).document
    assert (found["command"], found["status"]) == ("check", "input-error")
    assert [fault["key"] for fault in found["faults"]] == ["rotor.mass", "bearing.clearance"]
    assert all(set(fault) == {"key", "value", "line", "problem", "remedy"} for fault in found["faults"])
    lines = file.read_text().split("\n")
    assert [lines[fault["line"] - 1].split()[0] for fault in found["faults"]] == ["mass", "clearance"]


@pytest.mark.parametrize(
    "arguments", [["nonsense"], ["check"], ["check", "jeffcott", "--no-such-option"], ["cases", "-o", "x"]]
)
def test_wrong_usage_is_exit_code_2(arguments: list[str], frb: Frb) -> None:
    assert frb(*arguments, code=2).out == ""
    found = frb(*arguments, "--json", code=2).document
    assert found["status"] == "input-error"
    assert "--help" in found["faults"][0]["remedy"]


def _raising(error: BaseException) -> click.Command:
    @click.command()
    @click.option("--json", is_flag=True)
    def command(json: bool) -> None:  # noqa: ARG001
        raise error

    return command


@pytest.mark.parametrize(
    ("error", "code", "status"),
    [
        (NotConverged("too stiff"), 3, "not-converged"),
        (FrbError("broken"), 1, "error"),
        (KeyboardInterrupt(), 130, None),
    ],
)
def test_errors_become_exit_codes(
    error: BaseException,
    code: int,
    status: str | None,
    monkeypatch: pytest.MonkeyPatch,
    frb: Frb,
) -> None:
    module = ModuleType("raising")
    module.command = _raising(error)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "raising", module)
    monkeypatch.setitem(cli.COMMANDS, "check", ("raising", "Raises.", "frb check"))
    captured = frb("check", "--json", code=code)
    if status is None:
        assert captured.out == ""
    else:
        assert json.loads(captured.out) == {"command": "check", "status": status, "message": str(error)}
        assert str(error) in captured.err


def test_bugs_are_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("raising")
    module.command = _raising(ZeroDivisionError())  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "raising", module)
    monkeypatch.setitem(cli.COMMANDS, "check", ("raising", "Raises.", "frb check"))
    with pytest.raises(ZeroDivisionError):
        run(["check"])


def test_console_entry_points() -> None:
    version = subprocess.run([sys.executable, "-m", "frbcli", "--version"], capture_output=True, text=True, check=True)
    assert version.stdout.startswith("frb ")
    wrong = subprocess.run([sys.executable, "-m", "frbcli", "check", "/"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2
    assert "Traceback" not in wrong.stderr


def test_case_is_printed_and_copied(tmp_path: Path, frb: Frb) -> None:
    assert frb("cases", "jeffcott").out == find_shipped("jeffcott")
    copy = tmp_path / "mine.toml"
    frb("cases", "jeffcott", "-o", str(copy))
    assert load_case(copy).rotor == load_case("jeffcott").rotor
    frb("cases", "jeffcott", "-o", str(copy), code=2)  # what is there stays
    frb("cases", "jeffcott", "-o", str(tmp_path / "no" / "mine.toml"), code=2)
    assert 'Did you mean the shipped case "jeffcott"' in frb("cases", "jefcott", code=2).err
    frb("cases", "jeffcott", "--set", "bearing.clearance=40 um", "-o", str(tmp_path / "wide.toml"))
    assert load_case(tmp_path / "wide.toml").same_run(load_case("jeffcott", ["bearing.clearance=40 um"]))
    frb("cases", "--set", "bearing.clearance=40 um", code=2)
    assert "before it is computed" in frb("waterfall", "run.h5", "--set", "bearing.clearance=40 um", code=2).err


def test_json_knows_no_nan(capsys: pytest.CaptureFixture[str]) -> None:
    import numpy as np

    Terminal(json=True).emit(
        {
            "a": math.nan,
            "b": np.array([[1.0, np.inf]]),
            "c": np.float64(2),
            "d": np.int64(3),
            "e": Path("x"),
            "f": (True, None),
        }
    )
    told = json.loads(capsys.readouterr().out)
    assert told == {"a": None, "b": [[1.0, None]], "c": 2.0, "d": 3, "e": "x", "f": [True, None]}


@pytest.mark.parametrize("terminal", [Terminal(json, quiet) for json in (False, True) for quiet in (False, True)])
def test_a_terminal_tells_results_and_remarks_apart(terminal: Terminal, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.result("a result")
    terminal.table("title", ("a",), [("[b]",)])
    terminal.remark("a remark")
    terminal.emit({"a": 1})
    captured = capsys.readouterr()
    document = '{\n  "a": 1\n}\n'
    if terminal.quiet:
        assert captured == (document if terminal.json else "", "")
        return
    assert all((text in captured.out + captured.err) != terminal.json for text in ("a result", "title", "[b]"))
    assert "a remark" in captured.err
    assert "a remark" not in captured.out
    assert (captured.out == document) == terminal.json
