"""Whatever a file holds: a Case, or an InputError with faults; never anything else."""

import string
import tomllib
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from frbcli.case.reading.listing import values
from frbcli.case.reading.load import load_case, load_case_text
from frbcli.case.reading.settings import to_toml
from frbcli.case.reading.shipped import find_shipped, shipped_names
from frbcli.case.reading.tables import key_lines
from frbcli.case.schema import Case, json_schema
from frbcli.errors import InputError

BASE = find_shipped("jeffcott")
QUICK = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])

UNICODE = st.characters(exclude_categories=["Cs"])
KEYS = sorted({key for model in json_schema()["$defs"].values() for key in model.get("properties", {})})
QUANTITIES = ["35 um", "25 mm", "6 kg", "1 bar", "12 mPa*s", "300 Hz", "15 deg", "100 degC", "1 N*s/m", "10 s", "0.5"]
WORDS = ["jeffcott", "rigid", "turbocharger", "single-film", "floating-ring", "bores", "pocket", "none", "elastic"]
SCALARS = (
    st.sampled_from(QUANTITIES + WORDS)
    | st.booleans()
    | st.integers(-(10**20), 10**20)
    | st.floats()
    | st.text(UNICODE, max_size=8)
)
TREES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from([*KEYS, "kind"]) | st.text(UNICODE, max_size=5), inner, max_size=5)
    ),
    max_leaves=25,
)
PATHS = st.lists(st.sampled_from([*KEYS, *json_schema()["properties"], "0", "1"]), min_size=1, max_size=4)


def outcome(read: Callable[[], Case]) -> Case | InputError:
    """What reading gives; any other exception passes and fails the test."""
    try:
        return read()
    except InputError as error:
        return error


def without_text(case: Case) -> Case:
    """The same case as if it were made in Python."""
    made = Case.model_validate(case.model_dump(by_alias=True, exclude_unset=True))
    assert made == case
    return made


def load(text: str, overrides: list[str] | None = None) -> Case | None:
    """The case, which its own text gives again, read or made; or None after a look at every fault."""
    found = outcome(lambda: load_case_text(text, overrides or []))
    if isinstance(found, Case):
        assert load_case_text(found.source_text) == found
        assert load_case_text(without_text(found).source_text) == found
        return found
    assert found.faults
    for fault in found.faults:
        assert fault.key
        assert fault.problem
        assert fault.remedy
        assert fault.line is None or 1 <= fault.line <= text.count("\n") + 1
        assert str(fault).encode()
    return None


@QUICK
@given(st.text(UNICODE))
def test_any_text(text: str) -> None:
    load(text)


@QUICK
@given(st.dictionaries(st.sampled_from(sorted(json_schema()["properties"])), TREES, max_size=8))
def test_any_tables(data: dict[str, Any]) -> None:
    load(to_toml(data))


@QUICK
@given(position=st.integers(0, len(BASE)), removed=st.integers(0, 40), inserted=st.text(UNICODE, max_size=6))
def test_shipped_case_with_damaged_text(position: int, removed: int, inserted: str) -> None:
    load(BASE[:position] + inserted + BASE[position + removed :])


@QUICK
@given(st.lists(st.tuples(PATHS, TREES), min_size=1, max_size=3))
def test_shipped_case_with_any_tables_in_it(changes: list[tuple[list[str], Any]]) -> None:
    overrides = [f"{'.'.join(path)}={to_toml({'v': value}).partition('=')[2].strip()}" for path, value in changes]
    load(BASE, overrides)


@QUICK
@given(st.lists(st.text(max_size=30), max_size=3))
def test_any_settings(overrides: list[str]) -> None:
    load(BASE, overrides)


@QUICK
@given(st.binary(max_size=300) | st.binary(max_size=20).map(lambda noise: BASE.encode()[:400] + noise))
def test_any_file(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    file = tmp_path_factory.mktemp("case") / "case.toml"
    file.write_bytes(content)
    found = outcome(lambda: load_case(file))
    assert isinstance(found, Case) or found.faults


@QUICK
@given(st.text(max_size=50))
def test_any_name(name: str) -> None:
    found = outcome(lambda: load_case(name))
    assert found.name in shipped_names() if isinstance(found, Case) else found.faults


@QUICK
@given(
    speed=st.floats(0, 5000),
    clearance=st.floats(1e-6, 600e-6),
    mass=st.floats(1e-3, 1e3),
    viscosity=st.floats(1e-4, 10),
)
def test_sound_values_are_taken_as_they_are(speed: float, clearance: float, mass: float, viscosity: float) -> None:
    speed = 0.0 if speed < 1e-15 else speed
    case = load(
        BASE,
        [
            "confirm=['gap-growth']",
            f"speed.to={speed!r}",
            f"bearing.clearance={clearance!r}",
            f"rotor.mass={mass!r}",
            f"oil.viscosity={viscosity!r}",
        ],
    )
    assert case is not None
    taken = (case.speed.end, case.bearings[0].clearance, case.rotor.mass, case.oil.viscosity)  # type: ignore[union-attr]
    assert taken == (speed, clearance, mass, viscosity)


@settings(QUICK, max_examples=25)
@given(name=st.sampled_from(shipped_names()), data=st.data())
def test_a_changed_shipped_case_is_read_again_from_its_made_text(name: str, data: st.DataObject) -> None:
    case = load_case(name)
    numbers = [value for value in values(case) if isinstance(value.value, float)]
    changes = data.draw(st.lists(st.tuples(st.sampled_from(numbers), st.floats(0.99, 1.01)), max_size=5))
    load(case.source_text, [f"{value.key}={value.value * factor!r}" for value, factor in changes])


TOML_VALUES = st.recursive(
    st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | st.text(UNICODE, max_size=10),
    lambda inner: st.lists(inner, max_size=4),
    max_leaves=6,
)
TOML_TABLES = st.recursive(
    st.dictionaries(st.text(UNICODE, max_size=6), TOML_VALUES, max_size=4),
    lambda inner: st.dictionaries(
        st.text(UNICODE, max_size=6), TOML_VALUES | inner | st.lists(inner, max_size=3), max_size=4
    ),
    max_leaves=8,
)


@QUICK
@given(TOML_TABLES)
def test_written_tables_read_back_and_every_key_has_its_line(data: dict[str, Any]) -> None:
    text = to_toml(data)
    assert tomllib.loads(text) == data
    lines = key_lines(text)
    for path in _paths(data, ()):
        assert 1 <= lines[path] <= text.count("\n")
    for key in (key for key in data if key and all(letter in string.ascii_letters for letter in key)):
        line = text.split("\n")[lines[(key,)] - 1]
        assert line.lstrip("[").startswith(key)


def _paths(data: Any, path: tuple[str | int, ...]) -> list[tuple[str | int, ...]]:
    """The paths of all tables and keys."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    found = [((*path, key), value) for key, value in items]
    return [inner for here, value in found for inner in (here, *_paths(value, here))]
