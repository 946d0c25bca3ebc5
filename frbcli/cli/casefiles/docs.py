"""`frb docs`: the pages that are installed with frb."""

from __future__ import annotations

import html
import re
import shutil
import sys
import webbrowser
from importlib.resources import files
from pathlib import Path

import click

from frbcli.cli.common import Terminal, output_options
from frbcli.cli.options import Command
from frbcli.errors import did_you_mean, input_error

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
def command(page: str, text: bool, terminal: Terminal) -> None:
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
