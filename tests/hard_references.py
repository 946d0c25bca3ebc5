"""The references of the hard cases: `cd tests && python -m hard_references [NAME ...]` computes them anew, some
minutes for all, and writes cases/hard/references.json.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

from frbcli.case.hard import REFERENCES, hard_cases
from frbcli.studies.hard.reference import make_reference

FILE = Path(__file__).parents[1] / "cases" / "hard" / REFERENCES


def main(names: list[str]) -> None:
    """Compute the references of these hard cases, all of them for none; drop those of cases that are gone."""
    kept = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    wanted = {hard.name: hard for hard in hard_cases() if hard.fine}
    for name, hard in wanted.items():
        if names and name not in names:
            continue
        reference = make_reference(hard)
        kept[name] = asdict(reference)
        sys.stderr.write(f"{name}: {reference.status}, {reference.cpu_s:g} s\n")
        rows = (f"{json.dumps(key)}: {json.dumps(kept[key])}" for key in wanted if key in kept)
        FILE.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
