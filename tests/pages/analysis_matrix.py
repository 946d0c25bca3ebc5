"""Writes docs/matrix.md, every analysis against every film and feature: `cd tests && python -m pages.analysis_matrix`.

Each cell asks the gate that the analysis itself passes, with a case that has the film or feature.
"""

import re
from collections.abc import Mapping, Sequence

from paths import DOCS

from frbcli.case.reading.load import load_case
from frbcli.errors import Fault, InputError
from frbcli.scene.films import bearing_films
from frbcli.scene.gate.gate import require
from frbcli.scene.gate.rule import (
    BEARING,
    KINEMATIC,
    LADDER,
    ROTATION,
    RUN,
    SPEED_CYCLES,
    SQUEEZE,
    STABILITY,
    WHIRL,
    WHIRLS,
)

PAGE = DOCS / "matrix.md"
MOTION = 'motion = { eccentricity = 0.5, angle = "-60 deg", speed = "20 Hz", frequency = "20 Hz" }'
TWO_PHASE = "film.cavitation=two-phase"
ELROD, BUBBLY = "film.cavitation=elrod", "film.cavitation=bubbly"
TILTS = "film.tilt=follows"
ASKEW = 'bearing.misalignment=["0.1 mrad", "0 mrad"]'
LOBES = "bearing.lobes={count=3, preload=0.5}"
GROOVES = 'bearing.supply={kind="axial-grooves", opening_angle="15 deg", pressure="2 bar"}'
HOLES = 'bearing.supply={{kind="bores", count=6, diameter="2 mm", pressure="2 bar", on="{}"}}'
POCKET = 'bearing.supply={kind="pocket", position="90 deg", opening_angle="30 deg", width="8 mm", pressure="2 bar"}'
SLOTS = 'bearing.supply={kind="axial-slots", count=2, opening_angle="10 deg", length="8 mm", pressure="2 bar"}'
FLOW = 'bearing.supply={kind="circumferential-groove", pressure="2 bar", flow="0.2 l/min"}'
HEAT = 'thermal={model="lumped", supply_temperature="70 degC"}'
OIL = "oil.viscosity={grade='SAE 10W-40'}"
HARMONIC = 'force=[{at="disk", force=["10 N", "0 N"], order=2}]'
TABLE = 'force=[{at="disk", over_time={time=[0, 1000], x=[0, 1]}}]'
GROUND = 'base={acceleration=["2 m/s^2", "0 m/s^2"], order=2, speed="50 Hz"}'
STEP = 'bearing.clearance_steps=[{time="0.1 s", clearance="40 um"}]'
LOSS = 'rotor.loss={time="0.1 s", unbalance="10 g*mm"}'
ROUGH = 'contact={model="asperities", roughness="0.4 um", summit_radius="20 um", summit_density="5e9 1/m^2"}'
SHELL = "contact={policy='elastic', stiffness='1e8 N/m'}"
DAMPER = (
    'bearing.damper={width="20 mm", diameter="50 mm", clearance="80 um", mass="500 g", spring="1e7 N/m", '
    'cavitation="sommerfeld"}'
)
PIN = 'bearing.pin={radius="16 mm", play="0.1 mm", stiffness="1e6 N/m"}'
HOUSING = 'housing={mass="40 kg", mounts=[{stiffness="1e8 N/m"}]}'
SUPPORT = 'bearing.support={mass="2 kg", stiffness="1e7 N/m"}'
THRUST = (
    'thrust_bearing=[{side="right", inner_radius="5 mm", outer_radius="11 mm", pads=4, pad_angle="75 deg", '
    'taper_angle="50 deg", taper="20 um"}]'
)
COLLAR = THRUST.replace("[{", '[{position="30 mm", ')
INNER_GROOVES = tuple(f'bearing.{i}.inner.supply={{kind="circumferential-groove", pressure="3 bar"}}' for i in range(2))
OVER_SPEED = ", ".join(
    [
        'speed=["0 Hz", "300 Hz"]',
        *(f'k{axes}=["1e5 N/m", "2e5 N/m"]' for axes in ("xx", "xy", "yx", "yy")),
        *(f'c{axes}=["10 N*s/m", "20 N*s/m"]' for axes in ("xx", "xy", "yx", "yy")),
    ]
)
SEAL = (
    'bearing=[{kind="single-film", width="20 mm", diameter="25 mm", clearance="35 um"}, '
    f'{{kind="coefficients", name="seal", over_speed={{{OVER_SPEED}}}}}]'
)
FILM = 'kind="single-film", width="5 mm", diameter="7 mm", clearance="15 um"'
SINGLE_FILMS = f'bearing=[{{name="left", position="42 mm", {FILM}}}, {{name="right", position="74 mm", {FILM}}}]'
LIMITED = tuple(f"bearing.{i}.{FLOW.split('.', 1)[1]}" for i in range(2))
FED = tuple(f'bearing.{i}.supply={{kind="circumferential-groove", pressure="2 bar"}}' for i in range(2))
BODY = (
    'housing={position="58 mm", mass="4 kg", inertia="1e-2 kg*m^2", mounts=[{position="20 mm", stiffness="1e8 N/m"}, '
    '{position="90 mm", stiffness="1e8 N/m"}]}',
)
SPRING = '{kind="coefficients", name="seal", stiffness="1e5 N/m"}'

