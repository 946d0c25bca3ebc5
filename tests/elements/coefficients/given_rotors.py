"""Rigid and Jeffcott rotors in bearings of given coefficients."""

import math
from typing import Any

import frbcli
from frbcli.case.reading.load import case_from_dict

M, U, G = 6.0, 3e-6, 9.81  # kg, kg m, m/s^2
K, Q = 1e6, 2e5  # N/m, direct and cross-coupled
C, C_CROSS = 300.0, 40.0  # N s/m
MASS, MASS_CROSS = 0.2, 0.05  # kg
TURN = 2.0 * math.pi


def matrix(direct: float, cross: float, unit: str) -> list[list[str]]:
    """[[d, c], [-c, d]] as a case file has it: d - i c."""
    return [[f"{direct!r} {unit}", f"{cross!r} {unit}"], [f"{-cross!r} {unit}", f"{direct!r} {unit}"]]


def bearing(**keys: object) -> dict[str, Any]:
    """A bearing of the coefficients above."""
    return {
        "kind": "coefficients",
        "name": "seal",
        "stiffness": matrix(K, Q, "N/m"),
        "damping": matrix(C, C_CROSS, "N*s/m"),
        "mass": matrix(MASS, MASS_CROSS, "kg"),
    } | keys


def speed(low: float, high: float, duration: float = 1.0) -> dict[str, str]:
    return {"from": f"{low!r} Hz", "to": f"{high!r} Hz", "duration": f"{duration!r} s"}


def rigid(element: dict[str, Any], *, unbalance: float = U, **tables: object) -> frbcli.Case:
    rotor = {"kind": "rigid", "mass": f"{M} kg", "unbalance": f"{unbalance!r} kg*m"}
    return case_from_dict({"rotor": rotor, "bearing": element, "speed": speed(10.0, 200.0)} | tables, "rigid")


JEFFCOTT = {
    "kind": "jeffcott", "mass": "6 kg", "journal_mass": "0.1 kg", "shaft_stiffness": "5e6 N/m",
    "unbalance": "3e-6 kg*m", "external_damping": "1 N*s/m", "shaft_damping": "0.1 N*s/m",
}  # fmt: skip


def growing_seal(slope: float, top: float = 300.0) -> dict[str, Any]:
    """A bearing whose cross-coupling is `slope` in N/m per rad/s times the speed."""
    q = [0.0, slope * TURN * top]
    columns = {"kxx": [K, K], "kxy": q, "kyx": [-each for each in q], "kyy": [K, K]}
    columns |= {"cxx": [C, C], "cxy": [0.0, 0.0], "cyx": [0.0, 0.0], "cyy": [C, C]}
    with_units = {name: [f"{value!r} {'N/m' if name[0] == 'k' else 'N*s/m'}" for value in values]
                  for name, values in columns.items()}  # fmt: skip
    return {"kind": "coefficients", "name": "seal", "over_speed": {"speed": ["0 Hz", f"{top!r} Hz"], **with_units}}
