"""Rotors of textbooks and standards in bearings of given coefficients, against printed figures and closed forms."""

import json
import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.case.reading.settings import to_toml
from frbcli.linear.stability import stability
from frbcli.rotor.beam import BeamSection
from frbcli.scene.machine.turbocharger import shaft_of
from pages.textbook_rows import CLOSED, PRINTED, PROGRAM, Bench, Row

TURN = 2.0 * math.pi
STEEL: dict[str, Any] = {"density": 7810.0, "youngs_modulus": 211e9, "poisson_ratio": 211.0 / (2 * 81.2) - 1.0}
FRISWELL = "Friswell et al. 2010, example {}"
EULER = "Euler's beam leaves out shear and rotary inertia."
COARSE = "Six elements of 0.25 m lie above the exact frequencies."
PEAKS, AT_REST = "ROSS, response peaks", "mode {} at rest, rad/s"
GRID = (
    "Backward whirls fall with the speed, and the first critical speed lies below 14.610 Hz, the frequency at rest. "
    "Peaks on a grid of speeds would explain the figures."
)
RAPPID = "RAPPID"
LUMPED = "A shaft of 7 lumped stations is coarse for the second and third pair of modes."
STILL = 1e-3  # Hz, for a rotor at rest


def on_springs(rotor: dict[str, Any], stiffness: Any, damping: float, top: float) -> frbcli.Case:
    """A symmetric rotor in two equal bearings; top: highest speed in Hz."""
    bearing = {"kind": "coefficients", "stiffness": stiffness, "damping": damping}
    speed = {"from": 0.0, "to": top, "duration": 1.0}
    return case_from_dict({"rotor": {"gravity": 0.0} | rotor, "bearing": bearing, "speed": speed}, "textbook")


def on_shaft(
    sections: Sequence[dict[str, Any]], disks: Sequence[dict[str, Any]], bearings: Sequence[tuple[float, Any]],
    top: float, damping: float = 0.0,
) -> frbcli.Case:  # fmt: skip
    """A shaft with disks on springs; bearings: their positions in m and stiffnesses in N/m."""
    held = [
        {"kind": "coefficients", "name": f"b{n}", "position": place, "stiffness": stiffness, "damping": damping}
        for n, (place, stiffness) in enumerate(bearings)
    ]
    return case_from_dict(
        {
            "rotor": {"kind": "turbocharger", "gravity": 0.0},
            "shaft": [STEEL | section for section in sections],
            "disk": list(disks),
            "bearing": held,
            "speed": {"from": 0.0, "to": top, "duration": 1.0},
        },
        "textbook",
    )


def disk(position: float, diameter: float, unbalance: float = 0.0) -> dict[str, float]:
    """A steel disk 70 mm wide with a bore of 50 mm."""
    bore, width = 0.05, 0.07
    mass = 7810.0 * math.pi / 4.0 * (diameter**2 - bore**2) * width
    squares = diameter**2 + bore**2
    return {"position": position, "mass": mass, "polar_inertia": mass * squares / 8.0,
            "diametral_inertia": mass * (squares / 16.0 + width**2 / 12.0), "unbalance": unbalance}  # fmt: skip


def reduction_error(case: frbcli.Case) -> float:
    """Relative error of critical speeds that the plan states for the modes it keeps."""
    kept = shaft_of(case).reduction
    assert kept is not None
    return kept.frequency


def whirls(case: frbcli.Case, speed_Hz: float) -> list[float]:
    """Circular frequencies of the damped modes at a rotor speed, ascending."""
    return sorted(TURN * mode.frequency_Hz for mode in frbcli.damped_modes(case, speed_Hz).modes)


def nearest(found: Sequence[float], expected: float) -> float:
    """The value that is nearest to an expected one."""
    return min(found, key=lambda each: abs(each - expected))


