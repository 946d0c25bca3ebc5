"""Docstrings of public functions: sections of numpydoc that name every parameter, with examples that run."""

import doctest
import inspect
import re

import pytest

import frbcli

FUNCTIONS = sorted(name for name in frbcli.__all__ if inspect.isfunction(getattr(frbcli, name)))
ORDER = ["Parameters", "Returns", "Raises", "Notes", "References", "Examples"]


def sections(name: str) -> dict[str, str]:
    """The sections of a docstring by their titles; the summary is that of the empty title."""
    parts = re.split(r"^(\w+)\n-{3,}\n", inspect.cleandoc(getattr(frbcli, name).__doc__ or ""), flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def named(section: str) -> list[str]:
    """The parameters of a section: what stands before the colons of the lines that are not indented."""
    lines = [line for line in section.splitlines() if line and not line.startswith(" ")]
    assert all(" : " in line for line in lines), lines
    return [name.strip() for line in lines for name in line.partition(" : ")[0].split(",")]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_docstring_has_its_sections(name: str) -> None:
    found = sections(name)
    summary = found.pop("").strip()
    assert summary.endswith(".")
    assert "\n" not in summary.partition("\n\n")[0]
    assert list(found) == [title for title in ORDER if title in found]
    signature = inspect.signature(getattr(frbcli, name))
    assert sorted(named(found.get("Parameters", ""))) == sorted(signature.parameters)
    assert ("Returns" in found) == (signature.return_annotation not in (None, "None"))
    assert ">>> " in found["Examples"]


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if "# doctest: +SKIP" not in sections(name)["Examples"]])
def test_an_example_says_what_it_gives(name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.chdir(str(tmp_path))
    (example,) = doctest.DocTestFinder(recurse=False).find(getattr(frbcli, name), name, globs={})
    told: list[str] = []
    result = doctest.DocTestRunner(verbose=False).run(example, out=told.append)
    assert result.failed == 0, "".join(told)
    assert result.attempted > 0
