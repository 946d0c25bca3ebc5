"""The prescribed rotation of the rotor as the time loop evaluates it, compiled."""

from __future__ import annotations

from frbcli.compiled import compiled
from frbcli.rotor import speed_profile

rotation = compiled()(speed_profile.rotation)
