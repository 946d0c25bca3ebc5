"""Damaged input: a case gives a plan or names its faults, a run file gives a run or says why not; nothing else.

Some hundred mutations run with the ordinary tests; `FRB_MUTATIONS=10000 pytest tests/outside/test_fuzz.py`
runs more of them.
"""

from __future__ import annotations

import io
import json
import os
import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from synthetic_run import CLEARANCE, UNITS, Rotor, signals

from frbcli.case.reading.load import LARGEST_FILE, load_case
from frbcli.case.reading.shipped import find_shipped, shipped_names
from frbcli.case.schema import json_schema
from frbcli.cli.main import run as frb
from frbcli.errors import InputError, RunFileError
from frbcli.results.container import seal
from frbcli.results.store import Header, Run, RunWriter, read_run
from frbcli.scene.planning.film_choice import Plan
from frbcli.scene.planning.plan import make_plan

MUTATIONS = int(os.environ.get("FRB_MUTATIONS", "400"))
CASES = [find_shipped(name) for name in shipped_names()]
KEYS = sorted({key for model in json_schema()["$defs"].values() for key in model.get("properties", {})})
UNITS_OF_ALL_KINDS = ["um", "mm", "kg", "bar", "mPa*s", "Hz", "rpm", "deg", "degC", "N*s/m", "s", "%", "", "m^99", "√"]
VALUES = [
    "nan", "inf", "-inf", "0", "-0.0", "-1", "1e308", "1e-320", "9" * 400, "true", "[]", "{}", '""', "[[[[1]]]]",
    "1979-05-27", "0xFFFF", '"\\u0000"', '"1e400 m"', '"nan um"', '"-5 mm"', '"1 m/m/m"', '"12"', "{ kind = 'none' }",
    "{ kind = 3 }", "[{ kind = 'jeffcott' }, 1]", '"elrod"', '"floating-ring"', "'''a\nb'''", "[" * 300 + "]" * 300,
    "{ a = " * 60 + "1" + " }" * 60,
]  # fmt: skip

Chance = random.Random


# --- mutations of a case's text ---


def drop_line(lines: list[str], chance: Chance) -> None:
    lines.pop(chance.randrange(len(lines)))


def double_line(lines: list[str], chance: Chance) -> None:
    lines.insert(chance.randrange(len(lines) + 1), chance.choice(lines))


def swap_lines(lines: list[str], chance: Chance) -> None:
    a, b = chance.randrange(len(lines)), chance.randrange(len(lines))
    lines[a], lines[b] = lines[b], lines[a]


def other_value(lines: list[str], chance: Chance) -> None:
    at = chance.randrange(len(lines))
    lines[at] = f"{lines[at].partition('=')[0]}= {chance.choice(VALUES)}"


def other_unit(lines: list[str], chance: Chance) -> None:
    at = chance.randrange(len(lines))
    lines[at] = re.sub(r'(\d)[^"\d]*"', rf'\1 {chance.choice(UNITS_OF_ALL_KINDS)}"', lines[at])


def other_number(lines: list[str], chance: Chance) -> None:
    at = chance.randrange(len(lines))
    number = repr(chance.choice([-1.0, 1.0]) * 10.0 ** chance.uniform(-25, 25))
    lines[at] = re.sub(r"\d+(\.\d+)?", number, lines[at], count=1)


def other_key(lines: list[str], chance: Chance) -> None:
    at = chance.randrange(len(lines))
    lines[at] = re.sub(r"[A-Za-z_-]+", chance.choice(KEYS), lines[at], count=1)


def new_line(lines: list[str], chance: Chance) -> None:
    table = chance.choice(["", "[rotor]\n", "[[bearing]]\n", "[a.b]\n", "film.penalty."])
    lines.insert(chance.randrange(len(lines) + 1), f"{table}{chance.choice(KEYS)} = {chance.choice(VALUES)}")


def line_of_another_case(lines: list[str], chance: Chance) -> None:
    lines[chance.randrange(len(lines))] = chance.choice(chance.choice(CASES).split("\n"))


def cut(lines: list[str], chance: Chance) -> None:
    at = chance.randrange(len(lines))
    lines[at:] = [lines[at][: chance.randrange(len(lines[at]) + 1)]]


