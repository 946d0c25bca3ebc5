"""Every number of six shipped cases times nasty values, alone and in pairs.

Each is refused with its key and a remedy, or can be run: a run of a moment in a process of its own ends with a status
and finite numbers, below 1 GB, within three times its predicted cost or with a warning before. A small sample without
runs goes with the ordinary tests; a night tries one of NIGHTS parts of FRB_NUMBERS of them.
"""

import json
import math
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from nights import seeds_tonight

from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case
from frbcli.cli.main import run as frb
from frbcli.errors import InputError, RunFileError
from frbcli.results.store import read_run
from frbcli.runs.run import run_cost, runup

NUMBERS = int(os.environ.get("FRB_NUMBERS", "5000"))
NIGHTS = 20
SAMPLE = 30
CASES = (
    "jeffcott", "jeffcott-supply-2bar", "soft-shaft", "axial-groove-two-phase", "floating-ring", "turbocharger-car"
)  # fmt: skip
MORE = {  # numbers that no shipped case has
    "accuracy.mesh": math.nan, "accuracy.tolerance": 1e-5, "contact.stiffness": 1e8, "start.displacement": 0.3,
}  # fmt: skip
PLAIN = ("0", "-0.0", "-1", "1e-300", "-1e300", "1e300", "nan", "inf", "-inf", '"text"', "[]", "true", "1" + "0" * 400)
WHOLE = ("0", "1", "2", "3", "7", "24", "25", "100", "200", "400", "2000", "100000", "-1", "2.5", "1e3", "nan")
FACTORS = (1e-12, 1e-9, 1e-6, 1e-3, 1e-2, 0.1, 0.5, 0.999, 1.001, 2.0, 10.0, 100.0, 1e3, 1e6, 1e9, 1e12)
MOMENT = ("speed.duration=5 ms", "speed.hold=0 s", "speed.down_duration=5 ms")
STATUSES = ("finished", "contact", "starved", "not-converged")
MEMORY_MB, WITHIN = 1000.0, 3.0
START_s = 5.0  # CPU time of a process that does next to nothing, on a busy machine
PATIENCE_s, MANNERS_s = 60.0, 15.0  # until a run is interrupted, and for it to end then
CHECKED_s = 20.0  # CPU time to refuse or plan a case
SLOW = re.compile("takes [^;]* s of CPU time, [^;]*")
WARNINGS = ("This takes about", "Warning: this run takes")


@cache
def numeric_keys(name: str) -> tuple[tuple[str, float | int], ...]:
    """Keys of a shipped case that hold a number, and the number."""
    found = ((value.key, value.value) for value in values(load_case(name)))
    return tuple((key, number) for key, number in found if not isinstance(number, str | bool))


@dataclass(frozen=True)
class Trial:
    """A shipped case with one or two nasty numbers."""

    name: str
    settings: tuple[str, ...]

    def __str__(self) -> str:
        return " ".join((self.name, *self.settings))

    @property
    def moment(self) -> tuple[str, ...]:
        """The settings, and those that make a run short where they leave it alone."""
        own = {setting.partition("=")[0] for setting in self.settings}
        return (*(setting for setting in MOMENT if setting.partition("=")[0] not in own), *self.settings)


def trial(seed: int) -> Trial:
    """The trial of a seed, always the same."""
    chance = random.Random(seed)
    name = chance.choice(CASES)
    keys = [*numeric_keys(name), *MORE]
    return Trial(name, tuple(_setting(chance, key) for key in chance.sample(keys, chance.choice((1, 1, 2)))))


def _setting(chance: random.Random, key: tuple[str, float | int] | str) -> str:
    if isinstance(key, str):
        if key == "accuracy.mesh":
            return f"{key}=[{chance.choice(WHOLE)}, {chance.choice(WHOLE)}]"
        value = _nasty(chance, MORE[key])
        return f"{key}=[{value}, 0.0]" if key == "start.displacement" else f"{key}={value}"
    name, number = key
    return f"{name}={chance.choice(WHOLE) if isinstance(number, int) else _nasty(chance, number)}"


def _nasty(chance: random.Random, usual: float) -> str:
    if usual == 0.0 or chance.random() < 0.25:
        return chance.choice(PLAIN)
    return f"{usual * chance.choice(FACTORS):.9g}"


def expected_s(case: Trial) -> float | str:
    """Predicted CPU time of the run, or the faults in one text; any other exception passes and is a bug."""
    begun = time.process_time()
    try:
        found: float | str = run_cost("runup", load_case(case.name, case.moment)).total_s
    except InputError as error:
        found, refused = str(error), error.faults
        vague = [fault for fault in refused if not (fault.key and fault.problem and fault.remedy)]
        if vague or not refused:
            raise AssertionError(f"faults without key, problem or remedy: {found}") from error
    assert time.process_time() - begun < CHECKED_s, "slow to check"
    return found


@dataclass(frozen=True)
class Running:
    """The process of a trial. begun: when it was started; interrupted: whether it had to be."""

    seed: int
    predicted_s: float
    folder: tempfile.TemporaryDirectory[str]
    pid: int
    begun: float
    interrupted: bool = False

    @property
    def run_file(self) -> Path:
        return Path(self.folder.name) / "run.h5"

    def said(self, stream: str) -> str:
        return (Path(self.folder.name) / stream).read_text(encoding="utf-8", errors="replace")


