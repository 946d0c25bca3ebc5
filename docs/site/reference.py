"""The page of the Python functions, from their docstrings in the form of numpydoc."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import frbcli

_SECTION = re.compile(r"^(\w+)\n-{3,}\n", re.MULTILINE)
_SKIP = re.compile(r"  # doctest: \+SKIP$", re.MULTILINE)
LISTED = ("Parameters", "Returns", "Raises")
LINE = 60  # characters of a signature beside its name
CASE = "jeffcott"
SHORT = ["film.theory=short"]


def reference(pictures: Path | None = None) -> str:
    """All public names with signature, parameters, returns and examples. pictures: a folder that holds the run
    `run.h5` of a Jeffcott rotor, in which the pictures of the examples are drawn; None for none."""
    drawn = {} if pictures is None else draw_examples(pictures)
    parts = ["# Python reference", "All names of `import frbcli`, in the order of the alphabet."]
    for name in sorted(set(frbcli.__all__) - {"__version__"}, key=str.lower):
        thing = getattr(frbcli, name)
        parts.append(f"## {name}\n\n```python\nfrbcli.{name}{_signature(thing)}\n```")
        parts += _page(inspect.cleandoc(thing.__doc__ or ""))
        if name in drawn:
            parts.append(f"![The picture of {name}](pictures/{drawn[name]})")
    return "\n\n".join(parts) + "\n"


def draw_examples(pictures: Path) -> dict[str, str]:
    """Draw the pictures that examples end with; their files by the names of the functions."""
    run = frbcli.read_run(pictures / "run.h5")
    case = frbcli.load_case(CASE, SHORT)
    stability, sheet = frbcli.stability(case), frbcli.bearing_sheet(case)
    response = frbcli.response(case)
    draw: dict[str, Callable[[], Any]] = {
        "draw_bearing": lambda: frbcli.draw_bearing(sheet).figure,
        "draw_campbell": lambda: frbcli.draw_campbell(stability).figure,
        "draw_eccentricity": lambda: frbcli.draw_eccentricity(run).figure,
        "draw_film_signal": lambda: frbcli.draw_film_signal(run, "power").figure,
        "draw_orbit": lambda: frbcli.draw_orbit(run).figure,
        "draw_response": lambda: frbcli.draw_response(response).figure,
        "draw_spectrum": lambda: frbcli.draw_spectrum(run, 2.0).figure,
        "draw_waterfall": lambda: frbcli.draw_waterfall(run, over="speed").figure,
        "picture": lambda: frbcli.picture(run),
        "response": lambda: frbcli.picture(response),
        "stability": lambda: frbcli.picture(stability),
    }
    for name, drawing in draw.items():
        drawing().savefig(pictures / f"reference-{name}.png", dpi=110)
    return {name: f"reference-{name}.png" for name in draw}


def _signature(thing: Any) -> str:
    """Parameters and what a function returns, on a line each where one line is too long; nothing of other things."""
    if not inspect.isfunction(thing):
        return ""
    told = inspect.signature(thing)
    parameters = [str(one).replace("'", "") for one in told.parameters.values()]
    end = str(told.return_annotation).strip("'")
    line = f"({', '.join(parameters)}) -> {end}"
    return line if len(line) < LINE else "(\n" + "".join(f"    {one},\n" for one in parameters) + f") -> {end}"


def _page(words: str) -> list[str]:
    """A docstring as paragraphs of Markdown."""
    found = _SECTION.split(words)
    parts = [_escaped(found[0].strip())]
    for title, text in zip(found[1::2], found[2::2], strict=True):
        parts.append(f"**{title}**")
        if title in LISTED:
            parts.append(_list(text))
        elif title == "Examples":
            parts.append(f"```python\n{_SKIP.sub('', text.strip())}\n```")
        else:
            parts.append(_escaped(text.strip()))
    return parts


def _list(text: str) -> str:
    """Entries, whose explanations are indented, as a list."""
    entries: list[list[str]] = []
    for line in text.strip().splitlines():
        if line.startswith(" ") and entries:
            entries[-1].append(line.strip())
        elif line.strip():
            entries.append([f"- `{line.strip()}`: "])
    return "\n".join(head + _escaped(" ".join(rest)) for head, *rest in entries)


def _escaped(words: str) -> str:
    """Text as Markdown: formulas stay as they are."""
    parts = words.split("`")  # what lies between is code
    return "`".join(
        part if place % 2 else part.replace("<", "&lt;").replace("[", "\\[").replace("*", "\\*").replace("_", "\\_")
        for place, part in enumerate(parts)
    )
