"""The lowest versions that pyproject.toml allows, as constraints for pip: python .ci/bounds.py > lowest.txt."""

from __future__ import annotations

import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
for needed in (project["dependencies"], *project["optional-dependencies"].values()):
    print("\n".join(each.replace(">=", "==") for each in needed))
