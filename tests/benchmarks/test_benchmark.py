"""Speed against the naive way, measured in one process: `pytest -m timing -s` prints the ratios; and warm commands.

The naive way is what one writes first: scikit-fem assembly and a sparse solve at every call of the right-hand side, the
pressure clipped at the quadrature points, and scipy's LSODA around it.
"""

import math
import os
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementQuad2, LinearForm, MeshQuad

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case
from frbcli.film.gap import Section
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.machine.system import System, make_system
from frbcli.scene.planning.plan import make_plan

pytestmark = [pytest.mark.nightly, pytest.mark.timing]

AXIAL, AROUND = 10, 20  # the mesh of the naive film, as published
WINDOW_s = 5e-4  # of the run-up that the naive way is timed on, at each of these times
WINDOW_STARTS_s = (2.0, 4.5)
REPEATS = 3
FORCES_ms = 30.0  # of five naive forces, on the machine of the limits in seconds


def report(text: str) -> None:
    """A measured figure, for who runs with -s."""
    sys.stdout.write(text + "\n")


class NaiveFilm:
    """Half-Sommerfeld forces from forms assembled and a sparse system solved at every call; the mesh is made once."""

    def __init__(self, bearing: Section) -> None:
        self.scale = bearing.force_scale
        self.aspect = bearing.aspect
        ring, width = np.linspace(0.0, 2 * math.pi, AROUND + 1), np.linspace(0.0, 1.0, AXIAL + 1)
        self.basis = Basis(MeshQuad.init_tensor(ring, width), ElementQuad2(), intorder=4)
        phi, z = self.basis.doflocs
        self.angles = np.asarray(self.basis.global_coordinates())[0]
        first = {round(z[node], 9): node for node in np.flatnonzero(phi < 1e-9)}
        seam = np.flatnonzero(phi > ring[-1] - 1e-9)
        master = np.arange(len(phi))
        master[seam] = [first[round(height, 9)] for height in z[seam]]
        kept, column = np.unique(master, return_inverse=True)
        self.join = csr_matrix((np.ones(len(phi)), (np.arange(len(phi)), column)))
        self.inner = np.flatnonzero((z[kept] > 1e-9) & (z[kept] < 1 - 1e-9))

    def force(self, d: Array, v: Array, omega: float) -> Array:
        """(2,) force in N; d, v over the clearance."""
        w = (v[0] + 0.5 * omega * d[1], v[1] - 0.5 * omega * d[0])
        matrix = self.join.T @ diffusion.assemble(self.basis, d_x=d[0], d_y=d[1], aspect=self.aspect) @ self.join
        load = self.join.T @ motion.assemble(self.basis, w_x=w[0], w_y=w[1])
        pressure = np.zeros(matrix.shape[0])
        pressure[self.inner] = spsolve(matrix[self.inner][:, self.inner].tocsc(), load[self.inner])
        carried = np.maximum(np.asarray(self.basis.interpolate(self.join @ pressure)), 0.0) * self.basis.dx
        return self.scale * np.array([np.sum(carried * np.sin(self.angles)), -np.sum(carried * np.cos(self.angles))])


@BilinearForm
def diffusion(p, q, s):  # type: ignore[no-untyped-def]
    gap = 1 + s.d_x * np.sin(s.x[0]) - s.d_y * np.cos(s.x[0])
    return gap**3 * (p.grad[0] * q.grad[0] + s.aspect * p.grad[1] * q.grad[1])


@LinearForm
def motion(q, s):  # type: ignore[no-untyped-def]
    return -(s.w_x * np.sin(s.x[0]) - s.w_y * np.cos(s.x[0])) * q


def naive_cpu_per_simulated_second(system: System, run: Run, slope: float) -> float:
    """CPU seconds that LSODA with the naive film needs for one simulated second, from windows of a real run-up.

    slope: rotor speed per time in rad/s^2.
    """
    rotor, bearing = system.rotor, system.films.sections[0]
    film = NaiveFilm(bearing)
    inverse = np.linalg.inv(rotor.mass)
    n = rotor.size

    def rates(t: float, y: Array) -> Array:
        q, v = y[:n], y[n:]
        omega, angle = slope * t, 0.5 * slope * t * t
        along = slope * math.cos(angle) - omega**2 * math.sin(angle)
        across = slope * math.sin(angle) + omega**2 * math.cos(angle)
        selection = rotor.journals[0]
        force = film.force(selection @ q / bearing.clearance, selection @ v / bearing.clearance, omega)
        load = rotor.static_load + along * rotor.unbalance_cos + across * rotor.unbalance_sin
        load = load + 2.0 * selection.T @ force - rotor.damping @ v - rotor.stiffness @ q
        return np.concatenate([v, inverse @ load])

    cpu = 0.0
    for start in WINDOW_STARTS_s:
        sample = round(start / 5e-5)
        names = ("journal_x_m", "disk_x_m", "journal_y_m", "disk_y_m")
        q = np.array([run[name][sample] for name in names])
        v = np.array([np.gradient(run[name][sample - 2 : sample + 3], 5e-5)[2] for name in names])
        rates(start, np.concatenate([q, v]))
        began = time.process_time()
        solution = solve_ivp(
            rates, (start, start + WINDOW_s), np.concatenate([q, v]), method="LSODA", rtol=1e-5, atol=1e-10
        )
        cpu += time.process_time() - began
        assert solution.success
    return cpu / (WINDOW_s * len(WINDOW_STARTS_s))


def best(job: Callable[[], Run]) -> Run:
    """The run with the least CPU time: what is left when the machine's other work is taken away."""
    return min((job() for _ in range(REPEATS)), key=lambda run: run.cost["cpu_s"])


