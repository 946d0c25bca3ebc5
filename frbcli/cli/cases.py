"""Commands for case files: `frb cases`, the shipped and the hard ones, to print and to copy; `frb schema` for editors;
`frb docs`, the installed pages; `frb warm-up`, kernels compiled once."""

from __future__ import annotations

import html
import re
import shutil
import sys
import webbrowser
from importlib.resources import files
from pathlib import Path

import click

from frbcli.cli.common import Terminal, output_options, settings_option
from frbcli.cli.options import CASE_FILE, Command, check_outputs, complete_case, force_option, forced
from frbcli.cli.progress import display
from frbcli.errors import did_you_mean, input_error


@click.command(cls=Command)
@click.argument("names", nargs=-1, metavar="[NAME]...")
@settings_option
@click.option("-o", "--output", metavar="CASE.toml", type=CASE_FILE, help="Copy the case to this file.")
@click.option("--hard", is_flag=True, help="List the hard cases instead of the others.")
@force_option("Replace a file at -o.")
@output_options
def cases(
    names: tuple[str, ...], settings: tuple[str, ...], output: Path | None, hard: bool, terminal: Terminal
) -> None:
    """List the shipped cases; with NAME print that case's text, or copy it with -o FILE."""
    if not names and (output is not None or settings):
        raise click.UsageError("-o and --set need the NAME of a case.")
    if len(names) > 1:
        raise click.UsageError("One NAME at a time.")
    if names:
        _show(names[0], settings, output, hard, terminal)
    elif hard:
        from frbcli.cli.hard import list_hard

        list_hard(terminal)
    else:
        _list(terminal)


def _show(name: str, settings: tuple[str, ...], output: Path | None, hard: bool, terminal: Terminal) -> None:
    """Print a case or copy it."""
    from frbcli.case.reading.shipped import find_shipped

    if hard:
        from frbcli.cli.hard import hard_text

        text = hard_text(name)
    else:
        text = find_shipped(name)
    if settings:
        from frbcli.case.reading.load import load_case_text

        text = load_case_text(text, settings, name).source_text
    if output is not None:
        _write(text, output)
        terminal.result(f"case: {output}")
        terminal.remark(f"`frb check {output}` checks it.")
    else:
        terminal.text(text)
    terminal.emit({"command": "cases", "case": name, "output": output, "text": text})


def _list(terminal: Terminal) -> None:
    from frbcli.case.reading.shipped import shipped_cases

    cases = shipped_cases()
    terminal.table("shipped cases", ("name", "title"), list(cases.items()))
    terminal.remark(
        "`frb cases NAME` prints a case, `frb cases NAME -o FILE` copies it.\n`frb cases --hard` lists hard cases."
    )
    terminal.emit({"command": "cases", "cases": [{"name": name, "title": title} for name, title in cases.items()]})


def _write(text: str, output: Path) -> None:
    """Write a case to a new file, with --force to any."""
    from frbcli.results.write import NEW, write

    check_outputs((output, NEW))
    write(output, NEW, text, forced())


@click.command(cls=Command)
@output_options
def schema(terminal: Terminal) -> None:  # noqa: ARG001  # every command takes --json; this one prints JSON anyway
    """Print the JSON Schema of a case file: editors complete and check case files with it."""
    from frbcli.case.schema import json_schema

    Terminal(json=True).emit(json_schema())


INDEX = "README"
PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>{title}</title>
<style>body {{ max-width: 60em; margin: 2em auto; padding: 0 1em; font-family: sans-serif; line-height: 1.5 }}
img {{ max-width: 100% }} td, th {{ padding: 0 1em 0 0; text-align: left; vertical-align: top }}
pre {{ background: #f4f4f4; padding: 0.5em; overflow-x: auto }}</style>
<p><a href="README.html">contents</a></p>
{body}</html>
"""


@click.command(cls=Command)
@click.argument("page", default=INDEX, metavar="[PAGE]")
@click.option("--text", is_flag=True, help="Print the text of the page.")
@output_options
def docs(page: str, text: bool, terminal: Terminal) -> None:
    """Open the pages that are installed with frb in a browser, or print one of them; without a network."""
    folder = _folder()
    titles = {path.stem: _title(path) for path in sorted(folder.glob("*.md"))}
    name = page.removesuffix(".md")
    if name not in titles:
        raise input_error("docs", "PAGE", page, "is no page.", did_you_mean(name, titles, "`frb docs` lists them."))
    if text:
        terminal.text((folder / f"{name}.md").read_text(encoding="utf-8"))
        terminal.emit({"command": "docs", "page": name, "text": (folder / f"{name}.md").read_text(encoding="utf-8")})
        return
    opened = _as_html(folder, titles) / f"{name}.html"
    if name == INDEX:
        terminal.table("pages", ("name", "title"), list(titles.items()))
    terminal.result(f"pages: {opened}")
    if sys.stdout.isatty() and not terminal.silent:
        webbrowser.open(opened.as_uri())
    terminal.emit({"command": "docs", "pages": titles, "output": opened})


def _folder() -> Path:
    """Where the pages are: inside an installed package; next to the package in a checkout."""
    package = Path(str(files("frbcli")))
    installed = package / "shipped_docs"
    return installed if installed.is_dir() else package.parent / "docs"


def _title(path: Path) -> str:
    with path.open(encoding="utf-8") as file:
        return file.readline().lstrip("# ").strip()


def _as_html(folder: Path, titles: dict[str, str]) -> Path:
    """All pages as HTML with their pictures, in a directory of this user."""
    from markdown_it import MarkdownIt

    from frbcli.caches import temporary_cache

    target, markdown = temporary_cache() / "docs", MarkdownIt("commonmark").enable("table")
    target.mkdir(exist_ok=True)
    shutil.copytree(folder / "images", target / "images", dirs_exist_ok=True)
    for name, title in titles.items():
        body = markdown.render((folder / f"{name}.md").read_text(encoding="utf-8"))
        body = re.sub(r'href="([\w-]+)\.md', r'href="\1.html', body)
        (target / f"{name}.html").write_text(PAGE.format(title=html.escape(title), body=body), encoding="utf-8")
    return target


@click.command(cls=Command)
@click.argument("sources", nargs=-1, metavar="[CASE]...", shell_complete=complete_case)
@settings_option
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", show_default="one for each core",
              help="Processes.")  # fmt: skip
@output_options
def warm_up_cases(sources: tuple[str, ...], settings: tuple[str, ...], jobs: int | None, terminal: Terminal) -> None:
    """Compile the kernels of CASE, or of all shipped cases, once, on all cores: for run-ups, stability, bearing sheets
    and kinematic tests."""
    if settings and not sources:
        raise click.UsageError("--set is of a CASE.")
    with display(terminal) as shown:
        shown.line("Looking for the kernels; those that are missing are compiled, once.")
        from frbcli.case.reading.load import load_case
        from frbcli.studies.warm_up import warm_up

        cases = [load_case(source, settings) for source in sources]
        built = warm_up(cases, jobs or -1, lambda what, number, count: shown.line(f"{number} of {count}: {what}"))
    if built.compiled:
        terminal.show("compiled", built.table())
        terminal.result(
            f"Compiled kernels: {built.functions} functions in {built.wall_s:.0f} s, {built.cpu_s:.0f} s of CPU time."
        )
    else:
        terminal.result("Nothing to compile: all kernels are on the disk.")
    terminal.emit(
        {
            "command": "warm-up",
            "cases": built.cases,
            "compiled": built.table().documents(),
            "functions": built.functions,
            "cpu_s": built.cpu_s,
            "wall_s": built.wall_s,
        }
    )
