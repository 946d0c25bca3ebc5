"""Give cases with two nasty values each to every command that takes a case, and tell what came of it.

`python -W error nasty_pairs.py FOLDER SEED...` writes a line of JSON for each seed: the command, its exit code and CPU
time, and what is bad about it. A run that `frb check` expects to take long is not begun.
"""

import contextlib
import functools
import io
import json
import math
import os
import random
import signal
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import numpy as np

from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case
from frbcli.case.schema import Case
from frbcli.cli.main import run as frb
from frbcli.errors import FrbError
from frbcli.runs.run import run_cost

LONGEST_RUN_s = {"runup": 5.0, "rundown": 5.0, "compare": 2.0, "fit": 0.2, "accuracy": 0.2}  # expected, of one run-up
LONGEST_STEP_s = 0.1
LONGEST_s, COMPILED_s = 90.0, 400.0  # of CPU time; of cases most of which have kernels of their own
CODES = (0, 2, 3)

SHORT_RUN = ("speed.from=20 Hz", "speed.to=60 Hz", "speed.duration=0.1 s", "speed.hold=0.02 s",
             "speed.down_duration=0.1 s", "output.step=1 ms", "accuracy.target=0.02",
             'confirm=["surface-speed", "gap-growth", "clearance"]')  # fmt: skip
MOTION = 'motion = { eccentricity = 0.5, angle = "-60 deg", speed = "20 Hz", frequency = "20 Hz", periods = 1 }'
BASES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("jeffcott", ("film.theory=short",)),
    ("jeffcott", ()),
    ("jeffcott", ("film.cavitation=reynolds", "accuracy.mesh=[4, 24]")),
    ("rigid", ("film.theory=short", "contact.policy=elastic", "contact.stiffness=1e8 N/m")),
    ("rigid-two-phase", ("accuracy.mesh=[4, 24]",)),
    ("jeffcott", ('bearing.supply={kind="bores", count=3, diameter="3 mm", pressure="2 bar"}',
                  "film.cavitation=penalty", "accuracy.mesh=[6, 32]")),
    ("jeffcott", ("film.theory=short", 'thermal={ model="lumped", supply_temperature="60 degC" }',
                  'oil.viscosity={ grade="SAE 10W-40" }')),
    ("floating-ring", ()),
    ("turbocharger-car", ()),
)  # fmt: skip
HEATED = 6  # the base with heat
COMMANDS: tuple[tuple[str, ...], ...] = (
    ("check", "CASE", "--all"),
    ("rotation", "CASE", "-o", "OUT.png"),
    ("rotation", "CASE", "--cavitation", "half-sommerfeld,elrod", "--no-picture"),
    ("squeeze", "CASE", "--no-picture"),
    ("whirl", "CASE", "--no-picture"),
    ("runup", "CASE", "-o", "OUT.h5"),
    ("rundown", "CASE", "-o", "OUT.h5"),
    ("compare", "CASE", "--cavitation", "half-sommerfeld,sommerfeld", "-o", "OUT.png"),
    ("bearing", "CASE", "--speed", "50 Hz", "-o", "OUT.png", "--csv", "OUT.csv"),
    ("bearing", "CASE", "--speed", "50 Hz", "--load", "30 N", "--no-picture"),
    ("bearing", "CASE", "--over", "eccentricity", "--no-picture"),
    ("fit", "CASE", "--measured", "measured.csv", "--x", "x", "--y", "y", "--time", "t", "--speed-column", "n",
     "--clearance", "35 um", "--vary", "bearing.clearance", "--no-picture"),
    ("stability", "CASE", "-o", "OUT.png"),
    ("stability", "CASE", "--shapes", "50 Hz", "-o", "OUT.png"),
    ("stability", "CASE", "--modes", "5e6 N/m", "-o", "OUT.png"),
    ("response", "CASE", "-o", "OUT.png", "--csv", "OUT.csv"),
    ("response", "CASE", "--map", "-o", "OUT.png"),
    ("limit-cycles", "CASE", "-o", "OUT.png"),
    ("limit-cycles", "CASE", "--parameter", "bearing.clearance=30..40 um", "--no-picture"),
    ("accuracy", "CASE", "--until", "20 ms", "-o", "OUT.png"),
    ("sweep", "CASE", "--set", "rotor.unbalance=1 g*mm,2 g*mm", "--stability", "--jobs", "1", "-o", "OUT-sweep"),
    ("plot", "CASE", "--what", "law", "-o", "OUT.png"),
    ("thrust", "CASE", "--gap", "12 um", "--speed", "900 Hz", "-o", "OUT.png", "--csv", "OUT.csv"),
    ("warm-up", "CASE", "--jobs", "1"),
)  # fmt: skip
# What a command needs of a base beyond the others: the whole film, or windows of 16 revolutions
NEEDS = {"fit": ("film.theory=short", "speed.duration=2 s")} | dict.fromkeys(
    ("rotation", "squeeze", "whirl"), ("film.theory=auto",)
)
FACTORS = (0.0, -1.0, 1e-12, 1e-6, 1e-3, 0.01, 0.1, 0.3, 0.9, 1.1, 3.0, 10.0, 100.0, 1e3, 1e6, 1e12)
PLAIN = (0.0, -0.0, -1.0, 1e-15, 1e-9, 1e-3, 1.0, 0.999999, 1e3, 1e15)
WORDS = ("", "nan", "[]", "true", "1e400 m", "35 u m", "elrod", "none", "auto", "3", "{ kind = 'none' }")