# Row of the table: a shipped case, and what is set in it.
FILMS: dict[str, tuple[str, tuple[str, ...]]] = {
    "half-Sommerfeld, tabulated": ("jeffcott", ()),
    "half-Sommerfeld between axial grooves": ("jeffcott", (GROOVES,)),
    "short bearing": ("jeffcott", ("film.theory=short",)),
    "Sommerfeld": ("jeffcott", ("film.cavitation=sommerfeld",)),
    "Reynolds": ("jeffcott", ("film.cavitation=reynolds",)),
    "penalty": ("jeffcott", ("film.cavitation=penalty",)),
    "Peeken": ("jeffcott", ("film.cavitation=peeken",)),
    "bubbly": ("jeffcott", (BUBBLY,)),
    "Elrod": ("jeffcott", (ELROD,)),
    "two-phase": ("jeffcott", (TWO_PHASE,)),
    "two-phase, published form": ("jeffcott", (TWO_PHASE, "film.two-phase.form=published")),
    "ball bearings in squeeze film dampers": ("turbocharger-ball", ()),
    "floating ring": ("floating-ring", ("film.cavitation=half-sommerfeld",)),
    "floating ring, two-phase": ("floating-ring", (TWO_PHASE,)),
    "floating ring that does not turn": ("floating-ring", ("bearing.ring.spin=blocked",)),
    "floating ring that does not turn, on its elastic shell": ("floating-ring", ("bearing.ring.spin=blocked", SHELL)),
    "floating ring that does not turn, on rough surfaces": (
        "floating-ring",
        ("bearing.ring.spin=blocked", "film.cavitation=half-sommerfeld", ROUGH),
    ),
    "floating ring with a pin": ("floating-ring", ("film.cavitation=half-sommerfeld", PIN)),
    "floating ring with a pin, on its elastic shell": (
        "floating-ring",
        ("film.cavitation=half-sommerfeld", PIN, SHELL),
    ),
    "floating ring with a pin, on rough surfaces": ("floating-ring", (PIN, "film.cavitation=half-sommerfeld", ROUGH)),
    "floating ring with a pin, without weight": (
        "floating-ring",
        ("film.cavitation=half-sommerfeld", PIN, "rotor.gravity=0 m/s^2"),
    ),
    "cartridge": ("turbocharger-car-cartridge", ()),
    "cartridge that does not turn": ("turbocharger-car-cartridge", ("bearing.ring.spin=blocked",)),
    "cartridge that does not turn, on its elastic shells": (
        "turbocharger-car-cartridge",
        ("bearing.ring.spin=blocked", SHELL),
    ),
    "feed holes in the shell": ("jeffcott", (HOLES.format("shell"),)),
    "feed holes in the journal": ("jeffcott", (HOLES.format("journal"),)),
    "pocket": ("jeffcott", (POCKET,)),
    "axial slots": ("jeffcott", (SLOTS,)),
    "lobes": ("jeffcott", (LOBES,)),
    "heat": ("jeffcott", (OIL, HEAT)),
    "clearance steps": ("jeffcott", (STEP,)),
    "elastic contact": ("jeffcott", (SHELL,)),
    "rough surfaces": ("jeffcott", (ROUGH,)),
    "rough surfaces around a floating ring": ("floating-ring", (ROUGH, "film.cavitation=half-sommerfeld")),
    "co-simulation": ("jeffcott", ("film.coupling=co-simulation",)),
    "turbocharger on two bearings": ("turbocharger-heavy", ()),
    "coefficients alone": ("seal", ()),
    "films and coefficients over the speed": ("jeffcott", (SEAL,)),
    "bearings on supports": ("jeffcott", (SUPPORT,)),
    "squeeze film damper that cavitates": ("jeffcott", (DAMPER, "bearing.damper.cavitation=half-sommerfeld")),
    "squeeze film damper, Sommerfeld": ("jeffcott", (DAMPER,)),
    "rigid housing": ("jeffcott", (HOUSING,)),
    "flow-limited supply": ("jeffcott", (ELROD, FLOW)),
    "sealed ends": ("jeffcott", ("bearing.ends={sealed=0.3}",)),
    "stop": ("jeffcott", ('spring=[{at="disk", stiffness="1e6 N/m", gap="30 um"}]',)),
    "magnetic pull": ("jeffcott", ('magnetic_pull=[{at="disk", pull="1e5 N/m"}]',)),
    "constant forces": ("jeffcott", ('force=[{at="disk", force=["10 N", "0 N"]}]',)),
    "harmonic forces": ("jeffcott", (HARMONIC,)),
    "forces over time": ("jeffcott", (TABLE,)),
    "blade loss": ("jeffcott", (LOSS,)),
    "bow": ("jeffcott", ("rotor.bow=10 um",)),
    "free speed": ("coast-down", ()),
    "motion of the ground": ("jeffcott", (GROUND,)),
    "journals that tilt": ("turbocharger-car", (SINGLE_FILMS, TILTS)),
    "floating rings that tilt": ("turbocharger-car", (TILTS,)),
    "floating rings that tilt, grooves, no feed holes, Elrod": (
        "turbocharger-car",
        (TILTS, ELROD, *INNER_GROOVES),
    ),
    "cartridge in tilting films": ("turbocharger-car-cartridge", (TILTS,)),
    "misaligned shells": ("jeffcott", (ASKEW,)),
    "thrust bearing without an axial load": ("jeffcott", (THRUST,)),
    "thrust bearing under an axial load": (
        "turbocharger-car",
        (COLLAR, 'axial={load={at="5000 Hz", load="40 N"}}', "film.cavitation=half-sommerfeld"),
    ),
    "thrust bearings alone": ("thrust", ()),
}

