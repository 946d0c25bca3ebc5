"""The documents cannot rot: pages that are written by a program are up to date, and what they name is there."""

import re
import shlex
import tomllib
from pathlib import Path

import click
import pytest
from pages import analysis_matrix, case_reference, column_tables, hard_cases_page
from paths import ROOT

import frbcli
from frbcli.case.reading.shipped import hard_cases
from frbcli.cli.main import COMMANDS, frb, run

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def named(page: Path) -> str:
    return str(page.relative_to(ROOT))


def test_every_key_of_the_case_file_has_a_meaning() -> None:
    empty = [line for line in case_reference.page().splitlines() if line.startswith("- `") and line.endswith(": ")]
    assert empty == []


def test_case_file_page_is_what_the_schema_says() -> None:
    assert case_reference.PAGE.read_text(encoding="utf-8") == case_reference.page(), (
        "run `cd tests && python -m pages.case_reference`"
    )


def test_the_matrix_page_is_what_the_gates_say() -> None:
    assert analysis_matrix.PAGE.read_text(encoding="utf-8") == analysis_matrix.page(), (
        "run `cd tests && python -m pages.analysis_matrix`"
    )


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_tables_of_columns_are_as_they_are_declared(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text == column_tables.with_tables(page), "run `cd tests && python -m pages.column_tables`"


def test_every_declared_table_of_columns_is_on_one_page() -> None:
    assert sorted(name for page in PAGES for name in column_tables.marked(page)) == sorted(column_tables.TABLES)


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)#]+)", text)
    missing = [t for t in targets if not t.startswith("http") and not (page.parent / t).exists()]
    assert missing == []


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_files_and_functions_that_are_named_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    files = set(re.findall(r"`((?:frbcli|tests|cases|docs)/[\w./-]*)`", text))
    assert [name for name in files if not (ROOT / name).exists()] == []
    for name, function in re.findall(r"`(frbcli/[\w/]+\.py)`: `(\w+)`", text):
        assert re.search(rf"^(?:def|class) {function}\b|^{function}\b", (ROOT / name).read_text("utf-8"), re.MULTILINE)


def test_readme_shows_what_its_commands_print(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every line of a block that begins with a command, and the numbers of its sentences."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```\n\$ frb (.*?)\n(.*?)```", text, re.DOTALL)
    assert blocks
    printed = ""
    for words, shown in blocks:
        assert run([*shlex.split(words), "--no-picture"]) == 0
        printed = capsys.readouterr().out
        lines = [line.rstrip() for line in printed.splitlines()]
        assert [line for line in shown.splitlines() if line.rstrip() not in lines] == []
    for number in ("143 Hz", "204 Hz", "0.47 times", "2.7e-4 of"):
        assert number in text
    events = {row.split()[0]: row.split() for row in printed.splitlines() if "journal" in row or "disk" in row}
    assert round(float(events["critical-speed"][3])) == 143
    assert round(float(events["onset"][3])) == 204
    assert f"{float(events['onset'][5]):.2f}" == "0.47"
    assert re.search(r"error of the eccentricity +2\.7e-04", printed)


def test_readme_is_short() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 100
    assert len(text.split()) <= 900


# Words of this project's own that pages and helps had, and what they say instead
NOT_USED = {
    r"resting position": "static equilibrium", r"films? on cells": "finite-volume film",
    r"keeps? (its|their|the) oil": "mass-conserving", r"at the most": "at most", r"\berrs? by": "has an error of",
    r"in place of": "instead of", r"\bstands? (for|beside)\b": "is", r"\btold\b": "reported", r"\bbeside\b": "next to",
    r"\bthat of\b": "the noun itself",
}  # fmt: skip


def test_pages_and_helps_have_the_terms_of_the_field() -> None:
    texts = {named(page): page.read_text(encoding="utf-8") for page in PAGES}
    for name in COMMANDS:
        command = frb.get_command(click.Context(frb), name)
        assert command is not None
        texts[f"frb {name} --help"] = command.get_help(click.Context(command, info_name=name))
    used = [(name, match[0], term) for name, text in texts.items() for words, term in NOT_USED.items()
            for match in re.finditer(words, " ".join(text.split()))]  # fmt: skip
    assert used == []


def test_the_glossary_has_sixty_terms() -> None:
    text = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8").partition("## Glossary")[2]
    terms = re.findall(r"^- (.+?)(?:: |$)", text, re.MULTILINE)
    assert sum(len(re.sub(r"\$.*?\$", "", term).split(",")) for term in terms) >= 60


def test_readme_tours_every_command() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [command for command in COMMANDS if f"frb {command}" not in text] == []


