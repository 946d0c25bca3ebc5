"""Rotor speeds of a page: in Hz, in rpm where the case gives them so, or in both."""

from __future__ import annotations

from dataclasses import dataclass

from frbcli.columns import with_uncertainty
from frbcli.errors import FrbError
from frbcli.plot.signals import case_tables
from frbcli.results.store import Run

PER_MINUTE = 60.0


@dataclass(frozen=True)
class SpeedWords:
    """rpm: revolutions per minute in place of Hz; both: also the other unit."""

    rpm: bool = False
    both: bool = False

    @property
    def unit(self) -> str:
        """The unit of plain numbers."""
        return "rpm" if self.rpm else "Hz"

    def number(self, speed_Hz: float) -> str:
        """A speed without its unit, as in a scale."""
        return f"{PER_MINUTE * speed_Hz:.0f}" if self.rpm else f"{speed_Hz:.4g}"

    def cell(self, speed_Hz: float, uncertainty_Hz: float | None = None) -> str:
        """A speed in a table whose head names the unit, with its uncertainty; with the other one in brackets."""
        per_minute = None if uncertainty_Hz is None else PER_MINUTE * uncertainty_Hz
        own = with_uncertainty(speed_Hz, uncertainty_Hz, 1)
        other = with_uncertainty(PER_MINUTE * speed_Hz, per_minute, 0)
        if self.rpm:
            own, other = other, own
        return f"{own} ({other})" if self.both else own

    @property
    def head(self) -> str:
        """The unit of speeds in the head of a table."""
        other = "Hz" if self.rpm else "rpm"
        return f"{self.unit} ({other})" if self.both else self.unit

    def words(self, speed_Hz: float) -> str:
        """A speed with its unit."""
        own, other = f"{speed_Hz:.1f} Hz", f"{PER_MINUTE * speed_Hz:.0f} rpm"
        if self.rpm:
            own, other = other, own
        return f"{own}, {other}" if self.both else own


def speed_words(run: Run, both: bool = False) -> SpeedWords:
    """The words for the speeds of a run: its case gives them in rpm or not."""
    try:
        speed = case_tables(run).get("speed")
    except FrbError:
        speed = None
    given = speed.values() if isinstance(speed, dict) else ()
    return SpeedWords(any(isinstance(value, str) and "rpm" in value for value in given), both)
