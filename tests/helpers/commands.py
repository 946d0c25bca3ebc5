"""`frb` called in the process of a test: the fixture `frb` of conftest.py."""

import json
from dataclasses import dataclass
from typing import Any, NamedTuple

import pytest

from frbcli.cli.main import run


class Said(NamedTuple):
    """What a command wrote on stdout and stderr."""

    out: str
    err: str

    @property
    def document(self) -> Any:
        """Its one JSON document."""
        return json.loads(self.out)


@dataclass(frozen=True)
class Frb:
    """Calls a command, expects its exit code, and gives what has been written since the last call."""

    written: pytest.CaptureFixture[str]

    def __call__(self, *words: str, code: int = 0) -> Said:
        ended = run(words)
        said = Said(*self.written.readouterr())
        assert ended == code, said.err
        return said
