"""Force laws that were added from Python: a [[spring]] of this process takes them by their names."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np

from frbcli.arrays import Array
from frbcli.rotor.port import ANSWER, MOTION, V_XX, XX, ForceLaw, by_differences

_NAME = re.compile("[a-z][a-z0-9-]{0,39}")
_own: dict[str, type[ForceLaw]] = {}
# Motions at which a law is tried: displacements and velocities over its length and a speed in rad/s
PLACES = ((0.0, 0.0), (0.1, 0.2), (0.5, -1.2), (-2.0, 0.7))
SPEEDS, ANGLE = (0.0, 600.0), 0.3
WRONG = 1e-2  # share of the largest derivative by which a given one may differ from differences of the force


def add_force_law(name: str, law: type[ForceLaw]) -> None:
    """Let the key `law` of a [[spring]] take a force law in this process.

    Parameters
    ----------
    name : str
        Its name in cases: small letters, digits and -. A law of the same name that was added before is replaced.
    law : type[ForceLaw]
        A dataclass on ForceLaw; its fields are the `numbers` of the [[spring]].

    Raises
    ------
    ValueError
        If the name has other characters, or the class is no such dataclass.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.add_force_law("fifth-power", FifthPower)  # doctest: +SKIP
    """
    if not _NAME.fullmatch(name):
        raise ValueError(f"{name!r}: write the name of a law with small letters, digits and -")
    if not (isinstance(law, type) and issubclass(law, ForceLaw) and is_dataclass(law)):
        raise ValueError(f"{law!r} is no dataclass on frbcli.ForceLaw")
    if not law.has_derivatives() and law.push is ForceLaw.push:
        raise ValueError(f"{law.__name__} has neither a function force nor a function push")
    _own[name] = law


def remove_force_law(name: str) -> None:
    """Remove a force law that add_force_law has added.

    Parameters
    ----------
    name : str
        Name of the law.

    Raises
    ------
    KeyError
        For any other law.

    Examples
    --------
    >>> import frbcli
    >>> frbcli.remove_force_law("fifth-power")  # doctest: +SKIP
    """
    del _own[name]


def own_laws() -> Mapping[str, type[ForceLaw]]:
    """The laws of this process by their names."""
    return dict(_own)


def keys_of(law: type[ForceLaw]) -> dict[str, str]:
    """The fields of a law, each with its unit, "" of a plain number."""
    assert is_dataclass(law)
    return {field.name: law.units.get(field.name, "") for field in fields(law)}


def problem_of(law: ForceLaw) -> str:
    """What is wrong with the forces of a law at some motions, or nothing: before anything is computed."""
    for motion in _motions(law):
        answer = law.plainly(motion)
        if not np.all(np.isfinite(answer)):
            return f"has no finite force or derivative at {_words(motion)}"
    if not law.has_derivatives():
        return ""
    worst = ""
    for motion in _motions(law):  # a force that has a corner at one of them is not wrong
        given, differences = law.plainly(motion), np.zeros(ANSWER)
        by_differences(_force, law, law.length, motion, differences)
        off = [_off(given[part], differences[part]) for part in (slice(XX, V_XX), slice(V_XX, ANSWER))]
        if max(off) <= WRONG:
            return ""
        worst = f"has derivatives that differ from those of its force by {100 * max(off):.2g} % at {_words(motion)}"
    return worst


def fingerprint(law: ForceLaw) -> str:
    """Digest of the forces of a law to nine digits: laws of one name that differ have different ones."""
    forces = np.array([law.plainly(motion)[:XX] for motion in _motions(law)])
    size = float(np.abs(forces).max()) or 1.0
    words = " ".join(f"{value:.8e}" for value in np.round(forces / size, 9).ravel() + 0.0)
    return hashlib.sha256(f"{size:.8e} {words}".encode()).hexdigest()[:16]


def _motions(law: ForceLaw) -> list[Array]:
    found = []
    for speed in SPEEDS:
        for (d_x, d_y), (v_x, v_y) in zip(PLACES, PLACES[1:] + PLACES[:1], strict=True):
            moved = law.length * np.array([d_x, d_y]), law.length * max(speed, 60.0) * np.array([v_x, v_y])
            found.append(np.concatenate([*moved, [speed, ANGLE]]))
    return found


def _force(d_x: float, d_y: float, v_x: float, v_y: float, omega: float, law: ForceLaw) -> tuple[float, float]:
    f_x, f_y = law.plainly(np.array([d_x, d_y, v_x, v_y, omega, ANGLE]))[:XX]
    return float(f_x), float(f_y)


def _off(given: Array, differences: Array) -> float:
    size = float(np.abs(differences).max())
    worst = float(np.abs(given - differences).max())
    return worst / size if size else (math.inf if worst else 0.0)


def _words(motion: Array) -> str:
    d_x, d_y, v_x, v_y, speed, _ = motion
    assert len(motion) == MOTION
    return f"d = ({d_x:.4g}, {d_y:.4g}) m, v = ({v_x:.4g}, {v_y:.4g}) m/s, omega = {speed:.4g} rad/s"
