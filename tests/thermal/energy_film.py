"""One film with the energy equation in the plane of the gap, solved plainly: how wrong one temperature is.

A plain bearing of width B whose oil enters at the widest gap, Theta = 0, from a groove that mixes what the film brings
back with what is supplied. Walls are adiabatic, the temperature is constant across the gap. With x along the surface

    div(h^3/(12 eta) grad p) = U/2 dh/dx,        rho c q . grad T = eta U^2/h + h^3/(12 eta) |grad p|^2.

Where the pressure would fall below zero it is zero (Reynolds' condition by projected relaxation); the cavity carries
oil on without warming it.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import lil_matrix
from scipy.sparse.linalg import spsolve

from frbcli.arrays import Array
from frbcli.materials import VogelLaw

AROUND, ALONG = 72, 8  # cells; along over half the width
ROUNDS = 40


@dataclass(frozen=True)
class Bearing:
    """SI units; heat: rho c in J/(m^3 K)."""

    radius: float
    width: float
    clearance: float
    omega: float
    law: VogelLaw
    heat: float
    supply: float


@dataclass(frozen=True)
class Field:
    """load in N, power in W, side flow in m^3/s, temperatures (AROUND, ALONG) in K."""

    load: float
    power: float
    flow: float
    temperature: Array


def solve(bearing: Bearing, eccentricity: float, mixing: float | None = None) -> Field:
    """The film at an eccentricity; mixing: m of the lumped model, with one temperature everywhere, None: with the
    equation of energy."""
    dx, dz = 2.0 * math.pi * bearing.radius / AROUND, 0.5 * bearing.width / ALONG
    theta = 2.0 * math.pi * (np.arange(AROUND) + 0.5) / AROUND
    faces = 2.0 * math.pi * np.arange(AROUND + 1) / AROUND
    h, h_face = (bearing.clearance * (1.0 + eccentricity * np.cos(angle)) for angle in (theta, faces))
    speed = bearing.omega * bearing.radius
    temperature = np.full((AROUND, ALONG), bearing.supply)
    for _ in range(ROUNDS):
        eta = bearing.law.eta_0 * np.exp(bearing.law.a / (temperature + bearing.law.c))
        pressure = _pressure(eta, h, h_face, speed, dx, dz)
        into, side, power_p = _flows(pressure, eta, h, h_face, speed, dx, dz)
        full = pressure > 0.0
        last = int(np.flatnonzero(full.any(axis=1)).max())
        shear = np.where(full, eta * speed**2 / h[:, None] * dx * dz, 0.0)
        heating, flow = 2.0 * (shear + power_p), 2.0 * float(side.sum())
        # what the cavity shears is a share by its oil, the flow at its begin over the gap there
        carried = 0.5 * speed * h[last]
        for i in range(last + 1, AROUND):
            heating[i] = 2.0 * eta[i] * speed**2 / h[i] * min(carried / (0.5 * speed * h[i]), 1.0) * dx * dz
        power = float(heating.sum())
        if mixing is not None:
            after = np.full_like(temperature, bearing.supply + mixing * power / (bearing.heat * flow))
        else:
            after = _energy(bearing, into, side, 0.5 * heating)
        change = float(np.abs(after - temperature).max())
        temperature = 0.5 * (temperature + after)
        if change < 1e-3:
            break
    push = 2.0 * pressure.sum(axis=1) * dx * dz
    load = math.hypot(float(push @ np.cos(theta)), float(push @ np.sin(theta)))
    return Field(load, power, flow, temperature)


def _pressure(eta: Array, h: Array, h_face: Array, speed: float, dx: float, dz: float) -> Array:
    """Reynolds' condition by an active set: cells without pressure are held at zero until all others are above it."""
    around = h_face[1:-1, None] ** 3 / (12.0 * 0.5 * (eta[1:] + eta[:-1])) * dz / dx
    along = h[:, None] ** 3 / (12.0 * eta) * dx / dz
    ends = h_face[0] ** 3 / (6.0 * eta[0]) * dz / dx  # half a cell from the groove, where the gap is the same
    rise = 0.5 * speed * dz * np.diff(h_face)
    number = np.arange(AROUND * ALONG).reshape(AROUND, ALONG)
    empty = np.zeros((AROUND, ALONG), dtype=bool)
    for _ in range(60):
        matrix, right = lil_matrix((AROUND * ALONG, AROUND * ALONG)), np.zeros(AROUND * ALONG)
        for i in range(AROUND):
            for j in range(ALONG):
                n = number[i, j]
                if empty[i, j]:
                    matrix[n, n] = 1.0
                    continue
                right[n] = -rise[i]
                total = 0.0
                for other, c in (
                    ((i - 1, j), around[i - 1, j] if i > 0 else ends[j]),
                    ((i + 1, j), around[i, j] if i + 1 < AROUND else ends[j]),
                    ((i, j - 1), along[i, j] if j > 0 else 2.0 * along[i, j]),
                    ((i, j + 1), along[i, j] if j + 1 < ALONG else 0.0),
                ):
                    total += c
                    inside = 0 <= other[0] < AROUND and 0 <= other[1] < ALONG
                    if inside and not empty[other]:
                        matrix[n, number[other]] = -c
                matrix[n, n] = total
        found = spsolve(matrix.tocsr(), right).reshape(AROUND, ALONG)
        wrong = (found < 0.0) & ~empty
        if not wrong.any():
            return np.asarray(found)
        empty |= wrong
    return np.maximum(found, 0.0)


