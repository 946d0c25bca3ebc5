"""Processes of frb from outside: signals at any time, disks that are full, window systems that are not there."""

import gc
import os
import resource
import signal
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from output_options import MODELS, SETTINGS, SHORT
from paths import ROOT

from frbcli.case.reading.load import load_case
from frbcli.cli import process as cli_process
from frbcli.results.container import locked
from frbcli.results.store import read_run
from frbcli.runs.interruption import deaf
from frbcli.runs.run import runup

QUICK = ["jeffcott", *SHORT]


@pytest.fixture(autouse=True)
def in_a_directory_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def process(code: str, *words: str, **options: Any) -> subprocess.Popen[str]:
    """frb in a process of its own, in which some code is run first."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | options.pop("variables", {})
    whole = [sys.executable, "-c", f"{code}\nfrom frbcli.cli.process import main; main()", *words]
    return subprocess.Popen(
        whole, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


def test_sigterm_leaves_the_finished_rows() -> None:
    slow = """
import time
from frbcli.runs.march import March
compile, runs = March.compile, []
def second_is_slow(march):
    runs.append(march)
    if len(runs) == 2:
        print("compiling", flush=True)
        time.sleep(60.0)
    compile(march)
March.compile = second_is_slow
"""
    with process(slow, "compare", *QUICK, *MODELS, "--no-picture") as one:
        assert one.stdout is not None
        assert one.stdout.readline() == "compiling\n"
        one.send_signal(signal.SIGTERM)
        out, err = one.communicate(timeout=120.0)
    assert one.returncode == 130
    assert "half-sommerfeld short" in out
    assert "Not all models were run: interrupted" in out
    assert err == ""


COMPILING = """
import time, numba
from frbcli.runs.march import March
def compile(march):
    print("compiling", flush=True)
    while True:
        numba.njit(lambda x: x * x + 1.0)(1.0)
March.compile = compile
"""


@pytest.mark.parametrize(
    ("number", "after_s"),
    [
        (signal.SIGTERM, 0.3),
        pytest.param(signal.SIGINT, 0.0, marks=pytest.mark.nightly),
        pytest.param(signal.SIGHUP, 0.7, marks=pytest.mark.nightly),
    ],
)
def test_an_interruption_while_kernels_compile_is_quiet(number: signal.Signals, after_s: float) -> None:
    with process(COMPILING, "runup", *QUICK, "-o", "run.h5") as one:
        assert one.stdout is not None
        assert one.stdout.readline() == "compiling\n"
        time.sleep(after_s)
        one.send_signal(number)
        out, err = one.communicate(timeout=120.0)
    lines = [line for line in err.splitlines() if line and not line.startswith("Compiling the kernels, once: ")]
    assert (one.returncode, out, lines) == (130, "", ["interrupted"])


def test_what_an_interruption_came_through_is_kept() -> None:
    """A module of LLVM that was about to be handed over was destroyed twice when its frames were: one in sixty ended
    with a segmentation fault after its last word."""
    held, handlers = list[weakref.ref[Any]](), [cli_process.Interruption()]

    def hand_over() -> None:
        module = cli_process.Interruption()
        held.append(weakref.ref(module))
        handlers[0](signal.SIGTERM, None)

    with suppress(KeyboardInterrupt):
        hand_over()
    assert held[0]() is not None
    handlers.clear()  # these have kept it, nothing else
    gc.collect()
    assert held[0]() is None


@pytest.mark.parametrize("after_s", [0.0, 0.4])
def test_an_interruption_while_modules_are_imported_is_quiet(after_s: float) -> None:
    begun = "import builtins; from frbcli.cli import process; print('begun', flush=True)\n"
    listening = "listen = process.Interruption.listen\n" + (
        "def first(self):\n    listen(self); print('listening', flush=True)\nprocess.Interruption.listen = first"
    )
    with process(begun + listening, "runup", *QUICK, "-o", "run.h5", "--set", "speed.duration=100 s") as one:
        assert one.stdout is not None
        assert [one.stdout.readline() for _ in range(2)] == ["begun\n", "listening\n"]
        time.sleep(after_s)
        one.send_signal(signal.SIGINT)
        _, err = one.communicate(timeout=120.0)
    assert one.returncode == 130
    assert "Traceback" not in err
    assert "Exception" not in err


def test_an_import_that_other_work_slows_down_is_not_interrupted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside other processes an import took more than the 10 s of the clock after which it was interrupted: it counts
    its own work, and only one that waits for longer than a minute, as for a disk, is interrupted."""
    importing: dict[str, Any] = {}
    exec(compile("import sys\nframe = sys._getframe()", cli_process.IMPORTS, "exec"), importing)
    clock, again = {"monotonic": 0.0, "process_time": 0.0}, list[object]()
    for name in clock:
        monkeypatch.setattr(cli_process, name, partial(clock.get, name))
    monkeypatch.setattr(cli_process.Interruption, "_again", lambda self: again.append(self))
    interruption = cli_process.Interruption()
    for clock["monotonic"] in (0.0, 30.0, 59.0):
        interruption(signal.SIGINT, importing["frame"])
    assert len(again) == 3
    for late in ({"monotonic": 61.0}, {"monotonic": 30.0, "process_time": 11.0}):
        clock.update(late)
        with pytest.raises(KeyboardInterrupt):
            interruption(signal.SIGINT, importing["frame"])


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)])
def test_an_interruption_that_a_library_drops_comes_again(number: signal.Signals) -> None:
    dropping = """
import time
from frbcli.runs.march import March
class Half:
    def __del__(self):
        raise AttributeError("was made in half")
class Dropping:
    def __del__(self):
        print("dropping", flush=True)
        time.sleep(60.0)
def compile(march):
    half, dropping = Half(), Dropping()
    del dropping
    until = time.monotonic() + 60.0
    while time.monotonic() < until:
        pass
March.compile = compile
"""
    with process(dropping, "runup", *QUICK, "-o", "run.h5") as one:
        assert one.stdout is not None
        assert one.stdout.readline() == "dropping\n"
        one.send_signal(number)
        out, err = one.communicate(timeout=30.0)
    assert (one.returncode, out, err.strip()) == (130, "", "interrupted")