def jeffcott() -> list[Row]:
    """Peak of r^2 / |1 - r^2 + 2 i zeta r| at 1 / sqrt(1 - 2 zeta^2)."""
    mass, stiffness, damping, unbalance, low = 2.0, 1e6, 100.0, 1e-6, 12000.0 / 60.0
    case = on_springs({"kind": "rigid", "mass": mass, "unbalance": unbalance}, stiffness, damping, 300.0)
    (peak,) = frbcli.response(case, operating_Hz=(low, 250.0)).critical_speeds
    natural = math.sqrt(2.0 * stiffness / mass)
    ratio = damping / (mass * natural)
    speed, height = 1.0 / math.sqrt(1.0 - 2.0 * ratio**2), 0.5 / (ratio * math.sqrt(1.0 - ratio**2))
    sides = np.sqrt(np.roots([1.0 - 2.0 / height**2, 4.0 * ratio**2 - 2.0, 1.0]).real)
    factor = speed / abs(float(sides[1] - sides[0]))
    critical, error = speed * natural / TURN, peak.speed_uncertainty_Hz / peak.speed_Hz
    assert peak.amplitude is not None
    assert peak.amplification_factor is not None
    assert peak.separation_margin is not None
    found = peak.amplification_factor
    margins = [17.0 * (1.0 - 1.0 / (each - 1.5)) for each in (factor, found)]
    decrement = TURN * ratio / math.sqrt(1.0 - ratio**2)
    jeffcott, api_684, api_617 = (
        partial(Row, "Laval rotor, damping ratio 0.05", source, CLOSED)
        for source in ("Jeffcott 1919; Genta 2005", "API RP 684", "API 617")
    )
    return [
        jeffcott("critical speed, Hz", critical, peak.speed_Hz, error, 1e-4),
        jeffcott("amplitude, um", 1e6 * height * unbalance / mass, 1e6 * peak.amplitude, 1e-3, 1e-3),
        api_684("amplification factor", factor, found, 1e-3, 1e-3),
        api_617("required margin, %", *margins, 1e-3, 1e-3),
        api_617("margin to 12000 rpm", 1.0 - critical / low, peak.separation_margin, error, 1e-3),
        api_617("logarithmic decrement", decrement, peak.logarithmic_decrement, math.nan, 1e-6),
    ]


def balance_grade() -> list[Row]:
    """G 2.5 permits a mass eccentricity of 2.5 mm/s over the speed, about which a rotor turns far above its critical
    speed."""
    mass, speed, grade = 6.0, 900.0, 2.5e-3
    unbalance = grade * mass / (TURN * speed)
    case = on_springs({"kind": "rigid", "mass": mass, "unbalance": unbalance}, 1e4, 0.0, 1000.0)
    motion = float(frbcli.response(case, [speed]).amplitude[0].max())
    share = 1.0 - 2e4 / mass / (TURN * speed) ** 2
    row = partial(Row, "rigid rotor, G 2.5 at 900 Hz", "ISO 21940-11", CLOSED)
    return [row("whirl of the shaft, um", 1e6 * grade / (TURN * speed * share), 1e6 * motion, math.nan, 1e-6)]


def internal_damping() -> list[Row]:
    rotor = {"kind": "jeffcott", "mass": 10.0, "journal_mass": 1e-3, "shaft_stiffness": 1e6, "external_damping": 40.0,
             "internal_damping": 20.0}  # fmt: skip
    found = stability(on_springs(rotor, 1e13, 0.0, 300.0)).threshold
    assert found is not None
    expected = math.sqrt(1e6 / 10.0) * (1.0 + 40.0 / 20.0) / TURN
    row = partial(Row, "Laval rotor, internal damping, c_e/c_i = 2", "Kimball 1924; Genta 2005", CLOSED)
    return [row("threshold, Hz", expected, found.speed_Hz, found.speed_uncertainty_Hz / found.speed_Hz, 1e-6)]