# Pairs of features that a machine may have together.
PUBLISHED = (TWO_PHASE, "film.two-phase.form=published")
APART = "film.coupling=co-simulation"
PAIRS: dict[str, tuple[str, tuple[str, ...]]] = {
    "heat and clearance steps": ("jeffcott", (OIL, HEAT, STEP)),
    "heat and the published form": ("jeffcott", (OIL, HEAT, *PUBLISHED)),
    "heat and co-simulation": ("jeffcott", (OIL, HEAT, APART)),
    "heat and floating rings": ("floating-ring-heat", ()),
    "heat and squeeze film dampers": ("jeffcott", (OIL, HEAT, DAMPER)),
    "clearance steps and the published form": ("jeffcott", (STEP, *PUBLISHED)),
    "blade loss and co-simulation": ("jeffcott", (LOSS, APART)),
    "clearance steps and co-simulation": ("jeffcott", (STEP, APART)),
    "clearance steps and rings that turn": (
        "floating-ring", ('bearing.outer.clearance_steps=[{time="0.1 s", clearance="75 um"}]',)
    ),
    "rings that turn and the published form": ("floating-ring", PUBLISHED),
    "co-simulation and the published form": ("jeffcott", (*PUBLISHED, APART)),
    "co-simulation and harmonic forces": ("jeffcott", (HARMONIC, APART)),
    "co-simulation and rings that turn": ("floating-ring", (APART,)),
    "co-simulation and cartridges that turn": ("turbocharger-car-cartridge", (APART,)),
    "co-simulation and several bearings": ("turbocharger-heavy", (APART,)),
    "heat and mass-conserving films (Elrod)": ("jeffcott", (OIL, HEAT, ELROD)),
    "heat and bubbly oil": ("jeffcott", (OIL, HEAT, BUBBLY)),
    "heat and a flow-limited supply": ("jeffcott", (OIL, HEAT, ELROD, FLOW)),
    "heat and rough surfaces": ("jeffcott", (OIL, HEAT, ROUGH)),
    "heat and an elastic shell": ("jeffcott", (OIL, HEAT, SHELL)),
    "heat and feed holes in the journal": ("jeffcott", (OIL, HEAT, HOLES.format("journal"))),
    "heat and feed holes in a ring that turns": ("floating-ring-heat", ("film.cavitation=half-sommerfeld",)),
    "heat and clearances that follow it": (
        "jeffcott", (OIL, 'thermal={model="lumped", supply_temperature="70 degC", clearance="follows"}')
    ),
    "heat and tilting films": ("turbocharger-car", (SINGLE_FILMS, TILTS, OIL, HEAT)),
    "heat and misaligned shells": ("jeffcott", (OIL, HEAT, ASKEW)),
    "tilting films and bubbly oil": ("turbocharger-car", (SINGLE_FILMS, TILTS, BUBBLY, *FED)),
    "tilting films and a flow-limited supply": (
        "turbocharger-car", (SINGLE_FILMS, TILTS, ELROD, *LIMITED)
    ),
    "tilting films and rough surfaces": ("turbocharger-car", (SINGLE_FILMS, TILTS, ROUGH)),
    "tilting films and an elastic shell": ("turbocharger-car", (SINGLE_FILMS, TILTS, SHELL)),
    "tilting films and bearings on supports": (
        "turbocharger-car", (SINGLE_FILMS, TILTS, *(f"bearing.{i}.{SUPPORT.split('.', 1)[1]}" for i in range(2)))
    ),
    "tilting films and a rigid housing": ("turbocharger-car", (SINGLE_FILMS, TILTS, *BODY)),
    "misaligned shells and bubbly oil": ("jeffcott", (ASKEW, BUBBLY)),
    "misaligned shells and a flow-limited supply": ("jeffcott", (ASKEW, ELROD, FLOW)),
    "misaligned shells and rough surfaces": ("jeffcott", (ASKEW, ROUGH)),
    "rough surfaces and mass-conserving films (Elrod)": ("jeffcott", (ROUGH, ELROD)),
    "rough surfaces and bubbly oil": ("jeffcott", (ROUGH, BUBBLY)),
    "rough surfaces and a flow-limited supply": ("jeffcott", (ROUGH, ELROD, FLOW)),
    "rough surfaces and lobes": ("jeffcott", (ROUGH, LOBES)),
    "bubbly oil and a flow-limited supply": ("jeffcott", (BUBBLY, FLOW)),
    "bubbly oil and feed holes in the journal": ("jeffcott", (BUBBLY, HOLES.format("journal"))),
    "mass-conserving films (Elrod) and feed holes in the journal": ("jeffcott", (ELROD, HOLES.format("journal"))),
}  # fmt: skip


