"""Cases made and changed in Python: each has one true text, and is what its run is compared by. Whatever a file holds:
a Case, or an InputError with faults; never anything else."""

import copy
import pickle
import string
import tomllib
from collections.abc import Callable
from inspect import isabstract
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import frbcli
from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.model import Model
from frbcli.case.reading.listing import values
from frbcli.case.reading.load import case_from_dict, describes, load_case, load_case_text
from frbcli.case.reading.settings import as_tables, parse, to_toml
from frbcli.case.reading.shipped import find_shipped, shipped_names
from frbcli.case.reading.tables import key_lines
from frbcli.case.rotor import RigidRotor
from frbcli.case.schema import Case, json_schema
from frbcli.case.supplies import CircumferentialGroove
from frbcli.errors import Fault, InputError
from frbcli.runs.run import runup
from frbcli.studies.sweep import Workers

RIGID: dict[str, Any] = {
    "rotor": {"kind": "rigid", "mass": 6.1, "unbalance": 3e-6},
    "bearing": {"kind": "single-film", "width": "20 mm", "diameter": "25 mm", "clearance": 35e-6, "ends": "oil-bath",
                "supply": {"kind": "circumferential-groove", "pressure": "1 bar"}},
    "oil": {"viscosity": "12 mPa*s"},
    "film": {"theory": "short"},
    "speed": {"from": 20.0, "to": 60.0, "duration": 0.05},
}  # fmt: skip


def made(**tables: Any) -> Case:
    """A case without any file."""
    return Case.model_validate({**RIGID, **tables})


def faults_of(data: Any) -> dict[str, Fault]:
    with pytest.raises(InputError) as caught:
        case_from_dict(data)
    return {fault.key: fault for fault in caught.value.faults}


# --- the text ---


@pytest.mark.parametrize("name", shipped_names())
def test_the_made_text_of_a_shipped_case_gives_it_again(name: str) -> None:
    case = load_case(name)
    assert case.model_copy().source_text == case.source_text
    textless = Case.model_validate(parse(case.source_text))
    again = load_case_text(textless.source_text)
    assert again == textless == case
    assert again.source_text == textless.source_text


def test_a_made_case_has_a_text_with_units() -> None:
    text = made(name="mine").source_text
    assert 'clearance = "35 um"' in text
    assert 'to = "60 Hz"' in text
    assert load_case_text(text) == made(name="mine")
    assert "penalty" not in text  # what is not set stays out


def test_digits_that_no_readable_unit_has_are_kept() -> None:
    length = 0.1 + 0.2
    case = made(bearing={**RIGID["bearing"], "width": length / 15, "clearance": 35e-6 * (1 + 2e-16)})
    assert load_case_text(case.source_text).bearings == case.bearings


def test_a_changed_case_has_its_own_text() -> None:
    case = load_case("jeffcott")
    faster = case.with_settings({"speed.to": np.float64(400.0)})
    assert load_case_text(faster.source_text).speed.end == 400.0
    assert load_case_text(case.source_text).speed.end == 300.0
    assert faster.with_settings({"speed": case.speed}) == case
    for same in (copy.deepcopy(case), copy.copy(case), pickle.loads(pickle.dumps(case))):
        assert same == case
        assert same.source_text == case.source_text
    other = pickle.loads(pickle.dumps(faster))
    assert load_case_text(other.source_text) == faster


def test_cases_are_equal_by_their_values() -> None:
    case = load_case("jeffcott")
    written = load_case("jeffcott", ["bearing.clearance=0.035 mm", "speed.to=18000 rpm"])
    assert written.source_text != case.source_text
    assert written == case
    assert hash(written) == hash(case)
    assert load_case("jeffcott", ["speed.to=301 Hz"]) != case
    assert case != "jeffcott"


def test_bearings_made_in_python_are_numbered_as_in_a_file() -> None:
    bearing = SingleFilmBearing.model_validate({**RIGID["bearing"], "position": "10 mm"})
    rotor = {"kind": "turbocharger"}
    shaft = [{"length": "1 m", "diameter": "20 mm"}]
    case = made(rotor=rotor, shaft=shaft, bearing=(bearing, {**RIGID["bearing"], "position": "90 mm"}))
    assert [found.name for found in case.bearings] == ["1", "2"]
    assert load_case_text(case.source_text) == case
    swapped = case.with_settings({"bearing": [{**as_tables(bearing), "name": "left"}, case.bearings[0]]})
    assert [found.name for found in load_case_text(swapped.source_text).bearings] == ["left", "1"]
    assert made(bearing=bearing).bearings == (bearing,)


# --- with settings ---


def test_settings_are_read_as_in_a_file() -> None:
    case = load_case("jeffcott")
    text = case.with_settings("oil.viscosity = 50 mPa*s", "speed.to=200 Hz")
    assert (text.oil.viscosity, text.speed.end) == (0.05, 200.0)
    table = case.with_settings({"oil.viscosity": "50 mPa*s", "speed": {"from": 0, "to": "200 Hz", "duration": 10.0}})
    assert text == table == load_case("jeffcott", ["oil.viscosity=50 mPa*s", "speed.to=200 Hz"])
    assert load_case_text(text.source_text) == text
    assert case == load_case("jeffcott")
    assert case.with_settings() == case
    assert case.with_settings({"title": "3"}).title == "3"
    assert case.with_settings({"title": "a"}, "title=b", {"title": None}).title == ""
    assert case.with_settings({"thermal": None, "start.displacement": np.array([0.1, 0.0])}).start.displacement