def orthotropic() -> list[Row]:
    stiffness = [[1e6, 0.0], [0.0, 1.5e6]]
    case = on_springs({"kind": "rigid", "mass": 2.0, "unbalance": 1e-6}, stiffness, 0.0, 300.0)
    name, source = "rigid rotor in orthotropic bearings", "Genta 2005"
    rows = []
    for n, (k, peak) in enumerate(zip((1e6, 1.5e6), frbcli.response(case).critical_speeds, strict=True), 1):
        quantity, error = f"critical speed {n}, Hz", peak.speed_uncertainty_Hz / peak.speed_Hz
        rows.append(Row(name, source, CLOSED, quantity, math.sqrt(k) / TURN, peak.speed_Hz, error, 1e-6))
    return rows


def cross_coupling() -> list[Row]:
    """m s^2 + c s + k - i q = 0 of x + i y."""
    mass, stiffness, damping, cross = 5.0, 1e6, 200.0, 2e5
    matrix = [[stiffness, cross], [-cross, stiffness]]
    case = on_springs({"kind": "rigid", "mass": mass}, matrix, damping, 300.0)
    roots = np.roots([mass, 2.0 * damping, 2.0 * stiffness - 2j * cross])
    expected = max(roots.tolist(), key=lambda root: root.real)
    found = max(stability(case, [100.0]).points[0].eigenvalues.tolist(), key=lambda value: value.real)
    name, source = "rigid rotor in cross-coupled seals", "Childs 1993"
    return [
        Row(name, source, CLOSED, "growth, 1/s", expected.real, found.real, math.nan, 1e-9),
        Row(name, source, CLOSED, "whirl, rad/s", abs(expected.imag), abs(found.imag), math.nan, 1e-9),
    ]


def rigid_body() -> list[Row]:
    """Translation by 2 k / m, cones by Id w^2 - Ip Omega w - 2 k a^2 = 0."""
    mass, polar, diametral, half, wide, stiffness, speed = 20.0, 0.3, 0.5, 0.2, 1.0, 1e6, 200.0
    solid = {"length": 2 * half, "diameter": wide, "density": 1.0}
    wheel = {"position": half, "mass": mass, "polar_inertia": polar, "diametral_inertia": diametral}
    case = on_shaft([solid], [wheel], [(0.0, stiffness), (2 * half, stiffness)], 300.0)
    own = math.pi / 4 * wide**2 * 2 * half  # of the shaft, kg
    mass, polar = mass + own, polar + own * wide**2 / 8
    diametral += own * (wide**2 / 16 + (2 * half) ** 2 / 12)
    cones = np.abs(np.roots([diametral, -polar * TURN * speed, -2 * stiffness * half**2]))
    found = whirls(case, speed)
    backward, forward = sorted(cones.tolist())
    name, source = "rigid rotor on springs at 200 Hz", "Friswell et al. 2010; Genta 2005"
    error = reduction_error(case)
    return [
        Row(name, source, CLOSED, f"{quantity}, rad/s", expected, nearest(found, expected), error, 1e-5)
        for quantity, expected in (
            ("backward cone", backward), ("translation", math.sqrt(2 * stiffness / mass)), ("forward cone", forward)
        )
    ]  # fmt: skip


