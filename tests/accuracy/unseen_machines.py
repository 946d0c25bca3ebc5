"""Random machines: whether what a run states of its events and slow signals holds that of a far finer run.

`cd tests && python -m accuracy.unseen_machines FOLDER SEED...` draws a machine for each seed, runs it with its
uncertainties and at a tenth of the target in half as long steps, keeps both runs in FOLDER, where they are taken from
the next time, and writes a line of JSON for each and the table of docs/accuracy-measured.md.
"""

import json
import math
import random
import statistics
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from frbcli.analysis.uncertainty import SAFETY, partners, slow_uncertainties
from frbcli.case.reading.load import load_case_text
from frbcli.case.schema import Case
from frbcli.results.store import Run
from frbcli.runs.run import runup
from frbcli.scene.planning.plan import make_plan

# The run that others are compared with: its target over their own, and what does not follow from the target.
FINER, MORE_STEPS, MORE_ELEMENTS = 0.1, 2.0, 1.5
KINDS = ("table", "cells", "rings", "heat")
LAWS = ("half-sommerfeld", "reynolds", "penalty", "two-phase")
TARGETS = {"table": 1e-3}  # those of films on cells are larger, so that a tenth of it is within reach
TARGET_ON_CELLS = 1e-2
WHIRLS_AT = 2.7  # times the frequency of the rotor on its shaft and films: where a whirl is expected
GRAVITY = 9.81
NUMBERS = {"speed": ("speed_Hz", "speed_uncertainty_Hz"), "frequency": ("frequency_Hz", "frequency_uncertainty_Hz"),
           "amplitude": ("amplitude", "amplitude_uncertainty")}  # fmt: skip


@dataclass(frozen=True)
class Stated:
    """A number with its uncertainty and its true error, in one unit. quantity: as of NUMBERS, or a slow signal; event:
    its kind, "" of a slow signal; certain: whether the run calls the event so."""

    quantity: str
    event: str
    value: float
    stated: float
    true: float
    certain: bool = True

    @property
    def holds(self) -> bool:
        """Whether the true error is within the uncertainty."""
        return self.true <= self.stated


@dataclass(frozen=True)
class Machine:
    """What a run of a machine states. lacking: events that it calls certain and the fine run does not have; cpu_s: of
    the run, of its second run, of the fine run."""

    seed: int
    kind: str
    law: str
    numbers: tuple[Stated, ...]
    events: int
    lacking: tuple[str, ...]
    status: tuple[str, str]
    cpu_s: tuple[float, float, float]


