"""What the shell completes besides commands and options: shipped cases, files, keys of a case."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import click
from click.shell_completion import CompletionItem

if TYPE_CHECKING:
    from frbcli.case.schema import Case

COMMON = ("rotor.unbalance", "bearing.clearance", "oil.viscosity", "film.theory", "film.cavitation", "speed.from",
          "speed.to", "speed.duration", "accuracy.target", "output.step")  # fmt: skip


def complete_case(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Shipped cases that begin so, then files."""
    from frbcli.case.reading.shipped import shipped_names

    shipped = [CompletionItem(name) for name in shipped_names() if name.startswith(incomplete)]
    return [*shipped, CompletionItem(incomplete, type="file")]


def complete_key(context: click.Context, _: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Keys of the case given earlier on the line, else the most usual ones."""
    from frbcli.case.reading.listing import values

    case = _case_on_line(context)
    keys = list(COMMON) if case is None else [value.key for value in values(case)]
    return [CompletionItem(f"{key}=") for key in keys if key.startswith(incomplete)]


def _case_on_line(context: click.Context) -> Case | None:
    """The case before an option that still lacks its value, because of which click has read no word of the line."""
    from frbcli.case.reading.load import load_case
    from frbcli.errors import InputError

    for word in context.args:
        with suppress(InputError):
            return load_case(word)
    return None
