"""A machine whose bearings are all given by coefficients: it has no film."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from frbcli.scene.forms.form import FilmForm, SolveCounts


@dataclass(frozen=True)
class NoForm(FilmForm):
    """No film: nothing is tabulated, and nothing has an error."""

    solved: ClassVar[bool] = False


NO_FILM: FilmForm = NoForm("no film", SolveCounts(1.0, 1.0, 1.0, (1.0, 1.0)), 0.35)