def kind_of(seed: int) -> tuple[str, str]:
    """Kind and cavitation law of the machine of a seed: each law with each kind once in 16 seeds; tables are those of
    half-Sommerfeld films."""
    kind, law = KINDS[seed % len(KINDS)], LAWS[seed // len(KINDS) % len(LAWS)]
    return kind, LAWS[0] if kind == "table" else law


def drawn(seed: int) -> str:
    """The case file of the machine of a seed."""
    chance, (kind, law) = random.Random(seed), kind_of(seed)
    rings = kind == "rings" or (kind == "heat" and seed // 16 % 2 == 1)
    parts = _in_rings(chance, law) if rings else _in_plain_bearings(chance, kind)
    target = TARGETS.get(kind, TARGET_ON_CELLS)
    film = f'[film]\ncavitation = "{law}"\n' + ('solution = "cells"\n' if kind == "cells" else "")
    return "\n".join([parts, _oil(chance, kind), film, f"[accuracy]\ntarget = {target:g}\n"])


def _oil(chance: random.Random, kind: str) -> str:
    oil = '[oil]\ndensity = "830 kg/m^3"\n'
    if kind != "heat":
        return oil + f'viscosity = "{_about(chance, 12.0):.4g} mPa*s"\n'
    walls = chance.choice(('housing = "80 degC"', 'housing = "adiabatic"'))
    return (
        oil + 'viscosity = { grade = "SAE 10W-40" }\nheat_capacity = "2100 J/(kg*K)"\n'
        'conductivity = "0.14 W/(m*K)"\n[thermal]\nmodel = "lumped"\nshaft = "adiabatic"\n'
        f'{walls}\nsupply_temperature = "{chance.uniform(60.0, 90.0):.3g} degC"\n'
    )


def _in_plain_bearings(chance: random.Random, kind: str) -> str:
    """A rigid or Jeffcott rotor that is expected to whirl within its speeds."""
    mass, diameter = 10.0 ** chance.uniform(0.0, 1.0), chance.uniform(15.0, 35.0)  # kg, mm
    clearance = diameter * chance.uniform(1.0, 1.8)  # um
    on_films = math.sqrt(GRAVITY / (1e-6 * clearance)) / (2.0 * math.pi)
    elastic = chance.random() < 0.6
    on_shaft = chance.uniform(1.2, 3.0) * on_films if elastic else math.inf
    whirls = WHIRLS_AT * on_films / math.hypot(1.0, on_films / on_shaft)
    unbalance = chance.choice((0.0, 0.01, 0.02)) * mass * clearance  # g mm
    top = whirls * (chance.uniform(1.3, 1.7) if kind == "table" else chance.uniform(1.5, 2.0))
    start = 0.0 if kind == "table" else 0.5 * top
    turns = chance.uniform(500.0, 1500.0) if kind == "table" else chance.uniform(200.0, 400.0)
    shaft = (
        f'journal_mass = "{0.02 * mass:.4g} kg"\nshaft_damping = "0.1 N*s/m"\n'
        f'shaft_stiffness = "{1e-3 * mass * (2.0 * math.pi * on_shaft) ** 2:.4g} N/mm"\n'
        if elastic
        else ""
    )
    pressure = 1.0 if kind == "table" else chance.uniform(1.0, 3.0)
    groove = f'kind = "circumferential-groove", pressure = "{pressure:.3g} bar"'
    holes = (
        f'kind = "bores", count = {chance.choice((1, 2, 4))}, diameter = "{0.1 * diameter:.3g} mm", '
        f'position = "{chance.uniform(0.0, 360.0):.0f} deg", pressure = "{pressure:.3g} bar"'
    )
    supply = holes if kind == "cells" and chance.random() < 0.5 else groove
    return f"""
[rotor]
kind = "{"jeffcott" if elastic else "rigid"}"
mass = "{mass:.4g} kg"
unbalance = "{unbalance:.4g} g*mm"
external_damping = "{chance.choice((0.0, 1.0))} N*s/m"
{shaft}
[bearing]
kind = "single-film"
width = "{diameter * chance.uniform(0.5, 1.0):.4g} mm"
diameter = "{diameter:.4g} mm"
clearance = "{clearance:.4g} um"
supply = {{ {supply} }}
[speed]
from = "{start:.4g} Hz"
to = "{top:.4g} Hz"
duration = "{2.0 * turns / (top + start):.4g} s"
"""


def _in_rings(chance: random.Random, law: str) -> str:
    """A Jeffcott rotor in floating rings about as large as those of `floating-ring`."""
    grooved = law == LAWS[0] or chance.random() < 0.5
    inner = (
        'kind = "circumferential-groove"'
        if grooved
        else f'kind = "bores", count = {chance.choice((4, 6))}, diameter = "2.5 mm"'
    )
    pressure = chance.uniform(1.0, 3.0)
    return f"""
[rotor]
kind = "jeffcott"
mass = "{_about(chance, 5.0):.4g} kg"
journal_mass = "{_about(chance, 1.0):.4g} kg"
shaft_stiffness = "{_about(chance, 20000.0):.5g} N/mm"
unbalance = "{_about(chance, 3.0):.3g} g*mm"
external_damping = "1 N*s/m"
shaft_damping = "0.1 N*s/m"
[bearing]
kind = "floating-ring"
ring = {{ mass = "{_about(chance, 75.0):.4g} g", inertia = "{_about(chance, 20.0):.4g} kg*mm^2" }}
[bearing.inner]
width = "{_about(chance, 20.0):.4g} mm"
diameter = "25 mm"
clearance = "{_about(chance, 40.0):.4g} um"
supply = {{ {inner}, pressure = "{pressure:.3g} bar" }}
[bearing.outer]
width = "{_about(chance, 16.0):.4g} mm"
diameter = "40 mm"
clearance = "{_about(chance, 50.0):.4g} um"
supply = {{ kind = "circumferential-groove", pressure = "{pressure:.3g} bar" }}
[speed]
from = "0 Hz"
to = "{chance.uniform(250.0, 450.0):.4g} Hz"
duration = "{chance.uniform(0.8, 1.5):.3g} s"
"""


def _about(chance: random.Random, value: float) -> float:
    return value * 10.0 ** chance.uniform(-0.12, 0.12)


def finer(case: Case) -> Case:
    """The machine at a tenth of the target, in half as long steps and on more elements where the target leaves them as
    they are."""
    at_tenth = case.with_settings(f"accuracy.target={FINER * case.accuracy.target:g}")
    plan, fine = make_plan(case), make_plan(at_tenth)
    settings = [f"accuracy.steps_per_revolution={round(MORE_STEPS * plan.steps_per_revolution)}"]
    if fine.cells is None and fine.mesh == plan.mesh:
        elements = (math.ceil(MORE_ELEMENTS * n) for n in (plan.mesh.axial, plan.mesh.circumferential))
        settings.append(f"accuracy.mesh={list(elements)}")
    return at_tenth.with_settings(*settings)


def tried(seed: int, folder: Path) -> Machine:
    """The machine of a seed beside its finer run."""
    case = load_case_text(drawn(seed))
    run = runup(case, folder / f"{seed}.h5", uncertainty=True)
    fine = runup(finer(case), folder / f"{seed}-fine.h5")
    kind, law = kind_of(seed)
    others = partners(run.events, fine.events)
    lacking = tuple(
        f"{event['kind']} at {event['speed_Hz']:.4g} Hz"
        for event, true in zip(run.events, others, strict=True)
        if true is None and event["certain"]
    )
    numbers = (*_of_events(run.events, others), *_slow(run, fine))
    cpu_s = (run.cost["cpu_s"], run.cost["second_run_cpu_s"], fine.cost["cpu_s"])
    return Machine(seed, kind, law, numbers, len(run.events), lacking, (run.status, fine.status), cpu_s)


def _of_events(events: Sequence[dict[str, Any]], others: Sequence[Any]) -> Iterator[Stated]:
    for event, true in zip(events, others, strict=True):
        for quantity, (key, its_uncertainty) in NUMBERS.items():
            stated = event.get(its_uncertainty)
            if true is not None and stated is not None and true[key] is not None:
                apart = abs(event[key] - true[key])
                yield Stated(quantity, event["kind"], event[key], stated, apart, bool(event["certain"]))


def _slow(run: Run, fine: Run) -> Iterator[Stated]:
    for key, apart in slow_uncertainties(run, fine).items():
        if key in run.error:
            name = key.partition("_uncertainty")[0].replace("_", " ")
            yield Stated(name, "", math.nan, float(run.error[key]), apart / SAFETY)


def rows(machines: Sequence[Machine]) -> Iterator[str]:
    """The table: how many numbers of each quantity and kind of machine are within their uncertainty."""
    yield "| machines | quantity | within the uncertainty | median of the uncertainty over the true error |"
    yield "| --- | --- | --- | --- |"
    quantities = list(dict.fromkeys(each.quantity for machine in machines for each in machine.numbers))
    for kind in (*KINDS, "all"):
        of_kind = [machine for machine in machines if kind in (machine.kind, "all")]
        for quantity in (*quantities, "all"):
            found = [n for machine in of_kind for n in machine.numbers if quantity in (n.quantity, "all")]
            if found:
                median = statistics.median(n.stated / max(n.true, 1e-300) for n in found)
                yield f"| {kind} | {quantity} | {sum(n.holds for n in found)} of {len(found)} | {median:.1f} |"


def main(arguments: list[str]) -> None:
    """See the module."""
    folder, machines = Path(arguments[0]), list[Machine]()
    folder.mkdir(parents=True, exist_ok=True)
    for seed in map(int, arguments[1:]):
        machines.append(tried(seed, folder))
        sys.stdout.write(json.dumps(asdict(machines[-1])) + "\n")
        sys.stdout.flush()
    sys.stdout.write("\n".join(rows(machines)) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