ANALYSES: dict[str, str] = {
    "run": RUN,
    "rotation": ROTATION,
    "squeeze": SQUEEZE,
    "whirl": WHIRL,
    "bearing": BEARING,
    "linear": STABILITY,
    "cycles": SPEED_CYCLES,
    "whirls": WHIRLS,
    "accuracy": LADDER,
}
TOGETHER = "run", "linear", "cycles", "whirls"  # of two features
HEAD = """# What goes with what

Every analysis against every film and feature, by the program's own checks: `cd tests && python -m
pages.analysis_matrix` writes this page. "run" includes run-up, run-down, sweep, fit and compare; "linear" is stability
and response, "cycles" limit cycles, "whirls" whirls with unbalance. Of several films, rotation, squeeze and whirl test
`motion.film`. Numbers are [reasons](#reasons); the messages of the program say more, with remedies.
"""


Reason = tuple[str, str]  # key without the number of a bearing, and problem


def page() -> str:
    """The page in Markdown."""
    reasons: dict[Reason, list[str]] = {}  # with the values of the key
    rows = _table(reasons, FILMS, tuple(ANALYSES))
    rows += ["", "## Two features together", "", *_table(reasons, PAIRS, TOGETHER)]
    notes = [f"{number}. {_sentence(*each)}" for number, each in enumerate(reasons.items(), start=1)]
    return "\n".join([HEAD, *rows, "", "## Reasons", "", *notes, ""])


