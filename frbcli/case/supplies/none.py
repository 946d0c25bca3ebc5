"""No supply."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from frbcli.case.supplies.supply import OilSupply


class NoSupply(OilSupply):
    """No supply: oil enters at the ends only."""

    kind: Literal["none"] = Field(default="none", description="no groove, feed hole or pocket")

    plain: ClassVar[bool] = True
    feeds: ClassVar[bool] = False
    rectangular: ClassVar[bool] = True

    @property
    def gap(self) -> tuple[str, str]:
        return "1 rectangle", "plain bearing: the film is symmetric about its middle"
