"""The tutorial, its notebook and the site: what they show works."""

import importlib.util
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import picture_texts
import pytest
from pages.tutorial_notebook import case_text, cells
from paths import DOCS

import frbcli
from frbcli.cli.main import COMMANDS, run


def test_the_case_of_the_tutorial_is_whole_from_its_bearings_on() -> None:
    """An empty file and a rotor alone are refused with what is missing; the whole text is a case."""
    for text in ("", case_text().partition("[[bearing]]")[0]):
        with pytest.raises(frbcli.InputError, match="bearing"):
            frbcli.load_case_text(text, name="turbo")
    case = frbcli.load_case_text(case_text(), name="turbo")
    assert [bearing.name for bearing in case.bearings] == ["front", "rear"]
    assert frbcli.make_plan(case).cells is not None


@pytest.mark.nightly  # the commands of the tutorial in a kernel of its own
def test_the_notebook_of_the_tutorial_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cell by cell, in an empty folder; what a cell ends with has something to show. It holds the case of the page and
    the outputs of such a run, pictures among them."""
    monkeypatch.chdir(tmp_path)
    notebook = json.loads((DOCS / "tutorial.ipynb").read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    assert [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]] == cells()
    outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) >= 3
    assert [output for output in outputs if output["output_type"] in ("error", "stream")] == []
    names: dict[str, object] = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        assert cell["outputs"]
        lines = "".join(cell["source"]).splitlines()
        exec("\n".join(lines[:-1]), names)
        shown = eval(lines[-1], names)
        assert shown is not None
    assert (tmp_path / "turbo.html").stat().st_size > 100_000
    assert (tmp_path / "turbo.h5").exists()


def of_site(name: str) -> ModuleType:
    """A module of docs/site."""
    spec = importlib.util.spec_from_file_location(f"site_{name}", DOCS / "site" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_command_and_every_public_name_has_its_place() -> None:
    module = of_site("build")
    assert set(module.SHOWN) == set(COMMANDS)
    page = module.reference()
    assert [name for name in frbcli.__all__ if name != "__version__" and f"\n## {name}\n" not in page] == []
    named = set(re.findall(r"([\w-]+)\.md", module.configuration(Path("a"), Path("b"))))
    assert {page.stem for page in DOCS.glob("*.md")} - {"README"} <= named


def loaded_hook() -> Callable[[str], str]:
    pytest.importorskip("latex2mathml", reason="needs the extra frbcli[docs]")
    return of_site("equations").on_page_content  # type: ignore[no-any-return]


@pytest.mark.parametrize("page", sorted(DOCS.glob("*.md")), ids=lambda page: page.stem)
def test_every_equation_of_a_page_is_typeset(page: Path) -> None:
    """As MathML without a remainder of TeX, which a name that the converter does not know would be."""
    typeset = loaded_hook()
    markdown = pytest.importorskip("markdown")
    pytest.importorskip("pymdownx")
    extensions = ["tables", "fenced_code", "pymdownx.arithmatex"]
    settings = {"pymdownx.arithmatex": {"generic": True}}
    text = page.read_text(encoding="utf-8")
    words = typeset(markdown.markdown(text, extensions=extensions, extension_configs=settings))
    assert "arithmatex" not in words
    assert [formula for formula in re.findall(r"<math.*?</math>", words, re.DOTALL) if "\\" in formula] == []
    assert words.count('<div class="equation">') == len(re.findall(r"\$\$.+?\$\$", text, re.DOTALL))


DOCS_EXTRA = ("material", "latex2mathml")


@pytest.mark.nightly
@pytest.mark.skipif(any(importlib.util.find_spec(name) is None for name in DOCS_EXTRA), reason="needs frbcli[docs]")
def test_the_site_builds_without_warnings(tmp_path: Path) -> None:
    subprocess.run([sys.executable, str(DOCS / "site" / "build.py"), str(tmp_path / "site")], check=True)
    for page in ("index.html", "gallery.html", "reference.html", "commands/waterfall.html", "search/search_index.json"):
        assert (tmp_path / "site" / page).exists()
    words = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    loaded = re.findall(r'<(?:script|img)[^>]* src="([^"]+)"|<link[^>]* rel="stylesheet"[^>]* href="([^"]+)"', words)
    assert [link for pair in loaded for link in pair if link.startswith(("http:", "https:", "//"))] == []


# Pictures that the gallery does not show
FURTHER = (
    ["bearing", "ball-bearing", "--load", "60 N", "--speed", "1000 Hz", "--speed", "2500 Hz"],
    ["waterfall", "run.h5", "--order", "1,0.5", "-o", "orders.png"],
    ["compare", "run.h5", "--measured", "run.h5"],
    ["plot", "jeffcott", "--what", "law", "-o", "law.png"],
    ["stability", "turbocharger-car", "--modes", "5e6 N/m", "-o", "modes.png"],
    ["report", "run.h5"],
)


@pytest.mark.nightly
def test_texts_of_the_gallery_cover_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """conftest.py looks at each picture of a line: those of the site and further ones."""
    monkeypatch.chdir(tmp_path)
    site: Any = of_site("build")
    shown = [words for words, picture in site.SHOWN.values() if picture and words != site.RUN]
    for words in (site.RUN, *shown, *(words for words, *_ in site.MORE), *FURTHER):
        assert run(words) == 0, words
        assert picture_texts.seen == [], words
