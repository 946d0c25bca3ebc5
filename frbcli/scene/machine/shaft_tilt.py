"""By how much a shaft tilts in its bearings, and what that would change in gaps that are taken as even along the axis.

The journals are in the middle of their shells: they are held there, so that no film has to be solved. At rest the
weight bends the shaft, at the top speed the unbalance does; in a conical whirl both ends of the shaft pass through
their gaps against each other, which tilts it the most. """

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from frbcli.case.schema import Case
from frbcli.columns import Column, Shown
from frbcli.errors import NotConverged
from frbcli.rotor.assembly import held_rotor
from frbcli.rotor.body import COORDINATES, PLANE
from frbcli.rotor.linear import LinearRotor
from frbcli.scene.films import ROTOR, film_places
from frbcli.scene.gate.rule import run_omega
from frbcli.scene.machine.rotor import make_rotor

# Shares of the clearance from which a change of the gap at the ends is shown, of bent shafts and of conical whirls.
BENT_LIMIT, CONE_LIMIT = 0.1, 0.25
FLAT = 1e-12  # rad: a journal that tilts less is held by a body that does not tilt


@dataclass(frozen=True)
class FilmTilt:
    """The tilt of a journal against its shell, in rad. weight: at rest; unbalance: of its whirl around that at the top
    speed; cone: in the widest conical whirl, 0 of a rotor in one bearing; reach: by what share of the clearance a tilt
    of 1 rad changes the gap at the ends."""

    film: str
    weight: float
    unbalance: float
    cone: float
    reach: float

    @property
    def bent(self) -> float:
        """Change of the gap at the ends by weight and unbalance together, over the clearance."""
        return self.reach * (self.weight + self.unbalance)

    @property
    def whirling(self) -> float:
        """Change of the gap at the ends in the widest conical whirl, over the clearance."""
        return self.reach * self.cone


    @property
    def change(self) -> float:
        """The larger change of the gap at the ends."""
        return max(self.bent, self.whirling)

    @property
    def matters(self) -> bool:
        """Whether the tilt is worth a look."""
        return self.bent > BENT_LIMIT or self.whirling > CONE_LIMIT


def _in_mrad(tilt: float) -> str:
    return f"{1e3 * tilt:.3g}"


# Of a FilmTilt
FILM_TILTS = (
    Column("film", "", "name of the film", shown=(Shown("film"),)),
    Column("weight", "rad", "tilt of the journal at rest, by the weight", shown=(Shown("weight, mrad", _in_mrad),)),
    Column("unbalance", "rad", "tilt by the unbalance at the top speed", shown=(Shown("unbalance", _in_mrad),)),
    Column("cone", "rad", "largest tilt in a conical whirl", shown=(Shown("cone", _in_mrad),)),
    Column("bent", "", "gap change at the ends by weight and unbalance, over clearance",
           shown=(Shown("bent gap", ".1%"),)),
    Column("whirling", "", "gap change in a conical whirl, over clearance",
           shown=(Shown("cone gap", ".1%"),)),
)  # fmt: skip


def film_tilts(case: Case) -> tuple[FilmTilt, ...]:
    """The films whose journals tilt, none where bearings do not hold the rotor. Raises InputError if its shaft has no
    modes."""
    if not case.bearings:
        return ()
    rotor = make_rotor(case, COORDINATES)
    maps, flat = rotor.journals[:, len(PLANE) :], replace(rotor, journals=rotor.journals[:, : len(PLANE)])
    try:
        weight = maps @ held_rotor(flat).shape
        unbalance = maps @ _whirl(flat, run_omega(case))
    except (NotConverged, np.linalg.LinAlgError):
        return ()
    if not (np.isfinite(weight).all() and np.isfinite(unbalance).all()):
        return ()
    cone, films = _cone(case), zip(film_places(case), maps, weight, unbalance, strict=True)
    return tuple(
        FilmTilt(
            place.name.replace("_", " "),
            float(np.hypot(*at_rest)),
            _largest(turning),
            cone,
            0.5 * place.geometry.width / place.geometry.clearance,
        )
        for place, tilts, at_rest, turning in films
        if place.inside == ROTOR and np.abs(tilts).max() > FLAT
    )


def _whirl(rotor: LinearRotor, omega: float) -> NDArray[np.complex128]:
    """(n,) complex amplitudes of the motion with unbalance and bow at omega rad/s, journals held in the middle."""
    here, p = rotor.at(omega), rotor.journals.reshape(-1, rotor.size)
    dynamic = here.stiffness + 1j * omega * (here.damping + omega * here.gyroscopic) - omega**2 * here.mass
    held = np.block([[dynamic, p.T], [p, np.zeros((len(p), len(p)))]])
    pulled = np.concatenate([omega**2 * here.unbalance + here.bent, np.zeros(len(p))])
    return np.asarray(np.linalg.solve(held, pulled)[: rotor.size])


def _largest(amplitude: NDArray[np.complex128]) -> float:
    """The half major axis of the ellipse that complex amplitudes (2,) run through."""
    return float(np.sqrt(0.5 * (np.sum(np.abs(amplitude) ** 2) + np.abs(np.sum(amplitude**2)))))


def _cone(case: Case) -> float:
    """Tilt of a straight shaft whose outermost bearings with films have opposite eccentricities of 1."""
    places = [(bearing.position or 0.0, sum(film.clearance for film in bearing.films)) for bearing in case.bearings]
    (first, one), (last, other) = min(places), max(places)
    return (one + other) / (last - first) if last > first else 0.0