def full_at(size: int) -> Callable[[], None]:
    """As a disk that becomes full: no file of the process may have more bytes."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def test_a_disk_that_becomes_full_leaves_the_last_checkpoint() -> None:
    hurry = "import frbcli.runs.run as r; r.CHECKPOINT_EVERY_s, r.CHECKPOINT_SHARE = 0.0, 1.0"
    hurry += "; import frbcli.runs.march as u; u.BUDGET = 100"
    runup(load_case("jeffcott", SETTINGS), "run.h5")  # has its kernels compiled, whose files may not be written then
    size = Path("run.h5").stat().st_size
    with process(hurry, "runup", *QUICK, "-o", "run.h5", "--force", preexec_fn=full_at(int(0.9 * size))) as one:
        out, err = one.communicate(timeout=120.0)
    assert (one.returncode, out) == (2, "")
    assert "cannot be written: File too large. Free some space and continue" in err
    assert "Traceback" not in err
    assert os.listdir() == ["run.h5"]
    kept = read_run("run.h5")
    assert (kept.status, kept.t_end_s > 0.0) == ("interrupted", True)
    assert runup(load_case("jeffcott", SETTINGS), "run.h5", resume=True).status == "finished"


def test_a_table_on_a_full_disk_is_not_left_in_part() -> None:
    runup(load_case("jeffcott", SETTINGS), "run.h5")
    for words in (["export", "run.h5"], ["export", "run.h5", "--format", "mat"]):
        with process("", *words, preexec_fn=full_at(20_000)) as one:
            out, err = one.communicate(timeout=120.0)
        assert (one.returncode, out) == (2, "")
        assert "cannot be written" in err
        assert os.listdir() == ["run.h5"]


@pytest.mark.parametrize("backend", ["nonsense", pytest.param("gtk4agg", marks=pytest.mark.nightly)])
def test_a_window_system_is_nobody_s_business(backend: str) -> None:
    with process("", "runup", *QUICK, "-o", "run.h5", variables={"MPLBACKEND": backend}) as one:
        _, err = one.communicate(timeout=120.0)
    assert (one.returncode, err) == (0, "")
    assert Path("run-summary.png").is_file()


# --- signals ---
SWALLOWING = """
import sys, types, time, signal
from pathlib import Path
Path("swallowing.py").write_text('''
import signal, time
try:
    signal.raise_signal(signal.SIGTERM)
    time.sleep(0.05)
except BaseException:
    print("dropped", flush=True)
''')
sys.path.insert(0, "")
import frbcli.case.reading.shipped as shipped
def slow():
    import swallowing
    time.sleep(60.0)
    return {}
shipped.shipped_cases = slow
"""


def test_a_library_that_is_imported_drops_no_signal() -> None:
    with process(SWALLOWING, "cases") as one:
        out, err = one.communicate(timeout=30.0)
    assert (one.returncode, out, err.strip()) == (130, "", "interrupted")


def test_a_run_hears_an_interruption_that_was_dropped_before_it() -> None:
    class Asked:
        asked = signal.SIGTERM

        def __call__(self, *_: object) -> None:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, Asked())
    try:
        assert runup(load_case("jeffcott", SETTINGS), "run.h5").status == "interrupted"
    finally:
        signal.signal(signal.SIGTERM, before)


def test_processes_of_a_sweep_ignore_what_is_sent_to_all() -> None:
    numbers = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
    words = "import signal, sys; print([signal.getsignal(int(n)) == signal.SIG_IGN for n in sys.argv[1:]])"
    with deaf():
        done = subprocess.run([sys.executable, "-c", words, *(str(int(n)) for n in numbers)],
                              capture_output=True, text=True, check=True)  # fmt: skip
    assert done.stdout == "[True, True, True]\n"
    assert [signal.getsignal(n) for n in numbers] != [signal.SIG_IGN] * 3


@pytest.mark.nightly
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_sweep_that_all_its_processes_are_to_end_is_quiet_and_resumes(number: signal.Signals) -> None:
    words = ["sweep", *QUICK[:3], "--set", "speed.duration=200 s", "--set", "rotor.unbalance=1 g*mm,2 g*mm"]
    with process("", *words, "--jobs", "2", "-o", "study", start_new_session=True) as one:
        until = time.monotonic() + 60.0
        while not list(Path("study").glob("runs/*.h5")) and time.monotonic() < until:
            time.sleep(0.05)
        time.sleep(0.3)
        os.killpg(one.pid, number)
        _, err = one.communicate(timeout=60.0)
    assert one.returncode == 130
    lines = [line for line in err.splitlines() if not line.startswith("Compiling")]
    assert lines == [
        "Interrupted; the same command resumes the sweep.",
        "No picture: it needs one or two keys with several values, and a point with a whirl.",
    ]
    for run in Path("study/runs").glob("*.h5"):
        with locked(run):  # nobody writes it any more
            assert read_run(run).status == "interrupted"
