"""The files of a command: those that it reads, where its results go, and that these do not replace those."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from frbcli.cli.options import WrittenOption

if TYPE_CHECKING:
    from frbcli.results.write import Kind

_READS, _FORCE = "frbcli.reads", "frbcli.force"  # in the context of a command

Function = TypeVar("Function", bound=Callable[..., object])


class InputFile(click.Path):
    """A file that the command reads, as a Path; no result of the command replaces it."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path, which the command then does not write."""
        try:
            path = Path(os.fsdecode(super().convert(value, param, ctx)))
        except ValueError as error:  # of a name that no file can have
            self.fail(f"{value!r} is no name of a file: {error}.", param, ctx)
        note_read(path, ctx)
        return path


class InputFiles(WrittenOption):
    """Several such files, separated by commas."""

    name = "files"

    def read(self, text: str) -> tuple[Path, ...]:
        """The paths, which the command then does not write."""
        context = click.get_current_context(silent=True)
        return tuple(INPUT.convert(name.strip(), None, context) for name in text.split(",") if name.strip())


class OutputFile(click.Path):
    """A file that the command writes, as a Path. suffix: the end of its name; "" for any."""

    def __init__(self, suffix: str = "") -> None:
        super().__init__(path_type=Path)
        self.suffix = suffix

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path. Fails the option for a name with another end."""
        path = super().convert(value, param, ctx)
        if self.suffix and Path(os.fsdecode(path)).suffix.lower() != self.suffix:
            name = f"{Path(os.fsdecode(path)).stem}{self.suffix}"
            self.fail(f"{os.fsdecode(path)!r} has to end with {self.suffix}. Write -o {name}.", param, ctx)
        return path


class OutputFolder(OutputFile):
    """A directory for files that the command writes, as a Path."""


INPUT, INPUTS, OUTPUT, OUTPUT_FOLDER = InputFile(), InputFiles(), OutputFile(), OutputFolder()
CASE_FILE, RUN_FILE, PAGE_FILE, CSV_FILE = map(OutputFile, (".toml", ".h5", ".html", ".csv"))


def note_read(path: Path, context: click.Context | None) -> None:
    """Remember that a command reads a file."""
    if context is not None:
        context.meta.setdefault(_READS, []).append(path)


def force_option(
    words: str = "Replace files that frb did not write.", exposed: bool = False
) -> Callable[[Function], Function]:
    """Give a command the option --force; exposed: it receives `force: bool`."""

    def remember(context: click.Context, _: click.Parameter, force: bool) -> bool:
        context.meta[_FORCE] = force
        return force

    return click.option("--force", is_flag=True, is_eager=True, expose_value=exposed, callback=remember, help=words)


def forced() -> bool:
    """Whether the command may replace files that frb did not write."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(_FORCE))


def check_outputs(*files: tuple[Path | None, Kind], picture: Path | None = None) -> None:
    """Raises InputError, before the work, if results of the command cannot have these places.

    files: with their kinds, None is no result; picture: one more that is drawn; whoever wants none does not wait for
    the library that draws.
    """
    from frbcli.results.write import PICTURES, require_places

    wanted = [(file, kind) for file, kind in files if file is not None]
    if picture is not None:
        from frbcli.plot.style import check_picture

        check_picture(picture, forced())
        wanted.append((picture, PICTURES[picture.suffix.lower()]))
    context = click.get_current_context(silent=True)
    require_places(wanted, () if context is None else context.meta.get(_READS, ()), forced())


def next_to(run: Path, what: str) -> Path:
    """The default place of a result: next to its run."""
    return run.parent / (run.stem + what)


def here(case_name: str, what: str) -> Path:
    """The default place of the result of a case: this directory, under the name of the case, not hidden."""
    return Path((re.sub(r"[^\w.-]+", "-", case_name).lstrip(".-") or "run") + what)