def eccentricity_error(run: Run, reference: Run, until_s: float) -> float:
    samples = round(until_s / 5e-5)
    return float(np.max(np.abs(run["eccentricity"][:samples] - reference["eccentricity"][:samples])))


def test_jeffcott_run_up_against_the_naive_way(tmp_path: Path) -> None:
    case = load_case("jeffcott")
    run = best(lambda: runup(case, tmp_path / "run.h5", force=True))
    fine = ("accuracy.tolerance=1e-9", "accuracy.steps_per_revolution=160", "accuracy.mesh=[12, 256]")
    until_threshold = "speed.to=177 Hz", "speed.duration=5.9 s"  # the linear one
    reference = runup(load_case("jeffcott", (*fine, *until_threshold)), tmp_path / "reference.h5")
    error = eccentricity_error(run, reference, 5.9)
    pace = run.t_end_s / run.cost["cpu_s"]
    naive = naive_cpu_per_simulated_second(make_system(case, make_plan(case)), run, 2 * math.pi * 30.0)
    report(f"\nfinite, half-Sommerfeld: {pace:.0f} simulated s per CPU s, error in eps {error:.1e}")
    report(f"naive: {naive:.3g} CPU s per simulated s (10 s: {naive / 360:.2g} h); ratio {naive * pace:.3g}")
    assert error < 1e-3
    assert pace >= 20
    assert naive * pace >= 5000


def test_penalty_run_up(tmp_path: Path) -> None:
    """With the time that its table takes."""
    case = load_case("jeffcott", ("film.cavitation=penalty", "film.penalty.pressure=absolute"))
    run = best(lambda: runup(case, tmp_path / "run.h5", force=True))
    plan, tables = make_plan(case), []
    for _ in range(REPEATS):
        began = time.process_time()
        make_system(case, plan)
        tables.append(time.process_time() - began)
    pace = run.t_end_s / (run.cost["cpu_s"] + min(tables))
    report(f"\npenalty, absolute: table {min(tables):.2f} CPU s, with it {pace:.1f} simulated s per CPU s")
    assert pace >= 3


SCRIPT = """
import sys, time
from frbcli import load_case, runup
class First(Exception): pass
def first(progress): raise First
case = load_case("jeffcott", ("speed.duration=0.2 s",))
try: runup(case, sys.argv[2], observe=first)
except First: print(time.time() - float(sys.argv[1]))
"""


def start_seconds(tmp_path: Path, cache: Path) -> float:
    """Wall time from the start of a fresh process to its first look at the march."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache)}
    command = [sys.executable, "-c", SCRIPT, str(time.time()), str(tmp_path / "run.h5")]
    result = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return float(result.stdout)


def slowness_probe() -> Callable[[], float]:
    """A function that says how many times slower this machine is now than the one that the limits in seconds are meant
    for, at least 1.

    Told by five naive forces, which took FORCES_ms there: limits in seconds say nothing on a machine that is half as
    fast, or at a moment when others use it.
    """
    case = load_case("jeffcott")
    film = NaiveFilm(make_system(case, make_plan(case)).films.sections[0])
    d, v = np.array([0.3, -0.2]), np.array([1.0, -2.0])
    film.force(d, v, 200.0)

    def probe() -> float:
        times = []
        for _ in range(5):
            began = time.perf_counter()
            for _ in range(5):
                film.force(d, v, 200.0)
            times.append(1e3 * (time.perf_counter() - began))
        return max(1.0, float(np.median(times)) / FORCES_ms)

    return probe


def while_running(started: Future[float], probe: Callable[[], float]) -> float:
    """Mean of a probe each second until something is done: the speed of a shared machine changes within a minute."""
    probes = [probe()]
    while not started.done():
        time.sleep(1.0)
        probes.append(probe())
    return float(np.mean(probes))


def test_start_of_a_run(tmp_path: Path) -> None:
    probe = slowness_probe()
    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(start_seconds, tmp_path, tmp_path / "cache")
        slow = while_running(first, probe)
        cold = first.result()
    warm, slow_then = min(start_seconds(tmp_path, tmp_path / "cache") for _ in range(5)), max(slow, probe())
    report(f"\nto the first step: {cold:.1f} s after installation, with compilation; {warm:.2f} s later")
    report(f"; this machine was {slow:.1f} times slower than the one of the limits\n")
    assert cold < 30 * slow
    assert warm < 1 * slow_then


LIBRARIES, CLICK = "import numpy, numba, h5py", "import click"
RUN = ("runup", "jeffcott", "--force", "-o", "x.h5")
PAIRS = 5
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def cpu_s(place: Path, words: Sequence[str]) -> float:
    """CPU time of a process of Python in user and system."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *words], cwd=place, env=ENVIRONMENT, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


@pytest.mark.parametrize(
    ("words", "imports", "most"),
    [((*RUN, "--no-picture"), LIBRARIES, 3.0), (RUN, LIBRARIES, 4.6), (("--help",), CLICK, 1.3)],
)
def test_a_warm_command_takes_few_times_the_imports_of_its_libraries(
    words: tuple[str, ...], imports: str, most: float, tmp_path: Path
) -> None:
    """Medians of pairs, one after the other, with kernels and compiled modules on the disk."""
    command = ["-m", "frbcli", *words]
    for once in (command, ["-c", imports]):
        cpu_s(tmp_path, once)
    ratios = [cpu_s(tmp_path, command) / cpu_s(tmp_path, ["-c", imports]) for _ in range(PAIRS)]
    ratio = statistics.median(ratios)
    sys.stdout.write(f"\n{' '.join(words)}: {ratio:.2f} times {imports}, from {min(ratios):.2f} to {max(ratios):.2f}\n")
    assert ratio <= most