def beams() -> list[Row]:
    rows = []
    length, bore = 1.0, 0.01
    for name, section in (
        ("slender solid shaft, 10 mm by 1 m", BeamSection(length, bore, 0.0, 7810.0, 211e9, 0.3)),
        ("slender tube, 10 mm and 8 mm by 1 m", BeamSection(length, bore, 0.008, 7810.0, 211e9, 0.3)),
    ):
        part = {"length": length, "diameter": section.diameter, "inner_diameter": section.inner_diameter}
        speed = math.sqrt(section.youngs_modulus * section.second_moment / (section.density * section.area)) / TURN
        case = on_shaft([part], [], [(0.0, 1e11), (length, 1e11)], 300.0)
        held = [
            mode.frequency_Hz for mode in frbcli.natural_modes(case, speeds_Hz=[0.0], stiffness=1e11).points[0].modes
        ]
        loose = frbcli.natural_modes(case, speeds_Hz=[0.0]).points[0].modes
        free = next(mode.frequency_Hz for mode in loose if mode.frequency_Hz > 1.0)
        euler = "Euler; Timoshenko, Young 1955"
        bends = sorted(each for each in held if each > 1.0)
        for n, found in enumerate(bends[:4:2], 1):
            quantity = f"supported, mode {n}, Hz"
            rows.append(Row(name, euler, CLOSED, quantity, (n * math.pi) ** 2 * speed, found, math.nan, 2e-3, EULER))
        rows.append(
            Row(name, euler, CLOSED, "free, Hz", 4.730041**2 * speed, free, math.nan, 2e-3, EULER)
        )
    return rows


def timoshenko() -> list[Row]:
    """A simply supported beam: rho I (rho/kG) w^4 - (rho A + rho I b^2 + (E I rho / kG) b^2) w^2 + E I b^4 = 0 over
    its area, b = n pi / L."""
    part = {"length": 0.4, "diameter": 0.08}
    own = BeamSection(0.4, 0.08, 0.0, 7810.0, 211e9, STEEL["poisson_ratio"])
    case = on_shaft([part], [], [(0.0, 1e13), (0.4, 1e13)], 300.0)
    found = [mode.frequency_Hz for mode in frbcli.natural_modes(case, 1e13, [0.0]).points[0].modes]
    rows = []
    for n in (1, 2):
        wave = n * math.pi / 0.4
        bending = own.youngs_modulus * own.second_moment
        line, rotary = own.density * own.area, own.density * own.second_moment
        shear = own.shear_stiffness
        squares = np.roots([
            rotary * line / shear, -(line + rotary * wave**2 + bending * line / shear * wave**2), bending * wave**4
        ])  # fmt: skip
        expected = math.sqrt(min(squares)) / TURN
        name = "thick shaft, 80 mm by 400 mm, simply supported"
        near = nearest(found, expected)
        rows.append(Row(name, "Timoshenko 1921", CLOSED, f"mode {n}, Hz", expected, near, math.nan, 1e-3))
    return rows


def sense(frequency: float) -> str:
    """Of the whirl exp(i w t) of x + i y."""
    return "forward" if frequency > 0.0 else "backward"


def overhung() -> list[Row]:
    """A disk at the overhang b of a massless shaft in rigid bearings a apart: its flexibility in force and moment."""
    a, b, d, mass, polar, diametral, speed = 0.4, 0.2, 0.03, 8.0, 0.08, 0.045, 150.0
    own = BeamSection(a + b, d, 0.0, 1.0, 211e9, STEEL["poisson_ratio"])
    bending, shear = own.youngs_modulus * own.second_moment, own.shear_stiffness
    both = b * (2 * a + 3 * b) / (6 * bending) + b / (a * shear)
    flexibility = [
        [b**2 * (a + b) / (3 * bending) + (b**2 / a + b) / shear, both],
        [both, (a + 3 * b) / (3 * bending) + 1.0 / (a * shear)],
    ]
    wheel = {"position": a + b, "mass": mass, "polar_inertia": polar, "diametral_inertia": diametral}
    part = {"length": a + b, "diameter": d, "density": 1.0}
    case = on_shaft([part], [wheel], [(0.0, 1e13), (a, 1e13)], 300.0)
    inertia, stiffness = np.diag([mass, diametral]), np.linalg.inv(np.array(flexibility))
    turning, none = np.diag([0.0, polar * TURN * speed]), np.zeros((2, 2))
    first = np.block([[none, np.eye(2)], [np.linalg.solve(inertia, stiffness), np.linalg.solve(inertia, turning)]])
    expected = sorted(np.linalg.eigvals(first).real.tolist(), key=abs)[:3]  # of v = q exp(i w t)
    found, error = whirls(case, speed), reduction_error(case)
    name, source = "overhung disk on a massless shaft at 150 Hz", "Stodola 1924; Genta 2005"
    return [
        Row(name, source, CLOSED, f"{sense(w)} whirl, rad/s", abs(w), nearest(found, abs(w)), error, 5e-4)
        for w in expected
    ]  # fmt: skip


