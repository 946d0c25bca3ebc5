"""Damaged cases: each gives a plan or names its faults, and nothing else. Some hundred mutations run with the ordinary
tests; `FRB_MUTATIONS=10000 pytest tests/outside/test_fuzz.py` runs more of them. Hostile run files: each is refused
with one message, or read by all commands, in little time and memory. What reads a run needs no more memory for a long
run than for a short one."""

import json
import os
import random
import re
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from hostile_runs import KINDS
from hostile_worker import SETTINGS
from nights import printed, seeds_tonight
from synthetic_run import Rotor, signals

from frbcli.case.reading.load import LARGEST_FILE, load_case
from frbcli.case.reading.shipped import find_shipped, shipped_names
from frbcli.case.schema import json_schema
from frbcli.cli.main import run as frb
from frbcli.errors import InputError, RunFileError
from frbcli.results.store import Header, RunWriter, read_run
from frbcli.runs.run import runup
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


LONGEST_CPU_s = 10.0
MOST_MB = 500.0
GATE, SEEDS, NIGHTS = 1, 32, 16  # files of each kind: of every change, and in so many nights
# What broke the summary once: times of 1e-300 s, a whirl ratio of 1e300, a clearance that changed before the run, a
# legend of 30 films beside a low panel.
BROKE = ("times:26", "events:31", "record_values:31", "many_signals:17", "many_signals:27")


@pytest.fixture(scope="module")
def bases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an interrupted run of a rotor in one film, and one on a floating ring."""
    folder = tmp_path_factory.mktemp("hostile")
    case = load_case("jeffcott", SETTINGS)
    run = runup(case, folder / "jeffcott.h5")
    writer = RunWriter(folder / "jeffcott.h5", Header(
        run.title, "runup", run.case_name, run.case_text, {name: signal.unit for name, signal in run.signals.items()},
        run.versions, run.references))  # fmt: skip
    writer.append({name: run[name] for name in run.signals})
    assert run.checkpoint is not None
    writer.checkpoint(run.checkpoint, run.cost, run.error, run.t_end_s)
    columns = signals(Rotor(duration_s=0.5, step_s=1e-3, whirl_s=0.2, growth_1_s=200.0))
    inner = columns.pop("eccentricity")
    columns |= {"eccentricity_inner": inner, "eccentricity_outer": 0.5 * inner, "oil_fraction_inner": 1 - 0.2 * inner}
    columns |= {"ring_x_m": 0.5 * columns["journal_x_m"], "ring_y_m": 0.5 * columns["journal_y_m"]}
    columns["ring_speed_Hz"] = 0.25 * columns["speed_Hz"]
    suffixes = {"_m": "m", "_s": "s", "Hz": "Hz"}
    units = {name: suffixes.get(name[-2:], "") for name in columns}
    references = {"clearance_m": 4e-5, "clearance_m_inner": 4e-5, "clearance_m_outer": 5e-5}
    text = load_case("floating-ring").source_text
    writer = RunWriter(folder / "ring.h5", Header("Rotor", "runup", "ring", text, units, {"frbcli": "0.1"}, references))
    writer.append(columns)
    state = {"numbers": np.zeros(17), "q": np.zeros(7), "v": np.zeros(7), "a": np.zeros(7), "past": np.zeros((3, 5)),
             "errors": np.zeros((2, 256)), "clock": np.zeros(2), "film_samples": np.zeros((5, 17))}  # fmt: skip
    writer.checkpoint(state, run.cost, run.error, 0.5)
    return folder


def tried(folder: Path, commands: str, names: Sequence[str]) -> None:
    """Assert that no file of these breaks a command, or takes it more time or memory than it may."""
    worker = str(Path(__file__).with_name("hostile_worker.py"))
    said = [json.loads(line) for line in printed(worker, str(folder), commands, *names, limited=True)]
    results = [line for line in said if "codes" in line]
    assert len(results) == len(names)
    bad = [line for line in results if line["bad"] or line["cpu_s"] > LONGEST_CPU_s or line["mb"] > MOST_MB]
    assert not bad, "\n".join(map(str, bad))
    assert {line["codes"][0] for line in results} == {0, 2}


def test_a_hostile_run_file_is_refused_or_read(bases: Path) -> None:
    tried(bases, "few", [f"{kind}:{seed}" for kind in KINDS for seed in range(GATE)] + list(BROKE))


@pytest.mark.nightly
def test_many_hostile_run_files_are_refused_or_read(bases: Path) -> None:
    tried(bases, "many", [f"{kind}:{seed}" for kind in KINDS for seed in seeds_tonight(range(SEEDS), NIGHTS)])


UNITS = {"time_s": "s", "speed_Hz": "Hz", "eccentricity": "", "journal_x_m": "m", "journal_y_m": "m"}
STEP_s = 5e-5
PICTURES = (
    ["waterfall", "RUN", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "summary", "-o", "OUT.png"],
    ["plot", "RUN", "--over", "speed", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "displacement", "-o", "OUT.png"],
    ["plot", "RUN", "--what", "orbit", "--from", "0 s", "-o", "OUT.png"],
)
TABLES = (["export", "RUN", "-o", "OUT.csv"], ["export", "RUN", "-o", "OUT.mat", "--format", "mat"])
MEASURED = """
    import json, sys
    from hostile_worker import call, forget_peak, peak_mb
    small, big, words = sys.argv[1], sys.argv[2], json.loads(sys.argv[3])
    for path in (small, big):
        forget_peak()
        before = peak_mb()
        code, _, told = call([path if word == "RUN" else word for word in words])
        assert code == 0, told
    print(peak_mb() - before)