def test_the_page_of_cases_shows_a_shipped_one_and_its_keys_in_the_sketch() -> None:
    text = (ROOT / "docs" / "cases.md").read_text(encoding="utf-8")
    shown, sketch = re.findall(r"```toml\n(.*?)```.*?```\n(.*?)```", text, re.DOTALL)[0]
    case = tomllib.loads(shown)
    assert case == tomllib.loads((ROOT / "cases" / "jeffcott.toml").read_text(encoding="utf-8"))
    keys = re.findall(r"\b([a-z]+)\.([a-z_]+)", sketch)
    assert len(keys) >= 10
    assert [f"{table}.{key}" for table, key in keys if key not in case[table]] == []
    assert [line for line in sketch.splitlines() if len(line) > 80] == []


def test_page_of_hard_cases_has_the_words_of_its_generator() -> None:
    text = (ROOT / "docs" / "hard-cases.md").read_text(encoding="utf-8")
    assert text.startswith(hard_cases_page.INTRODUCTION)
    assert [hard.name for hard in hard_cases() if f"| `{hard.name}` | {hard.hard} |" not in text] == []


def test_page_of_accuracy_has_the_words_of_its_template() -> None:
    template = (ROOT / "tests" / "accuracy" / "page.md").read_text(encoding="utf-8")
    words = ".*?".join(re.escape(text) for text in re.split(r"@[A-Z]+@", template))
    assert re.fullmatch(words, (ROOT / "docs" / "accuracy-measured.md").read_text(encoding="utf-8"), re.DOTALL)


def test_every_page_is_in_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    pages = [page.name for page in (ROOT / "docs").glob("*.md") if page.name != "README.md"]
    assert [name for name in pages if f"]({name})" not in index] == []


def test_ci_finds_the_readmes_line_that_sets_up_and_tests() -> None:
    pattern = re.search(r"grep -m 1 -E '([^']+)' README.md", (ROOT / ".ci" / "run").read_text(encoding="utf-8"))
    assert pattern
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert len([line for line in lines if re.search(pattern[1], line)]) == 1


def test_rows_of_the_page_of_additions_name_what_is_there() -> None:
    """Files and folders of the second column, and names with their files in the third."""
    text = (ROOT / "docs" / "adding-a-model.md").read_text(encoding="utf-8")
    table = text.partition("\n## ")[0]
    rows = [line.split("|")[1:-1] for line in table.splitlines() if line.startswith("| ")][2:]
    assert len(rows) > 8
    for what, place, row in rows:
        places = re.findall(r"`([\w./-]+/[\w./-]*)`", place)
        assert [path for path in places if not (ROOT / path).exists()] == [], what
        named = [(name, path) for name, path in re.findall(r"`(\w+)` in `([\w./-]+)`", row)]
        named += [(name, places[0]) for name in re.findall(r"`(\w+)`, same file", row)]
        for name, path in named:
            assert re.search(rf"^(def |class )?{name}\b", (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE), what
        public = re.findall(r"`frbcli\.(\w+)`", row)
        assert [name for name in public if not hasattr(frbcli, name)] == [], what
        assert named or public or "the directory is read" in row, f"nothing of the row is checked: {what}"
    named = [path for path in re.findall(r"`((?:frbcli|tests)/[\w./-]+)`", text) if not (ROOT / path).exists()]
    assert named == []


def equation_rows() -> list[tuple[str, list[str]]]:
    """Numbers and files of the first table of the page of equations."""
    text = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8").partition("\n## ")[0]
    rows = [line.split(" | ") for line in text.splitlines() if line.startswith("| (")]
    return [(row[0], re.findall(r"`(frbcli/[\w/]+\.py)`", row[2])) for row in rows]


def expanded(numbers: str) -> list[str]:
    """'(4.8) to (4.10)' and '(4.36), (4.37)' as single numbers."""
    found = re.findall(r"\((\w)\.(\d+)\)", numbers)
    if " to " not in numbers:
        return [f"({chapter}.{number})" for chapter, number in found]
    (chapter, first), (_, last) = found
    return [f"({chapter}.{number})" for number in range(int(first), int(last) + 1)]


def test_files_of_the_page_of_equations_name_their_equations() -> None:
    rows = equation_rows()
    assert len(rows) > 30
    for numbers, files in rows:
        assert files, numbers
        texts = {name: (ROOT / name).read_text(encoding="utf-8") for name in files}
        missing = [name for name, text in texts.items() if not any(n in text for n in expanded(numbers))]
        assert missing == [], numbers


def test_every_equation_that_the_code_names_is_on_the_page_of_equations() -> None:
    elsewhere = {"(3.20)"}  # of Kuznetsov, in frbcli/cycles/method/equilibria.py
    listed = {number for numbers, _ in equation_rows() for number in expanded(numbers)} | elsewhere
    for file in sorted((ROOT / "frbcli").rglob("*.py")):
        named = re.findall(r"(?<!\w)\((?:[2-6]|B)\.[1-9]\d?\)", file.read_text(encoding="utf-8"))
        assert [number for number in named if number not in listed] == [], file
