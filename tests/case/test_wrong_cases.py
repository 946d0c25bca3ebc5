"""Wrong cases, and analyses that a case cannot have: the rows of tests/data/wrong-cases.toml, each with its faults."""

import tomllib
from collections.abc import Sequence
from typing import Any

import pytest
from paths import DATA

from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.errors import Fault, InputError
from frbcli.scene.gate.gate import faults
from frbcli.scene.planning.plan import make_plan

TABLE = tomllib.loads((DATA / "wrong-cases.toml").read_text(encoding="utf-8"))
ROWS = [
    pytest.param(group, row, analysis, id=f"{group['case']}: {row[1]} {analysis or ''}".strip())
    for group in TABLE["group"]
    for analysis in group.get("analysis", (None,))
    for row in group["wrong"]
]


def found(group: dict[str, Any], settings: Sequence[str], analysis: str | None) -> Sequence[Fault]:
    """The faults of a case, when it is read, or those that its plan or an analysis has."""
    given = [*group.get("settings", ()), *settings]
    try:
        base = TABLE["bases"].get(group["case"])
        case = load_case(group["case"], given) if base is None else case_from_dict(base).with_settings(*given)
        if analysis == "plan":
            make_plan(case)
    except InputError as error:
        return error.faults
    return () if analysis in (None, "plan") else faults(case, analysis)


@pytest.mark.parametrize(("group", "row", "analysis"), ROWS)
def test_a_wrong_case_is_refused_by_its_keys_with_a_remedy(
    group: dict[str, Any], row: tuple[list[str], str | list[str], str], analysis: str | None
) -> None:
    settings, keys, words = row
    expected = [keys] if isinstance(keys, str) else keys
    faults_found = found(group, settings, analysis)
    assert sorted(fault.key for fault in faults_found) == sorted(expected)
    assert any(words in f"{fault.problem} {fault.remedy}" for fault in faults_found if fault.key == expected[0])
    assert all(fault.remedy for fault in faults_found)