def start(seed: int, predicted_s: float) -> Running:
    """Run a trial in a fork of this process, which has all libraries and kernels: thousands of starts take hours."""
    folder = tempfile.TemporaryDirectory()
    running = Running(seed, predicted_s, folder, os.fork(), time.monotonic())
    if running.pid:
        return running
    code = 1
    try:
        for stream, number in (("out", 1), ("err", 2)):
            os.dup2(os.open(Path(folder.name) / stream, os.O_WRONLY | os.O_CREAT), number)
        sys.stdout, sys.stderr = (open(number, "w", encoding="utf-8") for number in (1, 2))  # noqa: SIM115
        settings = [word for setting in trial(seed).moment for word in ("--set", setting)]
        code = frb(["runup", trial(seed).name, *settings, "-o", str(running.run_file), "--no-picture", "--json"])
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def troubles(running: Running, code: int, used: resource.struct_rusage) -> Iterator[str]:
    """What is wrong with the run of a case that was accepted."""
    said, cpu_s = running.said("err"), used.ru_utime + used.ru_stime
    warned = any(words in said for words in WARNINGS)
    if running.interrupted and not (code == 130 and warned):
        yield f"still running after {PATIENCE_s:g} s, ended with {code} {'after' if warned else 'without'} a warning"
    if "Traceback" in said or re.search(r"\w+Warning:", said):
        yield f"says: {said.strip().splitlines()[-1][:200]}"
    if code not in (0, 2, 3, 130):
        yield f"ends with {code}"
    if cpu_s > START_s + WITHIN * running.predicted_s and not warned:
        yield f"takes {cpu_s:.3g} s of CPU time, predicted were {running.predicted_s:.3g} s"
    if used.ru_maxrss / 1024 > MEMORY_MB:
        yield f"takes {used.ru_maxrss / 1024:.0f} MB"
    if code in (0, 3):
        yield from _wrong_numbers(running.run_file, running.said("out"))


def reports(seeds: Iterable[int], at_once: int) -> Iterator[str]:
    """What is wrong with the trials of these seeds, one text each, of those where something is."""
    waiting, now, again = deque(seeds), list[Running](), set[int]()
    while waiting or now:
        if waiting and len(now) < at_once:
            seed = waiting.popleft()
            told, predicted_s = report(seed)
            if told:
                yield told
            elif predicted_s is not None:
                now.append(start(seed, predicted_s))
            continue
        for place, running in enumerate(list(now)):
            pid, status, used = os.wait4(running.pid, os.WNOHANG)
            if pid:
                found = "; ".join(troubles(running, os.waitstatus_to_exitcode(status), used))
                running.folder.cleanup()
                now.remove(running)
                if SLOW.fullmatch(found) and running.seed not in again:  # it may have compiled a kernel, once for all
                    again.add(running.seed)
                    waiting.append(running.seed)
                elif found:
                    yield f"seed {running.seed}, {trial(running.seed)}: {found}"
                continue
            waited = time.monotonic() - running.begun
            if waited > PATIENCE_s and not running.interrupted:
                os.kill(running.pid, signal.SIGINT)
                now[place] = replace(running, interrupted=True)
            if waited > PATIENCE_s + MANNERS_s:
                os.kill(running.pid, signal.SIGKILL)
        time.sleep(0.02)


def _wrong_numbers(path: Path, told: str) -> Iterator[str]:
    """Of a run that ended by itself."""
    status = json.loads(told)["status"]
    if status not in (*STATUSES, "error"):
        yield f"ends as {status!r}"
    if not path.exists():
        return
    try:
        run = read_run(path)
    except RunFileError as error:
        yield f"writes a file that cannot be read: {error}"
        return
    for name in run.signals:
        if not np.all(np.isfinite(run[name])):
            yield f"{name} is not finite"
    wrong = [key for key, value in {**run.cost, **run.error}.items() if value is not None and math.isnan(value)]
    if wrong:
        yield f"{', '.join(wrong)}: not a number"


def report(seed: int) -> tuple[str, float | None]:
    """(what is wrong with the case of a seed before it is run, its predicted CPU time or None if it is refused)."""
    try:
        predicted = expected_s(trial(seed))
    except Exception as bug:
        return f"seed {seed}, {trial(seed)}: {type(bug).__name__}: {bug}", None
    return "", None if isinstance(predicted, str) else predicted


def test_a_sample_of_nasty_numbers_is_refused_or_planned() -> None:
    found = [report(seed) for seed in range(SAMPLE)]
    assert not [told for told, _ in found if told]
    accepted = [predicted_s for _, predicted_s in found if predicted_s is not None]
    assert SAMPLE // 4 < len(accepted) < SAMPLE  # the numbers are neither harmless nor hopeless
    assert all(math.isfinite(predicted_s) for predicted_s in accepted)


@pytest.mark.nightly
@pytest.mark.timing
@pytest.mark.skipif(sys.platform == "win32", reason="forks")
def test_nasty_numbers_run_or_are_refused(tmp_path: Path) -> None:
    for name in CASES:  # the kernels of all kinds, before the processes are forked
        runup(load_case(name, MOMENT), tmp_path / f"{name}.h5")
    found = list(reports(seeds_tonight(range(NUMBERS), NIGHTS), os.cpu_count() or 1))
    assert not found, "\n".join([f"{len(found)} of {NUMBERS // NIGHTS}", *found[:50]])
