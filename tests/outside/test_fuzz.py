"""Damaged cases: each gives a plan or names its faults, and nothing else. Run files: test_hostile_runs.py.

Some hundred mutations run with the ordinary tests; `FRB_MUTATIONS=10000 pytest tests/outside/test_fuzz.py`
runs more of them.
"""

import os
import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from frbcli.case.reading.load import LARGEST_FILE, load_case
from frbcli.case.reading.shipped import find_shipped, shipped_names
from frbcli.case.schema import json_schema
from frbcli.cli.main import run as frb
from frbcli.errors import InputError
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
