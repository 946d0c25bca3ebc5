"""Where the project lies, for tests and pages that read its files, and the tables in DATA."""

import csv
from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
DATA = ROOT / "tests" / "data"


def rows_of(name: str) -> list[dict[str, str]]:
    """The rows of a table of DATA; its comments begin with #."""
    lines = (DATA / name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))
