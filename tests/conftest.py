"""What holds for all tests, however they were started."""

import gc
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

# Ignored signals are inherited: under nohup, and in the background of a script, processes that a test interrupts would
# not hear of it and run on.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

# There are as many workers as cores: threads of the linear algebra would wait for each other, spinning, for three times
# the CPU time. Also of the processes that tests start; set before numpy is imported.
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from commands import Frb
from round_off import round_off

round_off.install()

# Where last digits decide the most: tests with perturbed round-off, with all of them by --round-off-everywhere.
TESTS = Path(__file__).parent
ROUND_OFF = ("linear", "equilibrium", "cycles", "rotor", "film")

# Objects between two searches for garbage, as in the program: kernels that are compiled make many that stay.
YOUNG = 300_000

# Files that take longest, first: a worker that began one of them last would be waited for alone. Neighbours begin at
# the same time: they compile no time loop for the same machine.
LONGEST = (
    "test_heat_run", "test_command_line", "test_resumed", "test_port_cycles", "test_given_flow", "test_rough_runs",
    "test_oil_cycles", "test_drive", "test_inputs", "test_cosimulation", "test_balance", "test_work_lost",
    "test_streams", "test_pressed_contact", "test_bearing_sheet", "test_compiled", "test_kinked_cycles",
    "test_film_records", "test_coefficients_alone", "test_shot_branch", "test_limit_cycles",
)  # fmt: skip


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--round-off", type=int, default=1, metavar="SEED", help="seed of it; 0: none")
    parser.addoption("--round-off-everywhere", action="store_true", help="perturb it in all tests")


@pytest.fixture(autouse=True)
def perturbed_round_off(request: pytest.FixtureRequest) -> Iterator[None]:
    """Matrices are off by 1e-15 of their size, see round_off.py."""
    seed, folder = request.config.getoption("--round-off"), request.path.relative_to(TESTS).parts[0]
    everywhere = request.config.getoption("--round-off-everywhere") and not request.node.get_closest_marker("bitwise")
    if not seed or not (folder in ROUND_OFF or everywhere):
        yield
        return
    with round_off.on(request.node.nodeid, seed):
        yield


@pytest.fixture
def frb(capsys: pytest.CaptureFixture[str]) -> Frb:
    """The command, with what it says: `frb("check", "jeffcott", code=2).err`."""
    return Frb(capsys)


# Folders whose tests draw pictures: each picture is looked at.
DRAWN = ("analysis", "balancing", "bearing_tests", "cli", "cycles", "docs", "linear", "plot", "report", "studies")


@pytest.fixture(autouse=True)
def readable_pictures(request: pytest.FixtureRequest) -> Iterator[None]:
    """No text of a picture reaches out of it or covers another one, see picture_texts.py."""
    if request.path.relative_to(TESTS).parts[0] not in DRAWN:
        yield
        return
    import picture_texts

    picture_texts.watch()
    picture_texts.seen.clear()
    yield
    assert not picture_texts.seen


def pytest_configure(config: pytest.Config) -> None:
    """Have pytest-xdist keep the order below; its own one begins with the files of most tests."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False
    gc.set_threshold(YOUNG, *gc.get_threshold()[1:])


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    order = {name: number for number, name in enumerate(LONGEST)}
    items.sort(key=lambda item: order.get(item.path.stem, len(order)))


def pytest_collection_finish() -> None:
    """Thousands of tests and all modules stay to the end: no search for garbage looks at them again."""
    gc.collect()
    gc.freeze()
