"""What holds for all tests of bearing models."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import frbcli
from frbcli.film.bearing_model import table


@pytest.fixture(autouse=True)
def taken_away() -> Iterator[None]:
    """The table of models holds for a process: what a test has added is taken out of it."""
    yield
    for model in table.models():
        frbcli.remove_bearing(model.name)