# Seeds from this one on have an input over time in place of one value or of both, half of them sound: keys with
# the size of their values, and what is in the files that they name.
OVER_TIME = 100_000
INPUTS = (("bearing.supply.pressure", 2e5), ("thermal.supply_temperature", 340.0), ("thermal.housing", 330.0),
          ("speed", 50.0), ("force", 10.0), ("base", 2.0))  # fmt: skip
SOUND = (0.9, 1.0, 1.1)  # times the size
TIMES = (0.0, 0.0, 1e-9, 0.02, 0.1, 0.3, 1.0, 1e6, -1.0)  # s
TABLES: dict[str, tuple[tuple[object, object], ...]] = {
    "good": ((0.0, 1.0), (0.05, 1.1), (1.0, 1.0)), "steep": ((0.0, 1.0), (1e-6, 1.1), (2e-6, 0.9), (1.0, 1.0)),
    "falling": ((0.0, 1.0), (0.5, 1.0), (0.2, 1.0)), "short": ((0.0, 1.0), (0.01, 1.0)),
    "late": ((0.03, 1.0), (1.0, 1.0)),
    "gap": tuple((0.01 * i, 1.0 + 0.01 * i) for i in range(40) if i not in (20, 21, 22)),
    "huge": ((0.0, 1e30), (1.0, -1e30)), "words": ((0.0, "nan"), ("one", 1.0)), "empty": (),
}  # fmt: skip


# Seeds from this one on have one or two nasty values of contact, free gas, flow and bath in place of any.
SURFACES = 200_000
ROUGH = ("contact.model=asperities", "contact.roughness=0.4 um", "contact.summit_radius=20 um",
         "contact.summit_density=5e9 1/m^2", "contact.hardness=2 GPa", "contact.wear=1e-7")  # fmt: skip
FED = 'bearing.supply={ kind = "circumferential-groove", pressure = "2 bar", flow = "0.1 l/min" }'
SLIT = 'bearing.supply={ kind = "axial-grooves", opening_angle = "15 deg", pressure = "2 bar", flow = "0.1 l/min" }'
FEW = ("accuracy.mesh=[4, 24]", "output.signals=['power', 'film-thickness']")
TOUCHING: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("rigid", (*ROUGH, "film.theory=short")),
    ("rigid", (*ROUGH, *FEW, "contact.flow_factors=true", "contact.journal_roughness=0.3 um")),
    ("rigid", (*ROUGH, *FEW, FED, "film.cavitation=elrod")),
    ("rigid", (*ROUGH, *FEW, "film.cavitation=bubbly", "bearing.supply.pressure=2 bar",
               "film.bubbly.saturation_pressure=1 bar")),
    ("rigid", (*FEW, SLIT, "film.cavitation=peeken", 'bearing.ends={ bath_level = "-5 mm" }')),
    ("rigid", (*FEW, SLIT, "film.cavitation=two-phase")),
    ("rigid", ("film.theory=short", "contact.policy=elastic", "contact.stiffness=1e8 N/m")),
    ("floating-ring", (*ROUGH, "film.cavitation=half-sommerfeld")),
)  # fmt: skip
OF_SURFACES = ("contact.", "film.bubbly.", "film.cavitation", "bearing.ends", "bearing.supply.flow",
               "bearing.supply.pressure")  # fmt: skip

