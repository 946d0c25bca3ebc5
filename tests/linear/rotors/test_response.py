"""The linear unbalance response against closed forms and against the synchronous motion of a run-up. Balance quality,
limits of vibration and separation margins against figures computed by hand."""

import csv
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Frb
from marches import in_two_bearings

import frbcli
from frbcli.analysis.order_tracking import order_track
from frbcli.arrays import larger_semi_axis
from frbcli.case.reading.load import case_from_dict, load_case
from frbcli.case.schema import Case
from frbcli.cycles.limit_cycles import limit_cycles
from frbcli.linear import response as of_response
from frbcli.linear.balance_quality import balance_quality, permissible_unbalance
from frbcli.linear.damped_modes import api_limit, required_margin, vibration_limits, zone_limits
from frbcli.linear.response import DOUBTFUL, Response, forced_motion, response
from frbcli.linear.stability import stability_points
from frbcli.plot.machine.response import response_figure
from frbcli.rotor.assembly import jeffcott_rotor
from frbcli.runs.run import runup

MASS, JOURNALS, SHAFT, UNBALANCE, OUTER, INNER = 6.0, 0.1, 5e6, 3e-6, 4.0, 0.7


def test_speeds_that_are_given_are_solved_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without films nobody asks for a curve around the peaks, which took minutes of a shaft with hundreds of modes."""
    solved: list[int] = []

    def counted(case: Case, speeds: Sequence[float], *more: Any) -> Any:
        solved.append(len(speeds))
        return stability_points(case, speeds, *more)

    monkeypatch.setattr(of_response, "stability_points", counted)
    case = load_case("seal")
    few = response(case, [20.0, 50.0])
    assert (solved, len(few.speeds_Hz)) == ([2], 2)
    whole = response(case)
    assert len(solved) == 3
    assert len(whole.speeds_Hz) == sum(solved[1:])


@pytest.mark.parametrize("omega", [50.0, 700.0, 912.0, 3000.0])
def test_a_jeffcott_rotor_on_springs_and_dampers_has_its_closed_form(omega: float) -> None:
    """Equal in x and y, and not cross-coupled: z = x + iy turns forward alone, two equations remain."""
    rotor = in_two_bearings(jeffcott_rotor(MASS, JOURNALS, SHAFT, UNBALANCE, OUTER, INNER, 9.81))
    k, c = 3e6, 2e3
    motion = forced_motion(rotor, omega, (omega, omega**2 * rotor.unbalance), k * np.eye(2)[None], c * np.eye(2)[None])
    spring = SHAFT + 1j * omega * INNER
    disk = spring - MASS * omega**2 + 1j * omega * OUTER
    journal = spring - JOURNALS * omega**2 + 2.0 * (k + 1j * omega * c)  # two bearings
    pull = 1j * UNBALANCE * omega**2  # (2.3) at a constant speed: the heavy spot is a quarter of a turn ahead
    z_disk = pull / (disk - spring**2 / journal)
    z_journal = spring / journal * z_disk
    x_journal, x_disk, y_journal, y_disk = motion
    assert 0.5 * (x_disk + 1j * y_disk) == pytest.approx(z_disk, rel=1e-12)
    assert 0.5 * (x_journal + 1j * y_journal) == pytest.approx(z_journal, rel=1e-12)
    assert abs(x_disk - 1j * y_disk) < 1e-12 * abs(x_disk)


@pytest.fixture(scope="module")
def jeffcott() -> Response:
    return response(load_case("jeffcott"))


def test_a_fast_ramp_follows_it_too(tmp_path: Path) -> None:
    """1000 Hz/s, between the transient of the start and the whirl: within 2 %."""
    ramp = ["speed.from=60 Hz", "speed.to=220 Hz", "speed.duration=0.16 s"]
    fast = load_case("rigid", [*ramp, "start.position=resting", "rotor.unbalance=3 g*mm"])
    run = runup(fast, tmp_path / "run.h5")
    track = order_track(run, 1.0, "journal", revolutions=8)
    found = response(fast)
    seen = (track.speed_Hz > 120.0) & (track.speed_Hz < 200.0)
    mine = np.interp(track.speed_Hz[seen], found.speeds_Hz, np.abs(found.forward[:, 0]))
    assert np.abs(track.forward[seen]) == pytest.approx(mine, rel=0.02)


def test_bearing_forces_balance_the_rotor(jeffcott: Response) -> None:
    """Both bearings carry what accelerates disk, journals and unbalance, less the damping from outside."""
    rotor = load_case("jeffcott").rotor
    for i, speed in enumerate(jeffcott.speeds_Hz):
        omega = 2.0 * math.pi * speed
        journal, disk = jeffcott.motion[i]
        pull = omega**2 * rotor.unbalance * np.array([1j, 1.0])  # type: ignore[union-attr]
        inertia = -(omega**2) * (rotor.journal_mass * journal + rotor.mass * disk)  # type: ignore[union-attr]
        outer = 1j * omega * rotor.external_damping * disk  # type: ignore[union-attr]
        assert 2.0 * jeffcott.forces[i, 0] == pytest.approx(inertia + outer - pull, rel=1e-9)


def test_orbits_are_ellipses_with_the_amplitude_as_larger_semi_axis(jeffcott: Response) -> None:
    place = int(np.argmax(jeffcott.amplitude[:, 1]))
    radius = np.hypot(*jeffcott.orbit(place, 1, 3600).T)
    assert radius.max() == pytest.approx(jeffcott.amplitude[place, 1], rel=1e-5)
    smaller = abs(abs(jeffcott.forward[place, 1]) - abs(jeffcott.backward[place, 1]))
    assert radius.min() == pytest.approx(smaller, rel=1e-3)
    assert any(abs(speed - jeffcott.speeds_Hz[place]) < 2.5 for speed in jeffcott.critical_speeds_Hz)


def test_the_command_writes_table_picture_and_document(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    monkeypatch.chdir(tmp_path)
    frb("runup", "jeffcott", "-o", "run.h5", "--no-picture", "--quiet", "--set", "speed.duration=1 s")
    said = frb("response", "jeffcott", "--run", "run.h5", "--csv", "t.csv", "--json")
    text = frb("response", "jeffcott", "--run", "run.h5", "--csv", "t.csv").out
    document = json.loads(said.out)
    assert {"speed_Hz", "node", "amplitude_m", "phase_deg"} <= set(document["points"][0])
    speeds = 120 + len(document["critical_speeds"])
    assert 2 * 120 < len(document["points"]) <= 2 * (speeds + 6)  # films are solved at their peaks, too
    # one resonance: of the disk at 142 Hz, of the journal at 131 Hz, and listed where more moves
    assert document["critical_speeds_Hz"] == pytest.approx([141.8], abs=1.0)
    assert max(map(len, text.splitlines())) <= 80
    rows = list(csv.DictReader((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()))
    assert float(rows[-1]["amplitude_m"]) == pytest.approx(document["points"][-1]["amplitude_m"])
    assert (tmp_path / "jeffcott-response.png").read_bytes().startswith(b"\x89PNG")


def test_the_picture_has_the_orbits_at_the_largest_amplitude_and_the_highest_speed(jeffcott: Response) -> None:
    panels = [axes for axes in response_figure(jeffcott).axes if axes.lines]  # without those of the legends
    assert len(panels) == 6
    assert all(panel.get_title(loc="left") for panel in panels)
    for panel, speed in zip(panels[4:], (int(np.argmax(jeffcott.amplitude.max(axis=1))), -1), strict=True):
        assert panel.get_title(loc="left") == f"orbits at {jeffcott.speeds_Hz[speed]:.4g} Hz; dots: mark along x"
        for number, curve in enumerate(panel.lines[::2]):
            reach = np.hypot(*curve.get_data()).max()
            assert reach == pytest.approx(1e6 * jeffcott.amplitude[speed, number], rel=1e-3)


# --- motions that linear coefficients do not describe ---


@pytest.mark.parametrize(("unbalance", "kinds"), [
    ("3 g*mm", {"linear"}), ("400 g*mm", {"linear", "doubtful", "beyond-gap"}),
])  # fmt: skip
def test_motions_beyond_the_gap_are_told(
    unbalance: str, kinds: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, frb: Frb
) -> None:
    """In table, JSON, CSV and picture, by the eccentricity on the orbit about the resting position."""
    monkeypatch.chdir(tmp_path)
    words = ["response", "jeffcott", "--set", "film.theory=short", "--set", f"rotor.unbalance={unbalance}"]
    said = frb(*words, "--json", "--csv", "t.csv", "--no-picture")
    text = frb(*words, "--csv", "t.csv", "--no-picture").out
    document = json.loads(said.out)
    assert {point["validity"] for point in document["points"]} == kinds
    largest = max(film["eccentricity_max"] for film in document["films"])
    for mark, kind in (("?: doubtful at", "doubtful"), ("!: not possible at", "beyond-gap")):
        assert (mark in text) == (kind in kinds)
    assert ("up to an eccentricity of" in text.replace("\n", " ")) == (largest >= 1.0)
    assert max(map(len, text.splitlines())) <= 80
    rows = list(csv.DictReader((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()))
    assert {row["validity"] for row in rows} == kinds
    found = response(load_case("jeffcott", ["film.theory=short", f"rotor.unbalance={unbalance}"]))
    amplitude = response_figure(found).axes[0]
    assert len(amplitude.patches) >= len(kinds - {"linear"})
    gap = [line for line in amplitude.lines if line.get_label() == "clearance"]
    assert [float(line.get_ydata()[0]) for line in gap] == ([35.0] if kinds != {"linear"} else [])


def test_the_largest_eccentricity_is_that_of_the_orbit_about_the_resting_position() -> None:
    found = response(load_case("jeffcott", ["film.theory=short", "rotor.unbalance=200 g*mm"]), [60.0, 90.0])
    for number, point in enumerate(found.resting):
        orbit = found.orbit(number, found.points.index("journal"), 720) / 35e-6
        places = orbit + point.films[0].displacement
        assert found.eccentricity_max[number, 0] == pytest.approx(np.hypot(*places.T).max(), rel=1e-4)
        left = 1.0 - point.films[0].eccentricity
        assert found.gap_share[number, 0] == pytest.approx(np.hypot(*orbit.T).max() / left, rel=1e-4)


@pytest.mark.parametrize(("name", "unbalance", "to_Hz"), [
    ("jeffcott", 60, 170), pytest.param("rigid", 100, 160, marks=pytest.mark.nightly),
])  # fmt: skip
def test_linear_amplitudes_hold_up_to_the_share_of_the_gap_that_is_called_doubtful(
    name: str, unbalance: int, to_Hz: float
) -> None:
    """Against the nonlinear synchronous response: 4 % up to a tenth of the gap that is left, 15 % up to DOUBTFUL."""
    case = load_case(name, ["film.theory=short", f"rotor.unbalance={unbalance} g*mm", f"speed.to={to_Hz} Hz"])
    nonlinear = limit_cycles(case).synchronous
    found = response(case, [point.speed_Hz for point in nonlinear])
    for number, speed in enumerate(found.speeds_Hz):
        for point in nonlinear:
            if point.speed_Hz != pytest.approx(speed, rel=1e-12):
                continue
            share = found.gap_share[number, 0]
            linear = larger_semi_axis(found.in_films[number, 0])
            error = abs(2.0 * larger_semi_axis(point.harmonics[1, 0]) / linear - 1.0)
            assert error < (0.04 if share < 0.1 else 0.15 if share < DOUBTFUL else math.inf)
    assert found.gap_share.max() > DOUBTFUL


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
    (130.0, 10.0, 0.25), (110.0, 10.0, 0.15), (130.0, None, None), (80.0, 18.5, 0.16), (80.0, 50.0, 0.16),
    (130.0, 50.0, 0.26), (80.0, 15.0, 0.17 * (1.0 - 1.0 / 13.5)),
])  # fmt: skip
def test_the_margin_grows_with_the_amplification_factor(speed: float, factor: float | None, asked: float) -> None:
    """17 (1 - 1 / 8.5) = 15 %, at most 16 %, and 10 % more above the range."""
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
    assert limits["margin_formula"] in " ".join(text.split())
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


@pytest.mark.parametrize("table", ["rotor", "disk"])
def test_a_grade_counts_what_is_lost(table: str, frb: Frb) -> None:
    """10 g mm and 20 g mm a quarter turn ahead are 500^(1/2) g mm, from the beginning or after the loss."""
    name, place = ("jeffcott", "rotor") if table == "rotor" else ("turbocharger-ball", "disk.0")
    for time, more in (("0 s", []), ("0.1 s", ["--after-loss"])):
        loss = f'{place}.loss={{time="{time}", unbalance="20 g*mm", phase="90 deg"}}'
        settings = [f"{place}.unbalance=10 g*mm", loss, *(["film.theory=short"] if table == "rotor" else [])]
        words = ["response", name, "--no-picture", "--json", "--speed", "50 Hz", "--grade", "G2.5", *more]
        said = frb(*words, *(word for each in settings for word in ("--set", each)))
        first = said.document["grade"]["planes"][0]
        assert first["unbalance_kg_m"] == pytest.approx(math.sqrt(500.0) * 1e-6, rel=1e-9)
        assert first["angle_deg"] == pytest.approx(math.degrees(math.atan2(2.0, 1.0)), abs=1e-6)


@pytest.mark.parametrize("grade", ["Gx", "0", "-2.5", "G", "G1e9", "nan", "2.5 mm"])
def test_what_is_no_grade_is_refused(grade: str, frb: Frb) -> None:
    assert "Write e.g. G6.3" in frb("response", "jeffcott", "--grade", grade, "--no-picture", code=2).err
    with pytest.raises(frbcli.InputError, match=r"Write e\.g\. G6\.3"):
        balance_quality(frbcli.load_case("jeffcott"), grade)


@pytest.mark.parametrize("grade", ["G6.3", "g6.3", "G 6.3", "6.3", "6.3 mm/s"])
def test_a_grade_is_written_as_people_do(grade: str) -> None:
    assert balance_quality(frbcli.load_case("jeffcott"), grade).grade_mm_s == 6.3
