"""Balance quality, limits of vibration and separation margins against figures computed by hand."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb

import frbcli
from frbcli.case.reading.load import case_from_dict
from frbcli.linear.balance_quality import balance_quality, permissible_unbalance
from frbcli.linear.damped_modes import api_limit, required_margin, vibration_limits, zone_limits

TURN = 2.0 * math.pi


def two_disks(bearings: tuple[str, ...] = ("20 mm", "280 mm"), **second: str) -> frbcli.Case:
    """A shaft of 300 mm with 1 kg at 60 mm and 2 kg at 240 mm."""
    disks: list[dict[str, Any]] = [
        {"name": "a", "position": "60 mm", "mass": "1 kg", "unbalance": "3 g*mm"},
        {"name": "b", "position": "240 mm", "mass": "2 kg"} | second,
    ]
    return case_from_dict(
        {
            "rotor": {"kind": "turbocharger"},
            "shaft": [{"length": "100 mm", "diameter": "20 mm"}, {"length": "200 mm", "diameter": "20 mm"}],
            "disk": disks,
            "bearing": [
                {"kind": "coefficients", "name": f"at {place}".replace(" ", "_"), "position": place,
                 "stiffness": "3e6 N/m", "damping": "500 N*s/m"}
                for place in bearings
            ],
            "speed": {"from": "10 Hz", "to": "100 Hz", "duration": "1 s"},
        },
        "two-disks",
    )  # fmt: skip


def test_the_permissible_unbalance_is_that_of_the_standard() -> None:
    """G 2.5 of 6 kg at 54000 rpm: 2.5 mm/s 6000 g / 5655 1/s."""
    assert 1e6 * permissible_unbalance(2.5, 6.0, 900.0) == pytest.approx(2.6526, rel=1e-4)
    found = balance_quality(frbcli.load_case("jeffcott"), "G6.3", 200.0)
    assert 1e6 * found.permissible == pytest.approx(1000.0 * 6.3 * 6.1 / (TURN * 200.0), rel=1e-12)
    assert found.reached_mm_s == pytest.approx(3e-6 / 6.1 * TURN * 200.0 * 1000.0, rel=1e-12)
    assert [plane.kind for plane in found.planes] == ["disk", "sum"]  # both bearings have half of it
    assert found.within


def test_it_is_divided_by_the_levers_of_the_centre_of_mass() -> None:
    case = two_disks(unbalance="4 g*mm", phase="90 deg")
    shaft = 0.25 * math.pi * 0.02**2 * 0.3 * 7850.0
    mass = 3.0 + shaft
    centre = (1.0 * 0.06 + 2.0 * 0.24 + shaft * 0.15) / mass
    found = balance_quality(case, 2.5)
    first, second = found.planes[-2:]
    assert (found.mass, found.centre_of_mass) == pytest.approx((mass, centre), rel=1e-12)
    whole = 2.5e-3 * mass / (TURN * 100.0)
    assert first.permissible == pytest.approx(whole * (0.28 - centre) / 0.26, rel=1e-12)
    assert second.permissible == pytest.approx(whole * (centre - 0.02) / 0.26, rel=1e-12)
    assert first.unbalance == pytest.approx((3e-6 * 220 + 4e-6j * 40) / 260, rel=1e-12)
    assert second.unbalance == pytest.approx((3e-6 * 40 + 4e-6j * 220) / 260, rel=1e-12)
    total = found.planes[2]
    assert (total.size, total.angle_deg) == pytest.approx((5e-6, math.degrees(math.atan2(4.0, 3.0))), rel=1e-12)


@pytest.mark.parametrize(("bearings", "shares"), [
    (("20 mm", "60 mm"), (0.3, 1.3)),  # it overhangs the second bearing
    (("160 mm", "290 mm"), (0.7, 0.3)),  # and here it is beside the first one
])  # fmt: skip
def test_no_plane_has_too_small_or_too_large_a_share(bearings: tuple[str, ...], shares: tuple[float, float]) -> None:
    found = balance_quality(two_disks(bearings), 2.5)
    assert [plane.permissible for plane in found.planes[-2:]] == pytest.approx(
        [found.permissible * share for share in shares], rel=1e-12
    )


def test_a_couple_is_seen_by_the_planes_alone() -> None:
    """Equal and opposite unbalances: none in sum, U 180 / 260 in each bearing."""
    found = balance_quality(two_disks(unbalance="3 g*mm", phase="180 deg"), 0.4)
    *_, total, first, second = found.planes
    assert total.size < 1e-20
    assert total.within
    assert (first.size, second.size) == pytest.approx((3e-6 * 180 / 260,) * 2, rel=1e-12)
    assert not found.within
    assert len(balance_quality(two_disks(("20 mm", "150 mm", "280 mm")), 2.5).planes) == 3  # not divided among three


def rigid(stiffness: float, damping: float, unbalance: str = "50 g*mm") -> frbcli.Case:
    """6 kg on two equal bearings."""
    return case_from_dict(
        {
            "rotor": {"kind": "rigid", "mass": "6 kg", "unbalance": unbalance},
            "bearing": {"kind": "coefficients", "stiffness": f"{stiffness!r} N/m", "damping": f"{damping!r} N*s/m"},
            "speed": {"from": "10 Hz", "to": "400 Hz", "duration": "1 s"},
        },
        "rigid",
    )


def test_vibration_is_compared_where_it_comes_nearest_to_its_limit() -> None:
    """z = U Omega^2 / (2 K - M Omega^2 + 2 i C Omega), peak to peak twice of it."""
    k, c, low, high = 1e6, 500.0, 130.0, 300.0
    case = rigid(k, c)
    found = vibration_limits(frbcli.response(case, operating_Hz=(low, high)), (low, high))
    speeds = np.linspace(low, high, 100001)
    omega = TURN * speeds
    size = 2.0 * np.abs(50e-6 * omega**2 / (2.0 * k - 6.0 * omega**2 + 2j * c * omega))
    rpm = 60.0 * speeds
    api, iso = 25.4e-6 * np.minimum(1.0, np.sqrt(12000.0 / rpm)), 4800e-6 / np.sqrt(rpm)
    assert found.covered
    (by_api,), (by_iso,) = found.api, found.iso
    assert by_api.ratio == pytest.approx(float((size / api).max()), rel=1e-3)
    assert by_iso.ratio == pytest.approx(float((size / iso).max()), rel=1e-3)
    assert by_iso.speed_Hz == pytest.approx(float(speeds[np.argmax(size / iso)]), abs=3.3)  # that of the sweep
    assert not by_api.within
    assert by_iso.zone == "A"


def test_zones_and_limits_are_those_of_the_standards() -> None:
    assert [float(limit) for limit in api_limit(np.array([100.0, 200.0, 800.0]))] == pytest.approx(
        [25.4e-6, 25.4e-6, 12.7e-6], rel=1e-12
    )
    assert [float(limit) for limit in zone_limits(60.0)] == pytest.approx([80e-6, 150e-6, 220e-6], rel=1e-12)
    omega, root = TURN * 200.0, math.sqrt(12000.0)
    size = 2.0 * omega**2 / abs(2e6 - 6.0 * omega**2 + 1e3j * omega)  # m p-p per kg m
    for boundary, zones in ((4800.0, "AB"), (9000.0, "BC"), (13200.0, "CD")):
        for share, zone in zip((0.999, 1.001), zones, strict=True):
            unbalance = share * boundary / root * 1e-6 / size
            found = frbcli.response(rigid(1e6, 500.0, f"{unbalance!r} kg*m"), [200.0])
            (point,) = vibration_limits(found, (200.0, 200.0)).iso
            assert point.zone == zone


@pytest.mark.parametrize(("speed", "factor", "asked"), [
    (80.0, 2.49, 0.0), (80.0, 2.5, 0.0), (80.0, 10.0, 0.15), (130.0, 2.49, 0.0), (130.0, 2.5, 0.10),
    (130.0, 10.0, 0.25), (110.0, 10.0, 0.15), (130.0, None, None),
])  # fmt: skip
def test_the_margin_grows_with_the_amplification_factor(speed: float, factor: float | None, asked: float) -> None:
    """17 (1 - 1 / 8.5) = 15 %, and 10 % more above the range."""
    found = required_margin(speed, factor, (100.0, 120.0))
    assert found == (None if asked is None else pytest.approx(asked, abs=1e-12))


def test_a_whirl_that_grows_makes_no_machine_acceptable(frb: Frb) -> None:
    words = ["response", "rigid", "--set", "film.theory=short", "--set", "rotor.unbalance=1 g*mm", "--no-picture"]
    said = frb(*words, "--operating", "200..250 Hz", "--json")
    text = frb(*words, "--operating", "200..250 Hz").out
    assert json.loads(said.out)["limits"]["whirling_Hz"]
    assert "Not acceptable by this alone" in text


def test_the_command_says_what_is_within(tmp_path: Path, frb: Frb) -> None:
    path = tmp_path / "rotor.toml"
    path.write_text(rigid(1e6, 500.0).source_text, encoding="utf-8")
    words = ["response", str(path), "--no-picture"]
    said = frb(*words, "--json", "--operating", "9000..12000 rpm", "--grade", "G6.3")
    text = frb(*words, "--operating", "9000..12000 rpm", "--grade", "G6.3").out
    document = json.loads(said.out)
    assert max(map(len, text.splitlines())) <= 80
    limits, grade = document["limits"], document["grade"]
    assert limits["operating_Hz"] == limits["covered_Hz"] == [150.0, 200.0]
    assert {150.0, 200.0} <= {point["speed_Hz"] for point in document["points"]}
    assert set(limits["api_617"]["points"][0]) == {
        "node", "speed_Hz", "peak_to_peak_m", "limit_m", "ratio", "within", "validity",
    }  # fmt: skip
    assert [margin["within"] for margin in limits["margins"]] == [True]
    assert grade["permissible_kg_m"] == pytest.approx(6.3e-3 * 6.0 / (TURN * 200.0))  # at the highest of operation
    assert grade["within"] is False
    assert "exceeds G6.3" in text
    assert "ISO" not in frb(*words).out  # nothing of it unless it is asked for
    assert "350 to 400 Hz alone" in " ".join(frb(*words, "--operating", "350..500 Hz").out.split())


@pytest.mark.parametrize("grade", ["Gx", "0", "-2.5", "G", "G1e9", "nan", "2.5 mm"])
def test_what_is_no_grade_is_refused(grade: str, frb: Frb) -> None:
    assert "Write e.g. G6.3" in frb("response", "jeffcott", "--grade", grade, "--no-picture", code=2).err
    with pytest.raises(frbcli.InputError, match=r"Write e\.g\. G6\.3"):
        balance_quality(frbcli.load_case("jeffcott"), grade)


@pytest.mark.parametrize("grade", ["G6.3", "g6.3", "G 6.3", "6.3", "6.3 mm/s"])
def test_a_grade_is_written_as_people_do(grade: str) -> None:
    assert balance_quality(frbcli.load_case("jeffcott"), grade).grade_mm_s == 6.3
