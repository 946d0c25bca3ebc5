"""Cases made and changed in Python: each has one true text, and is what its run is compared by."""

import copy
import pickle
from inspect import isabstract
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import frbcli
from frbcli.case.bearing import SingleFilmBearing
from frbcli.case.model import Model
from frbcli.case.reading.load import case_from_dict, describes, load_case, load_case_text
from frbcli.case.reading.settings import as_tables, parse
from frbcli.case.reading.shipped import shipped_names
from frbcli.case.rotor import RigidRotor
from frbcli.case.schema import Case
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