"""


def write_run(path: Path, samples: int) -> Path:
    """A run-up to 300 Hz that whirls from its middle on."""
    time_s = STEP_s * np.arange(samples)
    speed = 300.0 * time_s / time_s[-1]
    writer = RunWriter(path, Header("Rotor", "runup", "long", "", UNITS, references={"clearance_m": 35e-6}))
    size = np.where(time_s > 0.5 * time_s[-1], 20e-6, 1e-6)
    angle = np.pi * np.cumsum(speed) * STEP_s
    writer.append({"time_s": time_s, "speed_Hz": speed, "eccentricity": size / 35e-6,
                   "journal_x_m": size * np.cos(angle), "journal_y_m": size * np.sin(angle)})  # fmt: skip
    writer.finish("finished", {}, {}, [])
    return path


def measured_mb(folder: Path, samples: int, commands: Sequence[list[str]]) -> dict[str, float]:
    """Memory of each command beyond that of a short run, in a process of its own."""
    small, big = write_run(folder / "small.h5", 20_000), write_run(folder / "big.h5", samples)
    found = {}
    for words in commands:
        words = [word.replace("OUT", str(folder / "out")) for word in words]
        (beyond,) = printed("-c", textwrap.dedent(MEASURED), str(small), str(big), json.dumps(words))
        found[" ".join(words)] = float(beyond)
    return found


@pytest.mark.nightly
def test_all_that_reads_a_run_of_twenty_million_samples_takes_little_memory(tmp_path: Path) -> None:
    found = measured_mb(tmp_path, 20_000_000, [*PICTURES, *TABLES])
    assert max(found.values()) < 500.0, found


def test_a_run_is_read_when_it_is_asked_for_and_not_from_a_file_in_its_place(tmp_path: Path) -> None:
    run = read_run(write_run(tmp_path / "run.h5", 1000))
    np.testing.assert_array_equal(run.read("time_s", 10, 20), STEP_s * np.arange(10, 20))
    np.testing.assert_array_equal(run["time_s"][10:20], run.read("time_s", 10, 20))
    assert (len(run), len(run.read("time_s", 990)), len(run.read("time_s", 5, 5))) == (1000, 10, 0)
    write_run(tmp_path / "run.h5", 1000)
    with pytest.raises(RunFileError, match="changed after it was opened"):
        run.read("time_s", 0, 10)
    (tmp_path / "run.h5").unlink()
    with pytest.raises(RunFileError, match="cannot be read any more"):
        run["time_s"]


@pytest.mark.nightly
def test_a_run_of_millions_of_samples_takes_little_memory(tmp_path: Path) -> None:
    """320 s of the Jeffcott rotor below its whirl: 12.8 million samples, 358 MB."""
    words = ["speed.to=170 Hz", "film.theory=short"]
    runs = {}
    for seconds in (10, 320):
        code = f"""
            from hostile_worker import call, peak_mb
            code, _, told = call(["runup", "jeffcott", "-o", {str(tmp_path / "run.h5")!r}, "--no-picture", "--force",
                                  *sum((["--set", each] for each in {words} + ["speed.duration={seconds} s"]), [])])
            assert code == 0, told
            print(peak_mb())
        """
        runs[seconds] = float(printed("-c", textwrap.dedent(code))[-1])
    assert runs[320] < max(300.0, runs[10] + 120.0), runs
