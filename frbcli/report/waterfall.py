"""The waterfall of a page: an image with axes of its own, and the numbers that the page's script reads out."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from frbcli.arrays import Array
from frbcli.plot.waterfall import Levels, LEVELS_dB, LOWEST_dB, STEP_dB, scale_colours, ticks
from frbcli.report.svg import curve, drawing, element, line, text
from frbcli.units import HERTZ, SpeedUnit

WIDTH, HEIGHT = 900.0, 500.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 90.0, 84.0, 46.0
FLAG_ROWS, FLAG_ROW = 4, 16.0  # of the numbers of events above the picture
BAR, BAR_WIDTH = WIDTH - RIGHT + 18.0, 14.0
FLAG = 7.5  # radius of the number of an event


@dataclass(frozen=True)
class Waterfall:
    """svg: the picture; data: JSON for the script, see waterfall.js."""

    svg: str
    data: str


def page_waterfall(
    spectra: Levels, clearance: float, events: Sequence[dict[str, Any]], unit: SpeedUnit = HERTZ
) -> Waterfall:
    """The waterfall of the levels of a run over the clearance in m; events: of the run, numbered from 1 on; unit: of
    the rotor speeds above it."""
    return Waterfall(_picture(spectra, events, unit), _numbers(spectra, clearance))


def _numbers(spectra: Levels, clearance: float) -> str:
    """Times and speeds per column, frequencies per row and levels as bytes, row by row."""
    return json.dumps(
        {
            "box": [LEFT, TOP, WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM],
            "times": [round(float(value), 5) for value in spectra.time_s],
            "speeds": [round(float(value), 4) for value in spectra.speed_Hz],
            "frequencies": [round(float(value), 4) for value in spectra.frequency_Hz],
            "lowest": LOWEST_dB,
            "step": STEP_dB,
            "clearance": clearance,
            "levels": base64.b64encode(spectra.level.tobytes()).decode(),
        }
    )


def _picture(spectra: Levels, events: Sequence[dict[str, Any]], unit: SpeedUnit) -> str:
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    begin, end = _edges(spectra.time_s)
    top_Hz = _edges(spectra.frequency_Hz)[1]

    def across(t: float) -> float:
        return LEFT + (right - LEFT) * (t - begin) / (end - begin)

    def up(f: float) -> float:
        return bottom - (bottom - TOP) * f / top_Hz

    picture = base64.b64encode(spectra.image).decode()
    parts = [
        element(
            "image", x=LEFT, y=TOP, width=right - LEFT, height=bottom - TOP, preserveAspectRatio="none",
            href=f"data:image/png;base64,{picture}",
        )
    ]  # fmt: skip
    for name, frequency in spectra.lines:
        shown = [(across(t), up(f)) for t, f in zip(spectra.time_s.tolist(), np.abs(frequency).tolist(), strict=True)]
        inside = [point for point in shown if point[1] >= TOP][:: max(1, len(shown) // 200)]
        if len(inside) > 1:
            parts.append(curve(inside, "order"))
            x, y = inside[int(0.86 * len(inside))]
            label = re.sub("_(.)", r'<tspan font-size="9" dy="3">\1</tspan><tspan dy="-3">&#8203;</tspan>', name)
            parts.append(element("text", label, x=x - 4.0, y=y - 5.0, kind="ordername", text_anchor="end"))
    for t in ticks(begin, end):
        parts.append(line(across(t), bottom, across(t), bottom + 4.0, "tick"))
        parts.append(text(across(t), bottom + 16.0, f"{t:g}"))
        speed = float(np.interp(t, spectra.time_s, spectra.speed_Hz))
        parts.append(text(across(t), TOP - 8.0, unit.number(speed), "small"))
    for f in ticks(0.0, top_Hz):
        parts.append(line(LEFT - 4.0, up(f), LEFT, up(f), "tick"))
        parts.append(text(LEFT - 8.0, up(f) + 4.0, f"{f:g}", anchor="end"))
    parts.append(text(0.5 * (LEFT + right), HEIGHT - 8.0, "time in s"))
    parts.append(text(LEFT - 8.0, TOP - 8.0, f"rotor, {unit.name}", "small", "end"))
    parts.append(
        element("text", "frequency in Hz", kind="label", text_anchor="middle",
                transform=f"translate(16 {0.5 * (TOP + bottom):.0f}) rotate(-90)")
    )  # fmt: skip
    parts += _bar(bottom)
    parts += _flags(events, across, bottom, (begin, end))
    parts.append(element("g", id="pointer"))
    width, height = right - LEFT, bottom - TOP
    parts.append(element("rect", x=LEFT, y=TOP, width=width, height=height, id="sense", fill="transparent"))
    return drawing(WIDTH, HEIGHT, parts, "waterfall: amplitude over time and frequency")


def _bar(bottom: float) -> list[str]:
    """The scale of the levels."""
    colours = scale_colours()
    low, high = LEVELS_dB
    step = (bottom - TOP) / len(colours)
    parts = [
        element("rect", x=BAR, y=bottom - (i + 1) * step, width=BAR_WIDTH, height=step + 0.5, fill=colour)
        for i, colour in enumerate(colours)
    ]
    for level in ticks(low, high, 6):
        y = bottom - (bottom - TOP) * (level - low) / (high - low)
        parts.append(line(BAR + BAR_WIDTH, y, BAR + BAR_WIDTH + 4.0, y, "tick"))
        parts.append(text(BAR + BAR_WIDTH + 7.0, y + 4.0, f"{level:g}", anchor="start"))
    parts.append(text(BAR + 0.5 * BAR_WIDTH, bottom + 16.0, "dB"))
    return parts


def _flags(events: Sequence[dict[str, Any]], across: Any, bottom: float, span: tuple[float, float]) -> list[str]:
    """Numbered lines of the events; numbers that would meet move to a higher row, and where all rows are full the
    line has none."""
    lines, flags, free = list[str](), list[str](), [-1e9] * FLAG_ROWS
    for number, event in enumerate(events, start=1):
        if not span[0] <= event["t_s"] <= span[1]:
            continue
        x = across(event["t_s"])
        row = next((row for row, until in enumerate(free) if x - FLAG > until), None)
        if row is None:
            lines.append(line(x, TOP, x, bottom, "event"))
            continue
        free[row] = x + FLAG
        y = TOP - 26.0 - FLAG_ROW * row
        lines.append(line(x, y + FLAG, x, bottom, "event"))
        flags.append(element("circle", cx=x, cy=y, r=FLAG, kind="flag"))
        flags.append(text(x, y + 3.5, str(number), "flagname"))
    return lines + flags


def _edges(middles: Array) -> tuple[float, float]:
    """From the beginning of the first to the end of the last of even spans, by their middles."""
    half = 0.5 * float(middles[-1] - middles[0]) / max(len(middles) - 1, 1)
    return float(middles[0]) - half, float(middles[-1]) + half
