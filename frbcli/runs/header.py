"""Names and units of the signals of a run, and the header of its file."""

from __future__ import annotations

import math
import platform
import sys
from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from frbcli.analysis.forced import ForcedLine, forced_references, lines_of_table
from frbcli.analysis.signals import joined
from frbcli.arrays import Array
from frbcli.case.bearing import SIDES
from frbcli.case.schema import Case
from frbcli.elements.pin import pin_torque
from frbcli.elements.spring import law_record
from frbcli.results.columns import AXIAL_SIGNALS
from frbcli.results.store import CLEARANCE_STEP, CRITICAL_SPEED, CRITICAL_SPEEDS, LOSS, Header
from frbcli.rotor.assembly import PLANE
from frbcli.rotor.loads import Harmonic, Tabulated
from frbcli.runs.heat import heat_units
from frbcli.runs.inputs import RunInputs, drive_units
from frbcli.scene.changes import losses_in_time, step_times
from frbcli.scene.machine.rotor import element_parts
from frbcli.scene.machine.system import Segment, System
from frbcli.solve.ring_spin import STIFFNESS

PACKAGES = ("numpy", "scipy", "numba", "scikit-fem", "h5py")
PROGRAM = "frbcli"
# Of a film, by choice: its quantity and unit as in the name, and the unit.
THICKNESS, FORCE, POWER, TORQUE, FLOW = "film-thickness", "force", "power", "torque", "oil-flow"
SHARE, FRICTION = "asperity-share", "contact-power"  # of rough surfaces, always
TILT = "tilt"  # of every film whose journal tilts
SUPPLY = "supply-pressure"  # of every film whose supply changes, see runs/inputs.py
FILM_SIGNALS = {
    FORCE: ("film_force", "N", "N"),
    THICKNESS: ("film_thickness", "m", "m"),
    POWER: ("power", "W", "W"),
    TORQUE: ("torque", "N_m", "N m"),
    FLOW: ("oil_flow", "m3_s", "m^3/s"),
    SHARE: ("asperity_share", "", ""),
    FRICTION: ("contact_power", "W", "W"),
    TILT: ("tilt", "rad", "rad"),
    SUPPLY: ("supply_pressure", "Pa", "Pa"),
}


def named(quantity: str, film: str) -> str:
    """The name of a signal of a film or ring, which may be the only one."""
    return f"{quantity}_{film}" if film else quantity


def turning_rings(system: System) -> list[tuple[str, int]]:
    """The names of the rings that turn and their numbers, which both ends of a cartridge share."""
    around = zip(system.names, system.bodies[:, 0].tolist(), strict=True)
    return [(name.removesuffix("outer").rstrip("_"), ring) for name, ring in around if ring >= 0]


def ring_names(system: System) -> dict[str, int]:
    """The signals of the rings' speeds with the degree of freedom of each."""
    return {f"{named('ring_speed', name)}_Hz": system.spins[ring] for name, ring in turning_rings(system)}


def signal_names(kind: str, film: str) -> list[str]:
    """The signals of a film for a kind of FILM_SIGNALS: x and y of a force and of a tilt."""
    quantity, unit, _ = FILM_SIGNALS[kind]
    ends = (f"_x_{unit}", f"_y_{unit}") if kind in (FORCE, TILT) else (f"_{unit}" if unit else "",)
    return [f"{named(quantity, film)}{end}" for end in ends]


def tilt_names(film: str) -> tuple[str, str, str]:
    """The signals of a film whose journal tilts: its tilts about x and y, and the larger eccentricity of its ends."""
    x, y = signal_names(TILT, film)
    return x, y, named("end_eccentricity", film)


def recorded(case: Case) -> tuple[str, ...]:
    """Kinds of FILM_SIGNALS that a run of a case records."""
    rough = (THICKNESS, SHARE, FRICTION) if case.contact.rough else ()
    return tuple(dict.fromkeys((*case.output.signals, *rough)))


def signal_units(system: System, kinds: Sequence[str]) -> dict[str, str]:
    """Names and units of the signals of all films that are recorded by choice."""
    return {name: FILM_SIGNALS[kind][2] for film in system.names for kind in kinds for name in signal_names(kind, film)}


def pin_names(system: System) -> dict[int, tuple[str, str]]:
    """The signals of the angle and of the torque of each ring with a pin by its number: one pair of a cartridge."""
    names: dict[int, list[str]] = {}
    for name, ring in turning_rings(system):
        if ring < len(system.pins) and system.pins[ring, STIFFNESS] > 0.0:
            names.setdefault(ring, []).append(name)
    own = {
        ring: ends[0] if len(ends) == 1 else ends[0].removesuffix(SIDES[0]).rstrip("_") for ring, ends in names.items()
    }
    return {ring: (f"{named('pin_angle', name)}_rad", f"{named('pin_torque', name)}_N_m") for ring, name in own.items()}


