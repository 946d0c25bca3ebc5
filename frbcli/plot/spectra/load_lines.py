"""Lines of the harmonic loads of a run in its spectra."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from frbcli.arrays import Array
from frbcli.case.reading.load import load_case_text
from frbcli.errors import InputError
from frbcli.plot.signals import case_tables
from frbcli.results.store import Run
from frbcli.scene.machine.elements import harmonics_of


class LoadLine(NamedTuple):
    """Frequency of a load: order times the rotor speed, and frequency_Hz beside it."""

    name: str
    order: float
    frequency_Hz: float

    def along(self, speed_Hz: Array) -> Array:
        """(k,) Hz at rotor speeds (k,) in Hz."""
        return np.abs(self.order * speed_Hz + self.frequency_Hz)


def load_lines(run: Run) -> tuple[LoadLine, ...]:
    """One line for each frequency of the harmonic loads of the case of a run beside the rotor speed itself."""
    if not run.case_text or not {"force", "base"} & case_tables(run).keys():
        return ()
    try:
        loads = harmonics_of(load_case_text(run.case_text, name=run.case_name))
    except InputError:  # a case of another version: its spectra stand without the lines
        return ()
    found = {}
    for load in loads:
        order, frequency = abs(load.order), abs(load.frequency) / (2.0 * math.pi)
        if not load.synchronous:
            found[order, frequency] = LoadLine(f"{order:g} ω" if order else f"{frequency:g} Hz", order, frequency)
    return tuple(found.values())