def stepped(lines: list[str], chance: Chance) -> None:
    steps = f'{{ time = "{chance.uniform(-1.0, 12.0):.2g} s", clearance = "{10.0 ** chance.uniform(0, 4):.2g} um" }}'
    at = next((at for at, line in enumerate(lines) if line.startswith("clearance =")), 0)
    lines.insert(at, f"clearance_steps = [{steps}{', ' + steps if chance.random() < 0.2 else ''}]")


MUTATORS: list[Callable[[list[str], Chance], None]] = [
    drop_line, double_line, swap_lines, other_value, other_value, other_unit, other_number, other_number, other_key,
    new_line, line_of_another_case, cut, stepped,
]  # fmt: skip


def mutated(chance: Chance) -> bytes:
    """A shipped case with one to four changes of its lines, and now and then of its bytes."""
    lines = chance.choice(CASES).split("\n")
    for _ in range(chance.choice([1, 1, 2, 4])):
        chance.choice(MUTATORS)(lines, chance)
        lines = lines or [""]
    content = bytearray("\n".join(lines).encode())
    if chance.random() < 0.1:
        for _ in range(chance.randrange(1, 20)):
            at = chance.randrange(len(content) + 1)
            content[at : at + 1] = bytes([chance.randrange(256)])
    return bytes(content)


def planned(path: Path) -> Plan | InputError:
    """What reading and planning gives; any other exception passes and fails the test."""
    try:
        return make_plan(load_case(path))
    except InputError as error:
        found = error
    assert found.faults
    assert all(fault.problem for fault in found.faults)
    assert str(found).encode()
    return found