def pin_units(system: System) -> dict[str, str]:
    """Names and units of the signals of pins."""
    return {name: unit for pair in pin_names(system).values() for name, unit in zip(pair, ("rad", "N m"), strict=True)}


def pin_signals(system: System, q: Array, v: Array) -> dict[str, Array]:
    """The signals (k,) of pins, of displacements q and velocities v (k, n)."""
    signals: dict[str, Array] = {}
    for ring, (angle, torque) in pin_names(system).items():
        signals[angle] = q[:, system.spins[ring]].copy()
        signals[torque] = pin_torque(system.pins[ring], signals[angle], v[:, system.spins[ring]])
    return signals


def port_units(system: System) -> dict[str, str]:
    """Names and units of the signals of forces that are not linear."""
    still, zero = np.zeros((1, system.rotor.size)), np.zeros(1)
    of_ports = (port.signals(still, still, zero, zero) for port in system.rotor.ports)
    return {name: unit for signals in of_ports for name, (unit, _) in signals.items()}


def header(
    command: str, case: Case, segments: Sequence[Segment], critical_speeds: Sequence[float] | None = None
) -> Header:
    """The header of the file of a run. Amplitudes refer to its initial clearances; critical_speeds: of
    the linearised machine in Hz, ascending, None if they are not known."""
    system = segments[0].system
    lengths = [f"{name}_{axis}_m" for name, _ in system.rotor.points for axis in "xy"]
    eccentricities = [named("eccentricity", name) for name in system.names]
    units = {"time_s": "s", "speed_Hz": "Hz", **dict.fromkeys(eccentricities, ""), **dict.fromkeys(lengths, "m")}
    if system.films.coordinates > len(PLANE):
        for name in system.names:
            units |= dict(zip(tilt_names(name), ("rad", "rad", ""), strict=True))
    remembering = [name for name, keeps in zip(system.names, system.remembering, strict=True) if keeps]
    units |= dict.fromkeys((named("oil_fraction", name) for name in remembering), "")
    units |= dict.fromkeys(ring_names(system), "Hz")
    units |= pin_units(system) | port_units(system)
    units |= {column.name: column.unit for column in AXIAL_SIGNALS} if case.loads_a_collar else {}
    units |= drive_units(system)
    units |= RunInputs.of(case, system).units() | heat_units(case, system)
    units |= signal_units(system, recorded(case))
    return Header(
        title=case.heading,
        command=command,
        case_name=case.name,
        case_text=case.source_text,
        units=units,
        versions={PROGRAM: version_of(PROGRAM), "python": platform.python_version()}
        | {package: version_of(package) for package in PACKAGES}
        | law_record(case),
        references=({} if system.names else {"length_m": system.length})
        | ({"contact_eccentricity": case.contact.eccentricity, "clearance_m": system.length} if system.names else {})
        | {named("clearance_m", name): length for name, length in zip(system.names, system.clearances, strict=True)}
        | _numbered(CLEARANCE_STEP, [(time, "") for time in step_times(case)])
        | _numbered(LOSS, losses_in_time(case))
        | forced_references(forcing(case)[0])
        | ({} if critical_speeds is None else {CRITICAL_SPEEDS: float(len(critical_speeds))})
        | {f"{CRITICAL_SPEED}_{number}_Hz": speed for number, speed in enumerate(critical_speeds or (), start=1)},
    )


def _numbered(change: str, times: Sequence[tuple[float, str]]) -> dict[str, float]:
    """References of sudden changes at times in s, each with the name of the part that changes."""
    return {joined(change, str(number), name, "s"): time for number, (time, name) in enumerate(times, start=1)}


def forcing(case: Case) -> tuple[list[ForcedLine], list[str]]:
    """What forces the machine of a case in addition to its unbalance: harmonics except order 1, and the largest lines
    of tables over time; and the names of tables whose lines do not hold nearly all of their change."""
    lines, broad = list[ForcedLine](), list[str]()
    for _, load in element_parts(case).loads:
        if isinstance(load, Tabulated):
            frequencies, whole = lines_of_table(load.times, load.factors(load.times, load.times).T)
            lines += [ForcedLine(frequency_Hz=frequency) for frequency in frequencies]
            broad += [] if whole else [load.name]
        elif isinstance(load, Harmonic) and not load.synchronous:
            lines.append(ForcedLine(abs(load.frequency) / (2.0 * math.pi), abs(load.order)))
    return list(dict.fromkeys(lines)), list(dict.fromkeys(broad))


@cache
def version_of(package: str) -> str:
    """The version of an installed package, as it is written into runs. What is imported says it by itself, at once."""
    version_here = getattr(sys.modules.get(package), "__version__", None)
    try:
        return version_here or version(package)
    except PackageNotFoundError:  # run from a checkout that is not installed
        return "unknown"