def disk_in_the_middle() -> list[Row]:
    length, d, mass = 0.8, 0.03, 12.0
    own = BeamSection(length, d, 0.0, 1.0, 211e9, STEEL["poisson_ratio"])
    bending = own.youngs_modulus * own.second_moment
    stiffness = 1.0 / (length**3 / (48 * bending) + length / (4 * own.shear_stiffness))
    wheel = {"position": length / 2, "mass": mass, "unbalance": 1e-6}
    part = {"length": length, "diameter": d, "density": 1.0}
    case = on_shaft([part], [wheel], [(0.0, 1e12), (length, 1e12)], 100.0)
    peak = frbcli.response(case).critical_speeds[0]
    row = partial(Row, "disk in the middle of a massless shaft", "Timoshenko, Young 1955", CLOSED)
    natural = math.sqrt(stiffness / mass) / TURN
    return [row("critical speed, Hz", natural, peak.speed_Hz, reduction_error(case), 5e-4)]


def friswell() -> list[Row]:
    rows = []
    whole = [{"length": 1.5, "diameter": 0.05}]
    two = [disk(0.5, 0.28), disk(1.0, 0.35)]
    ends = [(0.0, 1e6), (1.5, 1e6)]
    unlike = [(place, [[1e6, 0.0], [0.0, 0.8e6]]) for place, _ in ends]
    printed: list[tuple[str, frbcli.Case, dict[float, tuple[float, ...]]]] = [
        ("5.9.1", on_shaft(whole, two, ends, 100.0), {0.0: (86.66, 86.66, 274.31, 274.31, 716.78),
                                                      4000.0: (85.39, 87.80, 251.78, 294.71, 600.18)}),
        ("5.9.2", on_shaft(whole, two, unlike, 100.0), {0.0: (82.65, 86.66, 254.52, 274.31, 679.49),
                                                        4000.0: (82.33, 86.86, 239.64, 287.25, 583.49)}),
        ("5.9.9", on_shaft(whole, [disk(1.5, 0.35)], [(0.0, 1e7), (1.0, 1e7)], 100.0),
         {0.0: (90.14, 90.14, 630.73, 630.73), 4000.0: (76.19, 103.91, 565.99)}),
    ]  # fmt: skip
    for example, case, figures in printed:
        error, name = reduction_error(case), "two disks" if len(case.disks) > 1 else "overhung disk"
        row = partial(Row, name, FRISWELL.format(example), PRINTED)
        for rpm, expected in figures.items():
            found = whirls(case, max(rpm / 60.0, STILL))
            for n, value in enumerate(expected):
                why = COARSE if value > 600.0 else ""
                rows.append(row(f"mode {n + 1}, {rpm:g} rpm, rad/s", value, found[n], error, 5e-4, why))
    return rows