# Seeds from this one on have one or two nasty values of what rotors have beside films.
ELEMENTS = 300_000
STOP = 'spring=[{ at = "disk_turbine", gap = "20 um", stiffness = "1e6 N/m", friction = 0.2, damping = "100 N*s/m" }]'
CUBIC = 'spring=[{ at = "journal", stiffness = "1e5 N/m", cubic = "1e15 N/m^3" }]'
ON_BALLS = str(Path(__file__).parents[1] / "data" / "rotor-on-balls.toml")
DRIVEN = ('drive={ start = "20 Hz", torque = "0.5 N*m", duration = "0.1 s", load = "1e-3 N*m/Hz" }',
          "rotor.polar_inertia=2.7e-3 kg*m^2")  # fmt: skip
WITH_ELEMENTS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (ON_BALLS, ()),
    ("turbocharger-ball", (STOP,)),
    ("jeffcott", ("film.theory=short", CUBIC, 'rotor.loss={ time = "0.05 s", unbalance = "5 g*mm" }')),
    ("coast-down", DRIVEN),
    ("blade-loss", ("film.theory=short", 'bow=[{ position = "50 mm", offset = "3 um" }]')),
    ("turbocharger-car-thrust", ()),
)  # fmt: skip


class TooLong(BaseException):
    """A command took longer than it may."""


def trial(seed: int) -> tuple[tuple[str, ...], str, list[str]]:
    """A command, its case, and the settings with two nasty values."""
    chance = random.Random(seed)
    command = COMMANDS[seed % len(COMMANDS)]
    source, settings = BASES[0] if command[0] == "fit" else BASES[chance.randrange(len(BASES))]
    if OVER_TIME <= seed < SURFACES and command[0] != "fit":
        source, settings = BASES[chance.choice((0, HEATED, HEATED))]
    if "--modes" in command and chance.random() < 0.8:
        source, settings = BASES[-1]
    if SURFACES <= seed < ELEMENTS:
        source, settings = TOUCHING[chance.randrange(len(TOUCHING))]
        if command[0] == "response" and "film.cavitation=bubbly" in settings:  # takes more than 400 s of CPU time
            source, settings = TOUCHING[0]
    if seed >= ELEMENTS:
        source, settings = WITH_ELEMENTS[chance.randrange(len(WITH_ELEMENTS))]
        if command[0] == "limit-cycles" and "thrust" in source:  # takes more than 400 s of CPU time, too
            source, settings = WITH_ELEMENTS[0]
    of_films = () if source == ON_BALLS else (MOTION, *NEEDS.get(command[0], ()))
    more = [each for each in (*SHORT_RUN, *of_films) if settings is not DRIVEN or not each.startswith("speed.")]
    settings = (*settings, *more)
    known = [value for value in _base(source, settings) if value.key.partition(".")[0] not in ("name", "title")]
    count = 2 if seed < SURFACES else chance.choice((1, 1, 2))
    if SURFACES <= seed < ELEMENTS:
        known = [value for value in known if value.key.startswith(OF_SURFACES)]
    numbers = [value for value in known if isinstance(value.value, float)]
    nasty = []
    for value in chance.sample(numbers if chance.random() < 0.8 else known, count):
        if isinstance(value.value, str | dict) or chance.random() < 0.05:
            nasty.append(f"{value.key}={chance.choice(WORDS)}")
        elif isinstance(value.value, int):
            nasty.append(f"{value.key}={chance.choice((0, 1, 2, 3, 100, 10**6))}")
        else:
            number = value.value * chance.choice(FACTORS) if chance.random() < 0.8 else chance.choice(PLAIN)
            nasty.append(f"{value.key}={number!r}")
    if OVER_TIME <= seed < SURFACES:
        nasty = [*nasty[: chance.randrange(2)], _over_time(chance)]
    return command, source, [*settings, *nasty]


