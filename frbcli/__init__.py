"""Rotordynamics of light, fast rotors in fluid film bearings.

The public names below are imported when they are first used, so that `import frbcli` and `frb --help` cost nothing.
"""

from __future__ import annotations

import importlib

__version__ = "0.1.0"

_PUBLIC = {
    "Case": "frbcli.case.schema",
    "Fault": "frbcli.errors",
    "FrbError": "frbcli.errors",
    "InputError": "frbcli.errors",
    "NotConverged": "frbcli.errors",
    "RunFileError": "frbcli.errors",
    "load_case": "frbcli.case.load",
    "load_case_text": "frbcli.case.load",
    "read_run": "frbcli.results.store",
    "rundown": "frbcli.solve.run",
    "runup": "frbcli.solve.run",
    "shipped_cases": "frbcli.case.shipped",
    "stability": "frbcli.analysis.stability",
}

__all__ = ["__version__", *_PUBLIC]


def __getattr__(name: str) -> object:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_PUBLIC[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