def test_every_fault_of_settings_is_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        load_case("jeffcott").with_settings(
            "nothing", "oil.viscositi=1 Pa*s", {"bearing.clearance": "35 mn", "bearing.supply.pressure": 5.0, "": 1}
        )
    keys = [fault.key for fault in caught.value.faults]
    assert set(keys) == {"--set", "settings", "oil.viscositi", "bearing.clearance", "bearing.supply.pressure"}
    with pytest.raises(InputError, match="is no setting"):
        load_case("jeffcott").with_settings(["oil.viscosity=50 mPa*s"])  # type: ignore[arg-type]
    with pytest.raises(InputError, match="nested too deeply"):
        load_case("jeffcott").with_settings({"oil": _deep()})


def _deep() -> dict[str, Any]:
    deep: dict[str, Any] = {}
    deep["in"] = deep
    return deep


def records() -> list[type[Model]]:
    """Every frozen record that a case is made of."""
    found = [Model]
    for each in found:
        found += [model for model in each.__subclasses__() if model not in found]
    return found


@pytest.mark.parametrize("record", [one for one in records() if not isabstract(one)], ids=lambda one: one.__name__)
def test_no_record_is_changed_in_another_way(record: type[Model]) -> None:
    some = record.__new__(record)
    name = next(iter(record.model_fields), "anything")
    for key in (name, "unknown"):
        for change in (
            lambda key=key: some.model_copy(update={key: 1}),
            lambda key=key: some.copy(update={key: 1}),
            lambda key=key: setattr(some, key, 1),
            lambda key=key: delattr(some, key),
            lambda key=key: record.model_construct(**{key: 1}),
        ):
            with pytest.raises(InputError, match=r"frozen.*case\.with_settings\("):
                change()


# --- from a dict ---


def test_a_dict_is_a_case() -> None:
    case = case_from_dict(RIGID, name="mine")
    assert frbcli.case_from_dict is case_from_dict
    assert case == made(name="mine")
    assert load_case_text(case.source_text) == case


def test_a_dict_may_hold_models_and_numbers_of_numpy() -> None:
    groove = CircumferentialGroove(kind="circumferential-groove", pressure=1e5)
    bearing = {**RIGID["bearing"], "supply": groove, "clearance": np.float64(35e-6), "lobes": None}
    start = {"displacement": np.array([0.1, -0.2])}
    case = case_from_dict(
        {**RIGID, "rotor": RigidRotor(kind="rigid", mass=6.1, unbalance=3e-6), "bearing": (bearing,), "start": start}
    )
    assert case.bearings == made().bearings
    assert case.start.displacement == (0.1, -0.2)
    assert case_from_dict(case) == case  # type: ignore[arg-type]


def test_every_fault_of_a_dict_is_told_at_once() -> None:
    bearing = {**RIGID["bearing"], "clearance": 35e-3, "width": "20 mn"}
    faults = faults_of({**RIGID, "bearing": [bearing], "oil": {}, "spede": {}, "start": {"displacement": (0.9, 0.9)}})
    assert set(faults) == {"bearing.0.clearance", "bearing.0.width", "oil.viscosity", "spede", "start.displacement"}
    assert all(fault.problem and fault.remedy and fault.line is None for fault in faults.values())
    assert faults["bearing.0.clearance"].value == "0.035"
    assert faults["spede"].remedy == 'Did you mean "speed"?'


def test_what_is_no_table_of_tables_is_a_fault() -> None:
    deep: dict[str, Any] = {}
    deep["in"] = deep
    assert faults_of({**RIGID, "oil": deep})["oil.in.in"].problem == "is nested too deeply."
    assert faults_of([RIGID])["data"].remedy
    assert faults_of({**RIGID, 3: 4})["3"].problem == "is not known here."
    assert "rotor" in faults_of({**RIGID, "rotor": object()})


# --- its runs ---


def test_a_run_of_another_made_case_is_not_taken_for_this_one(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    run = runup(made(), path)
    assert load_case_text(run.case_text) == made()
    other = made(oil={"viscosity": "13 mPa*s"})
    with pytest.raises(InputError, match="another case"):
        runup(other, path, resume=True)
    assert runup(made(), path, resume=True).cost == run.cost


def test_a_run_is_that_of_a_case_however_it_is_written(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    run = runup(made(name="first"), path)
    speed = {"from": "0.02 kHz", "to": "3600 rpm", "duration": "50 ms"}
    same = made(name="second", title="of the same machine", speed=speed)
    assert runup(same, path, resume=True).cost == run.cost


def test_texts_of_older_versions_are_those_of_their_cases() -> None:
    slow = load_case("jeffcott", ["bearing.clearance=0.9 um", "speed.to=10 Hz", "confirm=['clearance']"])
    older = slow.source_text.replace('confirm = ["clearance"]\n', "")
    assert "confirm" not in older
    assert describes(older, slow)  # nothing had to be confirmed then
    for unreadable in ("", "[", "[oil]\n", older.replace("[oil]", "[oli]")):
        assert not describes(unreadable, slow)


def test_a_sweep_of_a_made_case(tmp_path: Path) -> None:
    points = {"bearing.clearance": ["30 um", "35 um"]}
    found = frbcli.sweep(made(), points, tmp_path / "study", workers=Workers(jobs=1))
    assert [point.status for point in found.points] == ["finished", "finished"]
    again = frbcli.sweep(made(speed={"from": "20 Hz", "to": "60 Hz", "duration": "50 ms"}), points, tmp_path / "study")
    assert [point.cost for point in again.points] == [point.cost for point in found.points]
    with pytest.raises(InputError, match="another sweep"):
        frbcli.sweep(made(oil={"viscosity": "13 mPa*s"}), points, tmp_path / "study")


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
@example({"bearing": {"kind": []}})
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
