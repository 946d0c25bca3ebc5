"""A dask cluster of a sweep: nobody else runs code in it, and what goes wrong with it is one clear line."""

import logging
import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import pytest

from frbcli.errors import InputError
from frbcli.studies import sweep_workers as sweep_workers
from frbcli.studies.sweep_workers import Workers, _client, _local_client, check_workers

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("default")  # not of frb
SWEEP = ("sweep", "jeffcott", "--set", "rotor.unbalance=1 g*mm,2 g*mm", "--set", "film.theory=short",
         "--set", "speed.duration=300 s", "--backend", "dask", "--jobs", "1", "--no-runs", "--no-picture",
         "-o", "out")  # fmt: skip
WITHIN_s = 120.0


def listening(process: int) -> set[int]:
    """The ports of TCP at which a process of Linux can be reached, and those of all that it started."""
    found = set[int]()
    table = [line.split() for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
    ports = {row[9]: int(row[1].split(":")[1], 16) for row in table if row[3] == "0A"}
    for one in (process, *children(process)):
        for handle in Path(f"/proc/{one}/fd").iterdir():
            name = str(handle.readlink())
            if name.startswith("socket:[") and name[8:-1] in ports:
                found.add(ports[name[8:-1]])
    return found


def children(process: int) -> list[int]:
    found = list[int]()
    for task in Path(f"/proc/{process}/task").iterdir():
        for child in map(int, (task / "children").read_text().split()):
            found += [child, *children(child)]
    return found


def test_nobody_without_its_certificates_runs_code_in_a_cluster_of_this_machine(tmp_path: Path) -> None:
    """Neither in the clear nor with certificates of their own, at none of the ports of all processes."""
    command = [sys.executable, "-m", "frbcli", *SWEEP]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as running:
        try:
            ports, until = set[int](), time.monotonic() + WITHIN_s
            while len(ports) < 2 and time.monotonic() < until:  # of the scheduler and of a worker
                time.sleep(0.5)
                ports = listening(running.pid)
            assert len(ports) >= 2
            others = distributed.security.Security.temporary()
            for port in ports:
                for address, security in ((f"tcp://127.0.0.1:{port}", None), (f"tls://127.0.0.1:{port}", others)):
                    with pytest.raises(Exception):  # noqa: B017, PT011  # of many kinds
                        distributed.Client(address, security=security, timeout="2 s", set_as_default=False)
        finally:
            running.send_signal(signal.SIGINT)
            running.wait(WITHIN_s)


def test_the_own_certificates_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with ExitStack() as cluster:
        client = _local_client(1, cluster)
        assert client.scheduler.address.startswith("tls://")
        assert client.submit(len, "four").result(timeout=WITHIN_s) == 4


@pytest.mark.parametrize("interrupted_after_s", [2.0, 8.0])
def test_an_interruption_is_one_line(tmp_path: Path, interrupted_after_s: float) -> None:
    """That of a terminal, which all processes get: at the start of the cluster, and while it computes."""
    running = subprocess.Popen([sys.executable, "-m", "frbcli", *SWEEP], cwd=tmp_path, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True, start_new_session=True)  # fmt: skip
    time.sleep(interrupted_after_s)
    os.killpg(running.pid, signal.SIGINT)
    _, said = running.communicate(timeout=WITHIN_s)
    assert running.returncode == 130
    lines = [line for line in said.splitlines() if line and not line.startswith(("Compiling", "1/2", "2/2"))]
    assert lines in (["interrupted"], ["Interrupted; the same command resumes the sweep."])


WRONG = ("tls://127.0.0.1:9", "inproc://1/2/3", "http://127.0.0.1:9", "abc",
         "tcp://", "tcp://[::1", "tcp://no host:1", "\0")  # fmt: skip


@pytest.mark.parametrize("address", WRONG)
def test_a_wrong_address_is_wrong_input(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_workers, "CONNECT_WITHIN_s", 0.5)
    with pytest.raises(InputError, match="cannot be reached") as error:
        _client(Workers("dask", scheduler=address))
    (fault,) = error.value.faults
    assert ("ca-file" in fault.remedy) == address.startswith("tls")
    assert "\n" not in str(fault)


def test_a_cluster_without_certificates_is_remarked(caplog: pytest.LogCaptureFixture, tmp_path: Path) -> None:
    caplog.set_level(logging.WARNING, logger="frbcli")  # a quiet command of another test leaves errors alone
    with distributed.LocalCluster(
        n_workers=1, processes=False, dashboard_address=None, protocol="tcp", local_directory=str(tmp_path)
    ) as cluster, _client(Workers("dask", scheduler=cluster.scheduler_address)):
        (told,) = [record.getMessage() for record in caplog.records if record.name == "frbcli"]
    assert told.startswith(f"Whoever can connect to {cluster.scheduler_address} can run code")


@pytest.mark.parametrize(("scheduler", "refused"), [("", True), ("tls://127.0.0.1:9", False)])
def test_a_cluster_of_this_machine_needs_the_library_of_certificates(
    scheduler: str, refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sweep_workers, "find_spec", lambda name: None if name == "cryptography" else name)
    if not refused:
        check_workers(Workers("dask", scheduler=scheduler))
        return
    with pytest.raises(InputError, match=r"cryptography\. Install it: pip install frbcli\[cluster\]"):
        check_workers(Workers("dask"))


def test_settings_of_dask_that_others_can_change_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They name modules that each process of a cluster imports."""
    folder = tmp_path / ".config" / "dask"
    folder.mkdir(parents=True)
    monkeypatch.setenv("HOME", str(tmp_path))
    check_workers(Workers("dask"))
    folder.chmod(0o777)
    with pytest.raises(InputError, match="which other users can change"):
        check_workers(Workers("dask"))