def test_a_mutated_case_gives_a_plan_or_names_its_faults(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    outcomes = []
    for seed in range(MUTATIONS):
        content = mutated(Chance(seed))
        file.write_bytes(content)
        try:
            outcomes.append(type(planned(file)))
        except Exception as bug:
            bug.add_note(f"seed {seed}:\n{content.decode(errors='replace')[:4000]}")
            raise
    # the mutations are neither harmless nor hopeless
    assert 0.05 < outcomes.count(Plan) / MUTATIONS < 0.6


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\n" * 1000,
        b"\x00" * 1000,
        b"[" * 20_000,
        b"a = " + b"[" * 20_000 + b"]" * 20_000,
        b"a." * 20_000 + b"b = 1",
        b"x = { " + b"a." * 20_000 + b"b = 1 }",
        b"a." * 100 + b"b = 1",
        b"[" + b"a." * 10_000 + b"b]",
        b"[[bearing]]\n" * 1000,
        b"x = 1" + b"0" * 100_000,
        b"bearing = [" + b"{}," * 2000 + b"]",
        b"title = \"" + b"a" * 200_000 + b"\"",
        b"a" * (LARGEST_FILE + 1),
        b"title = \"\xff\"",
        b"\xef\xbb\xbf[rotor]\nkind = \"rigid\"\r\n",
        b"rotor = 1\nspeed = []\nbearing = \"x\"\noil = nan\nfilm = 1979-05-27\n",
    ],
    ids=lambda content: content[:12].decode("latin-1").replace("\x00", "0") or "empty",
)  # fmt: skip
def test_an_extreme_file_is_refused_at_once(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "case.toml"
    file.write_bytes(content)
    assert isinstance(planned(file), InputError)
    assert frb(["check", str(file), "--quiet"]) == 2


# --- run files ---


@pytest.fixture(scope="module")
def whole_run(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("made") / "run.h5"
    columns = signals(Rotor(duration_s=1.0, step_s=5e-4, whirl_s=0.5, growth_1_s=200.0))
    units = {name: UNITS.get(name, "m") for name in columns}
    references = {"clearance_m": CLEARANCE, "contact_eccentricity": 0.99}
    writer = RunWriter(path, Header("Jeffcott rotor", "runup", "test", CASES[0], units, {"frb": "1"}, references))
    writer.append(columns)
    writer.checkpoint({"q": np.zeros(4), "numbers": np.zeros(9)}, {"cpu_s": 1.0}, {"time_integration": 1e-6}, 1.0)
    event = {"kind": "onset", "film": None, "t_s": 0.5, "speed_Hz": 150.0, "frequency_Hz": 70.0, "frequency_ratio": 0.5}
    writer.finish("finished", {"cpu_s": 1.0}, {"time_integration": 1e-6}, [event])
    return path.read_bytes()


def commands(path: Path, folder: Path) -> list[int]:
    """The exit codes of all that reads a run file; a traceback passes and fails the test."""
    called = [
        ["waterfall", str(path), "-o", str(folder / "w.png")],
        ["plot", str(path), "-o", str(folder / "p.png")],
        ["export", str(path), "-o", str(folder / "t.csv"), "--format", "csv"],
        ["export", str(path), "-o", str(folder / "t.mat"), "--format", "mat"],
    ]
    return [frb([*words, "--quiet"]) for words in called]


def test_a_run_file_with_changed_bytes_is_refused_by_all(whole_run: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    for seed in range(MUTATIONS // 4):
        chance, content = Chance(seed), bytearray(whole_run)
        how = chance.choice(["cut", "flip", "fill", "insert", "noise"])
        at = chance.randrange(len(content))
        if how == "cut":
            del content[at:]
        elif how == "flip":
            content[at] ^= 1 << chance.randrange(8)
        elif how == "fill":
            content[at : at + 64] = bytes(b ^ 0x5A for b in content[at : at + 64])
        elif how == "insert":
            content[at:at] = chance.randbytes(8)
        else:
            content = bytearray(chance.randbytes(at))
        path.write_bytes(content)
        with pytest.raises(RunFileError) as error:
            read_run(path)
        assert str(path) in str(error.value)
        assert error.value.faults[0].problem
        if seed < 20:
            assert commands(path, tmp_path) == [2] * 4
    assert [file.name for file in tmp_path.iterdir()] == ["run.h5"]


WRONG: list[Any] = [
    np.zeros(0), np.zeros((2, 3)), np.full(2001, np.nan), np.full(2001, np.inf), np.zeros(2001), np.zeros(1), 1.5, "3",
    "{}", "[]", "null", '[{"kind": "onset"}]', '[{"kind": 3, "t_s": "x"}]', "[[1]]", '{"cpu_s": "much"}', "NaN",
    '{"clearance_m": 0}', '{"clearance_m": "x"}', '{"clearance_m": null}', np.array([b"\xff"]), np.arange(2001)[::-1],
]  # fmt: skip


def resealed(whole: bytes, path: Path, change: Callable[[h5py.File], None]) -> None:
    """A file whose checksum is right and whose content is not."""
    content = io.BytesIO(whole)
    with h5py.File(content, "r+") as file:
        change(file)
    seal(content)
    path.write_bytes(content.getvalue())


def test_a_run_file_with_wrong_parts_is_read_or_refused(whole_run: bytes, tmp_path: Path) -> None:
    path, names = tmp_path / "run.h5", []
    path.write_bytes(whole_run)
    with h5py.File(io.BytesIO(path.read_bytes()), "r") as file:
        file.visit(names.append)
    outcomes = []
    for seed in range(MUTATIONS // 4):
        chance = Chance(seed)

        def change(file: h5py.File, chance: Chance = chance) -> None:
            for _ in range(chance.choice([1, 1, 2])):
                name = chance.choice([name for name in names if name in file])
                attributes = list(file[name].attrs)
                if attributes and chance.random() < 0.3:
                    file[name].attrs[attributes[0]] = chance.choice([3, "", np.zeros(3), "Hz"])
                    continue
                del file[name]
                if chance.random() < 0.75:
                    file[name] = chance.choice(WRONG)
                    if chance.random() < 0.8:
                        file[name].attrs["unit"] = "m"

        resealed(whole_run, path, change)
        try:
            run = read_run(path)
            json.dumps(run.cost)
            outcomes.append(Run)
        except RunFileError as error:
            assert str(path) in str(error)  # noqa: PT017
            assert error.faults[0].problem  # noqa: PT017
            outcomes.append(RunFileError)
        if outcomes[-1] is RunFileError:
            assert frb(["export", str(path), "-o", str(tmp_path / "t.csv"), "--quiet"]) == 2
        elif outcomes.count(Run) <= MUTATIONS // 40:  # pictures take their time
            try:
                assert set(commands(path, tmp_path)) <= {0, 2}
            except Exception as bug:
                bug.add_note(f"seed {seed}")
                raise
    assert {Run, RunFileError} == set(outcomes)