def _flows(
    p: Array, eta: Array, h: Array, h_face: Array, speed: float, dx: float, dz: float
) -> tuple[Array, Array, Array]:
    """Flow through the faces around (AROUND + 1, ALONG), out at the end (AROUND,), heating by pressure per cell."""
    c = h_face[:, None] ** 3 / 12.0 * dz / dx
    eta_face = np.vstack([eta[:1], 0.5 * (eta[1:] + eta[:-1]), eta[-1:]])
    before, behind = np.vstack([np.zeros(ALONG), p]), np.vstack([p, np.zeros(ALONG)])
    twice = np.ones((AROUND + 1, 1))
    twice[[0, -1]] = 2.0
    drive = c / eta_face * twice * (before - behind)
    into = 0.5 * speed * h_face[:, None] * dz + drive
    along = h[:, None] ** 3 / (12.0 * eta) * dx / dz
    side = 2.0 * along[:, 0] * p[:, 0]
    over = drive * (before - behind)
    heat = 0.5 * (over[1:] + over[:-1])
    inner = along[:, 1:] * (p[:, 1:] - p[:, :-1]) ** 2
    heat[:, 1:] += 0.5 * inner
    heat[:, :-1] += 0.5 * inner
    heat[:, 0] += side * p[:, 0]
    return into, side, heat


def _energy(bearing: Bearing, into: Array, side: Array, heating: Array) -> Array:
    """Upwind balances, marched around; the groove mixes what comes back with what is supplied."""
    inlet = bearing.supply
    temperature = np.empty_like(heating)
    for _ in range(200):
        coming = np.full(ALONG, inlet)
        for i in range(AROUND):
            flow, out = np.maximum(into[i], 0.0), np.zeros(ALONG + 1)
            out[0] = side[i]  # towards the end, by continuity
            for j in range(ALONG):
                out[j + 1] = out[j] - (into[i, j] - into[i + 1, j])
            matrix, right = np.zeros((ALONG, ALONG)), bearing.heat * flow * coming + heating[i]
            for j in range(ALONG):
                arrives = flow[j]
                if j + 1 < ALONG and out[j + 1] > 0.0:
                    matrix[j, j + 1] -= bearing.heat * out[j + 1]
                    arrives += out[j + 1]
                if j > 0 and out[j] < 0.0:
                    matrix[j, j - 1] += bearing.heat * out[j]
                    arrives -= out[j]
                matrix[j, j] = bearing.heat * max(arrives, 1e-18)
            coming = np.linalg.solve(matrix, right)
            temperature[i] = coming
        whole, fresh = float(into[0].sum()), float(side.sum())
        mixed = (fresh * bearing.supply + (whole - fresh) * float(coming.mean())) / whole
        if abs(mixed - inlet) < 1e-4:
            break
        inlet = mixed
    return temperature