def _over_time(chance: random.Random) -> str:
    """A setting of an input over time, by nasty points or by a file."""
    key, size = chance.choice(INPUTS)
    sound = chance.random() < 0.5
    file = f'file = "{key}-{"good" if sound else chance.choice((*TABLES, "nowhere"))}.csv"'
    if key == "force":
        return f'force=[{{ at = "journal", {file} }}]'
    if key == "base":
        return f"base={{ {file} }}"
    points = [[chance.choice(TIMES), size * chance.choice(FACTORS)] for _ in range(chance.randrange(1, 5))]
    if sound:
        points = [[time, size * chance.choice(SOUND)] for time in (0.0, 0.05, 1.0)]
    if key == "speed":
        return f"speed={{ {chance.choice((file, f'points = {points}'))} }}"
    return f"{key}={chance.choice((f'{{ {file} }}', str(points)))}"


@functools.cache
def _base(source: str, settings: tuple[str, ...]) -> tuple[values, ...]:  # type: ignore[valid-type]
    return values(load_case(source, settings))


def _too_long(_signal: int, _frame: FrameType | None) -> None:
    raise TooLong


def _is_long(command: str, source: str, settings: list[str]) -> bool:
    """Whether a command makes run-ups that `frb check` expects to take long, or a step of a run-up alone is long: that
    of a shaft so soft that hundreds of its modes are kept."""
    try:
        case: Case = load_case(source, settings)
        cost = run_cost("rundown" if command == "rundown" else "runup", case)
    except FrbError:
        return False
    return cost.total_s > LONGEST_RUN_s.get(command, math.inf) or cost.step_s > LONGEST_STEP_s


@contextlib.contextmanager
def _bound(seconds: float) -> Iterator[None]:
    before = signal.signal(signal.SIGPROF, _too_long)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def tried(seed: int) -> dict[str, object]:
    """What came of a trial, in the folder of this process."""
    command, source, settings = trial(seed)
    words = [source if word == "CASE" else word for word in command]
    words += [word for setting in settings for word in ("--set", setting)]
    told: dict[str, object] = {"seed": seed, "words": words, "code": None, "bad": ""}
    out, said = io.StringIO(), io.StringIO()
    longest = LONGEST_s if seed < SURFACES else COMPILED_s
    begun = time.process_time()
    try:
        with _bound(longest), contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
            if _is_long(command[0], source, settings):
                return told | {"code": "long", "cpu_s": time.process_time() - begun}
            code = frb(words)
        told["code"] = code
        if code not in CODES:
            told["bad"] = said.getvalue()[-2000:]
        elif code and "frb:" not in said.getvalue() and not out.getvalue() + said.getvalue():
            told["bad"] = "says nothing"
    except TooLong:
        told["bad"] = f"takes more than {longest:g} s"
    except BaseException:
        told["bad"] = traceback.format_exc()[-3000:]
    return told | {"cpu_s": time.process_time() - begun}


def measured(path: Path) -> None:
    """A measurement of nothing in particular, over the speeds of the bases."""
    t = np.linspace(0.0, 2.0, 4_001)
    speed = 20.0 + 20.0 * t
    angle = 2.0 * np.pi * (20.0 * t + 10.0 * t**2)
    table = np.stack([t, speed, 5e-6 * np.cos(angle), 5e-6 * np.sin(angle)], axis=1)
    np.savetxt(path, table, delimiter=",", header="t,n,x,y", comments="")


def tables() -> None:
    """The files that inputs over time name."""
    for key, size in INPUTS:
        for name, rows in TABLES.items():
            lines = [f"{t},{x * size if isinstance(x, float) else x}" for t, x in rows]
            Path(f"{key}-{name}.csv").write_text("\n".join(["time,value", *lines]), encoding="utf-8")


def main(folder: str, seeds: list[str]) -> None:
    """A line of JSON for each seed."""
    os.chdir(folder)
    measured(Path("measured.csv"))
    tables()
    for seed in seeds:
        sys.stdout.write(json.dumps(tried(int(seed))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