def ross() -> list[Row]:
    """Its example of two disks of 0.28 m, with unlike stiffnesses of the bearings."""
    wheels = [disk(0.5, 0.28, 1e-5), disk(1.0, 0.28)]
    unlike = [(place, [[1e6, 0.0], [0.0, 0.8e6]]) for place in (0.0, 1.5)]
    case = on_shaft([{"length": 1.5, "diameter": 0.05}], wheels, unlike, 150.0)
    error, name = reduction_error(case), "example rotor of ROSS, undamped"
    found = frbcli.response(case).critical_speeds
    rows = [
        Row(name, PEAKS, PROGRAM, f"critical speed {n}, Hz", value, peak.speed_Hz, error, 4e-3, GRID)
        for n, (value, peak) in enumerate(zip((14.64, 15.28, 43.13, 47.75, 101.22, 137.99), found, strict=True), 1)
    ]  # fmt: skip
    still = whirls(case, STILL)
    rows += [
        Row(name, "ROSS, documentation", PRINTED, AT_REST.format(n), value, still[n - 1], error, 1e-3)
        for n, value in enumerate((91.79655318, 96.28899977), 1)
    ]  # fmt: skip
    moving = [each / TURN for each in whirls(case, 500.0 / 60.0)]
    rows += [
        Row(name, RAPPID, PROGRAM, f"mode {n + 1}, 500 rpm, Hz", value, moving[n], error, 0.1, LUMPED if n > 1 else "")
        for n, value in enumerate((14.6152, 15.3284, 43.3459, 46.9251, 105.902, 112.760))
    ]  # fmt: skip
    return rows


def file_of_ross(last: float, **dampings: float) -> frbcli.Case:
    """A shaft of 60 mm, a cone to `last` m behind it and 10 kg at its end, as a file of ROSS has them; dampings: alpha
    and beta."""
    alike = {"idl": 0.0, "odl": 0.06, "idr": 0.0, **dampings}
    material = {"name": "Steel", "rho": 7810.0, "E": 211e9, "G_s": 81.2e9}
    data: dict[str, Any] = {
        f"ShaftElement_{n}": {"n": n, "L": length, "odr": end, "material": material, **alike}
        for n, (length, end) in enumerate(((0.25, 0.06), (0.25, 0.06), (0.3, last)))
    }
    data["DiskElement_0"] = {"n": 3, "m": 10.0, "Id": 0.02, "Ip": 0.04}
    held = {"kind": "coefficients", "stiffness": 1e9, "damping": 100.0}
    tables = {
        "rotor": {"kind": "turbocharger", "gravity": 0.0, "file": "rotor.json"},
        "bearing": [held | {"name": f"b{n}", "position": place} for n, place in enumerate((0.0, 0.5))],
        "speed": {"from": 0.0, "to": 100.0, "duration": 1.0},
    }
    with TemporaryDirectory() as folder:
        (Path(folder) / "rotor.json").write_text(json.dumps(data), encoding="utf-8")
        return frbcli.load_case_text(to_toml(tables), folder=Path(folder), name="ross")


def ross_files() -> list[Row]:
    cone, damped = file_of_ross(0.02), file_of_ross(0.06, alpha=20.0, beta=1e-4)
    values = stability(damped, [0.01]).points[0].eigenvalues
    slow = sorted((each for each in values.tolist() if each.imag > 1.0), key=abs)[::2]
    name, error = "shaft with a cone of 60 to 20 mm", reduction_error(cone)
    found = whirls(cone, STILL)[::2]
    rows = [
        Row(name, "ROSS, many elements", PROGRAM, f"mode {n}, Hz", value, found[n - 1] / TURN, error, 2e-3)
        for n, value in ((1, 83.67), (2, 274.5))
    ]
    three = "Its three elements have this mode 0.5 % too fast; damping grows with the square."
    row = partial(Row, "shaft with alpha 20 1/s and beta 0.1 ms", "ROSS, three elements", PROGRAM)
    error = reduction_error(damped)
    return rows + [
        row(f"growth {n}, 1/s", value, slow[n - 1].real, error, bound, why)
        for n, value, bound, why in ((1, -23.2, 2.5e-3, ""), (2, -631.0, 0.01, three))
    ]


ROTORS: tuple[Bench, ...] = (
    jeffcott, balance_grade, internal_damping, orthotropic, cross_coupling, rigid_body, beams, timoshenko, overhung,
    disk_in_the_middle, friswell, ross, ross_files,
)  # fmt: skip
