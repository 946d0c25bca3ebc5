"""How fast a floating ring turns."""

from __future__ import annotations

from frbcli.case.schema import Case
from frbcli.scene.films import turning_rings
from frbcli.scene.machine.system import film_drag


def concentric_ratios(case: Case) -> dict[str, float]:
    """omega_F / omega_R of each ring, by its bearing's name, where everything is concentric and the films are full:
    the torques of (4.6) balance, k_i (omega_R - omega_F) = k_o omega_F with k = eta R^3 B / C, of a cartridge the sum
    of both ends."""
    ratios: dict[str, float] = {}
    for around in turning_rings(case):
        inner = sum(film_drag(case, bearing.inner) for bearing in around)
        outer = sum(film_drag(case, bearing.outer) for bearing in around)
        ratios |= {bearing.name: inner / (inner + outer) for bearing in around}
    return ratios
