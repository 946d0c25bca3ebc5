"""The levels of a waterfall as a bare image and as numbers, for pages that draw the axes themselves."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib import image
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from frbcli.analysis.spectrum import Spectrogram
from frbcli.arrays import Array
from frbcli.plot.spectra.waterfall import LEVELS_dB, orders
from frbcli.plot.style import LEVEL_MAP
from frbcli.results.store import Run

ROWS, COLUMNS = 720, 900  # of the image, at most
LOWEST_dB, STEP_dB = -120.0, 0.5  # of a level as one byte


@dataclass(frozen=True)
class Levels:
    """Levels of a run: time_s, speed_Hz (m,); frequency_Hz (k,), ascending; level (k, m) bytes, dB over the clearance
    by LOWEST_dB and STEP_dB; image: PNG, a pixel each, frequencies upwards; lines: names, with _ before
    an index, and frequencies (m,) in Hz."""

    time_s: Array
    speed_Hz: Array
    frequency_Hz: Array
    level: NDArray[np.uint8]
    image: bytes
    lines: tuple[tuple[str, Array], ...]


def levels(run: Run, signal: str, found: Spectrogram) -> Levels:
    """The spectra of a run over time, in at most ROWS times COLUMNS numbers, each the largest of its own."""
    rows, columns = (_starts(count, most) for count, most in zip(found.level_dB.shape, (ROWS, COLUMNS), strict=True))
    largest = np.maximum.reduceat(np.maximum.reduceat(found.level_dB, rows, axis=0), columns, axis=1)
    content = io.BytesIO()
    image.imsave(content, largest, vmin=LEVELS_dB[0], vmax=LEVELS_dB[1], cmap=LEVEL_MAP, origin="lower", format="png")
    lines = tuple((name.replace("$", ""), _means(values, columns)) for name, values in orders(run, signal, found))
    return Levels(
        time_s=_means(found.time_s, columns),
        speed_Hz=_means(found.speed_Hz, columns),
        frequency_Hz=_means(found.frequency_Hz, rows),
        level=np.clip((largest - LOWEST_dB) / STEP_dB, 0.0, 255.0).round().astype(np.uint8),
        image=content.getvalue(),
        lines=lines,
    )


def ticks(low: float, high: float, most: int = 8) -> tuple[float, ...]:
    """Round numbers from `low` to `high`."""
    found = MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(low, high)
    slack = 1e-9 * (high - low)
    return tuple(float(value) for value in found if low - slack <= value <= high + slack)


def scale_colours(count: int = 24) -> Sequence[str]:
    """Colours of the levels from the lowest to the highest, as CSS has them."""
    colours = mpl.colormaps[LEVEL_MAP](np.linspace(0.0, 1.0, count))
    return [f"#{''.join(f'{round(255 * part):02x}' for part in colour[:3])}" for colour in colours]


def _starts(count: int, most: int) -> NDArray[np.int64]:
    return np.arange(0, count, -(-count // most))


def _means(values: Array, starts: NDArray[np.int64]) -> Array:
    sizes = np.diff(np.append(starts, len(values)))
    return np.asarray(np.add.reduceat(values, starts) / sizes, dtype=np.float64)