def _table(
    reasons: dict[Reason, list[str]], cases: Mapping[str, tuple[str, tuple[str, ...]]], names: Sequence[str]
) -> list[str]:
    """What all analyses support, and the others by the analyses that do not, in lines."""
    without: dict[str, list[str]] = {}
    for name, (case, settings) in cases.items():
        numbers = {each: _numbers(reasons, refused(case, settings, ANALYSES[each])) for each in names}
        without.setdefault(_unsupported(numbers), []).append(name)
    everywhere = without.pop("", [])
    rows = [f"| {'; '.join(features)} | {analyses} |" for analyses, features in without.items()]
    return [
        f"Supported by {', '.join(names)}:", "", f"{_grouped(everywhere)}.", "",
        "| feature | not supported by |", "|---|---|", *rows,
    ]  # fmt: skip


def _grouped(names: Sequence[str]) -> str:
    """Names, of pairs the first part once."""
    parts: dict[str, list[str]] = {}
    for name in names:
        first, both, second = name.partition(" and ")
        parts.setdefault(first if both else name, []).extend([second] * bool(both))
    return "; ".join(f"{first} and {', '.join(others)}" if others else first for first, others in parts.items())


def _numbers(reasons: dict[Reason, list[str]], faults: Sequence[Fault]) -> str:
    """The numbers of the reasons, which are added to them."""
    for fault in faults:
        values = reasons.setdefault(_reason(fault), [])
        if fault.value and fault.value not in values:
            values.append(fault.value)
    return ", ".join(str(list(reasons).index(each) + 1) for each in dict.fromkeys(map(_reason, faults)))


def _unsupported(numbers: Mapping[str, str]) -> str:
    """The analyses that have reasons, with these in brackets."""
    by_reason: dict[str, list[str]] = {}
    for name, given in numbers.items():
        if given:
            by_reason.setdefault(given, []).append(name)
    if [len(names) for names in by_reason.values()] == [len(numbers)]:
        return f"all ({next(iter(by_reason))})"
    return "; ".join(f"{', '.join(names)} ({given})" for given, names in by_reason.items())


def _reason(fault: Fault) -> Reason:
    """Key without the number of a bearing, and the first clause of the problem."""
    clause = re.split(r": |; |, so that |, which (?=would|do not)", fault.problem)[0]
    return re.sub(r"\.\d+", "", fault.key), f"{clause.rstrip('.')}."


def _sentence(reason: Reason, values: Sequence[str]) -> str:
    """Why, with the values of the key."""
    key, problem = reason
    first = f"`{key} = {values[0]}`" if values else f"`{key}`"
    return " ".join([", ".join([first, *(f"`{each}`" for each in values[1:])]), problem])


def refused(name: str, settings: Sequence[str], analysis: str) -> tuple[Fault, ...]:
    """The faults of a case in an analysis; empty if it can be computed."""
    try:
        case = load_case(name, [*settings, MOTION] if analysis in KINEMATIC else settings)
        films = [place.name for place in bearing_films(case)]
        if analysis in KINEMATIC and len(films) > 1:
            case = load_case(name, [*settings, MOTION, f"motion.film={films[0]}"])
        require(case, analysis)
    except InputError as error:
        return error.faults
    return ()


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
