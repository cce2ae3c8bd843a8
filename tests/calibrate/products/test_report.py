"""The report's numbers are those of errors that are known, and requirements are judged by them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from algorithms.calibration.hull import Hull
from algorithms.contract import FeatureKind
from calibrate.calibration import Calibration
from calibrate.documents import save
from calibrate.report.errors import (
    Errors,
    by_axis,
    by_band,
    by_temperature,
    fewest_for,
    field_of,
    level,
)
from calibrate.report.factory import compared_with
from calibrate.report.page import report
from calibrate.report.requirement import RequirementError, judged, requirement
from calibrate.verdict import next_poses
from tests.calibrate.bench import HEADER, grid, spots, sun_of, turn, write
from tests.calibrate.samples import samples

SUN = sun_of(grid(21, 40.0))


def known(offsets: np.ndarray, sigma: float = 0.05, **context: np.ndarray) -> Errors:
    """Errors that the test states, radians, at the poses of a grid."""
    readings = samples(SUN[:, :2], SUN, FeatureKind.BALANCE, **context)
    size = np.degrees(np.linalg.norm(offsets, axis=1))
    return Errors(readings, offsets, size, np.full((len(SUN), 2), sigma))


def towards(axis: int) -> np.ndarray:
    """Unit vectors square to each direction, towards an axis."""
    made = np.eye(3)[axis] - SUN[:, [axis]] * SUN
    return np.asarray(made / np.maximum(np.linalg.norm(made, axis=1), 1e-12)[:, None])


@pytest.mark.parametrize(("axis", "name"), [(0, "along x"), (1, "along y")])
def test_a_shift_along_an_axis_is_the_mean_error_of_that_axis(axis: int, name: str) -> None:
    rows = {row.name: row for row in by_axis(known(np.radians(0.2) * towards(axis)))}
    assert rows[name].mean_deg == pytest.approx(0.2)
    assert rows[name].level95_deg == pytest.approx(0.2)
    assert rows[name].rms_deg == pytest.approx(0.2)


def test_errors_away_from_the_boresight_are_of_the_off_axis_angle_alone() -> None:
    away = -towards(2)  # zero on the boresight, where nothing is away from it
    rows = {row.name: row for row in by_axis(known(np.radians(0.3) * away))}
    assert rows["off-axis angle"].mean_deg == pytest.approx(0.3)
    assert rows["around the boresight"].rms_deg == pytest.approx(0.0, abs=1e-9)
    turned = np.cross([0.0, 0.0, 1.0], SUN)  # about the boresight
    rows = {row.name: row for row in by_axis(known(np.radians(0.3) * turned))}
    assert rows["around the boresight"].mean_deg > 0.0
    assert rows["off-axis angle"].rms_deg == pytest.approx(0.0, abs=1e-9)


def test_bands_hold_every_pose_once_and_say_what_intervals_cover() -> None:
    size = np.random.default_rng(3).normal(0.0, np.radians(0.05), (2, len(SUN), 1))
    x = towards(0)
    rows = by_band(known(size[0] * x + size[1] * np.cross(SUN, x)))
    assert sum(row.samples for row in rows[:-1]) == rows[-1].samples == len(SUN)
    assert rows[-1].coverage == pytest.approx(0.95, abs=0.03)
    assert rows[-1].rms_deg == pytest.approx(0.05 * np.sqrt(2.0), rel=0.1)
    assert rows[0].name == "0 to 10 deg"


def test_errors_are_told_apart_by_fifths_of_the_temperature() -> None:
    """Those of a fifth are its own tenths of a degree."""
    fifth = np.arange(len(SUN)) * 5 // len(SUN)
    size = np.radians(0.1 * (1.0 + fifth))[:, None] * towards(0)
    warmth = 280.0 + 10.0 * fifth + np.linspace(0.0, 9.0, len(SUN))
    rows = by_temperature(known(size, temperature_K=warmth))
    assert [row.rms_deg for row in rows] == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5], rel=0.02)
    assert sum(row.samples for row in rows) == len(SUN)
    assert max(row.samples for row in rows) - min(row.samples for row in rows) <= 2
    assert rows[0].name.startswith("280.0 to ")
    assert rows[-1].name.endswith(f"{warmth[-1]:.1f} K")
    assert by_temperature(known(size, temperature_K=np.full(len(SUN), 290.0))) == []
    assert by_temperature(known(size)) == []


def test_the_share_of_the_next_errors_below_a_level_is_what_it_says() -> None:
    generator = np.random.default_rng(5)
    below = []
    for _ in range(400):
        drawn = generator.normal(size=(2, 400)) ** 2
        below.append(drawn[1] <= level(drawn[0], 0.9973))
    assert np.mean(below) == pytest.approx(0.9975, abs=0.0005)  # (n + 1) p rounds up
    assert fewest_for(0.95) == 19
    assert fewest_for(0.9973) == 370
    assert np.isnan(level(np.zeros(369), 0.9973))
    assert level(np.zeros(370), 0.9973) == 0.0


def test_the_field_of_a_square_reaches_farther_in_its_corners() -> None:
    """Of a square in tangents the hull of directions is the square itself."""
    x, y = np.tan(np.radians(40.0)) * grid(21, 1.0).T
    square = np.column_stack([x, y, np.ones_like(x)])
    field = field_of(square / np.linalg.norm(square, axis=1)[:, None])
    assert field is not None
    reach = dict(field.reach)
    assert reach[0.0] == field.least_deg == pytest.approx(40.0, abs=0.26)
    corner = np.degrees(np.arctan(np.sqrt(2.0) * np.tan(np.radians(40.0))))
    assert reach[45.0] == field.most_deg == pytest.approx(corner, abs=0.26)
    aside = SUN[SUN[:, 0] > 0.2]
    assert field_of(aside) is None


def test_a_sweep_reaches_to_its_two_ends() -> None:
    off = np.radians(np.linspace(-30.0, 50.0, 17))
    sun = np.column_stack([np.sin(off), np.zeros(17), np.cos(off)])
    field = field_of(sun)
    assert field is not None
    assert (field.least_deg, field.most_deg) == pytest.approx((30.0, 50.0))
    assert field_of(sun[off > 0.1]) is None


def test_the_cone_of_all_poses_is_found_once_a_calibration(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 100,000 poses it takes seconds; verdict, table and picture of the field look at it."""
    found: list[str] = []
    cone = Hull.of_directions

    def counted(sun: np.ndarray, by: str, beyond: float = 0.0) -> Hull:
        found.append(by)
        return cone(sun, by, beyond)

    monkeypatch.setattr(Hull, "of_directions", counted)
    turned = SUN @ turn("z", 20.0)
    assert len(next_poses(turned)[0])
    narrow, wide = field_of(turned, 8), field_of(turned, 72)
    assert found == ["poses"]
    assert narrow is not None
    assert wide is not None
    assert set(narrow.reach) < set(wide.reach)


@pytest.mark.parametrize(
    ("text", "limit", "share", "half"),
    [
        ("0.1deg@3sigma,60deg", 0.1, 0.9973, 60.0),
        (" 6 arcmin @ 95 % , 30 deg", 0.1, 0.95, 30.0),
        ("360arcsec@rms", 0.1, None, None),
        ("1mrad@2sigma", 0.0572958, 0.9545, None),
    ],
)
def test_requirements_are_read(
    text: str, limit: float, share: float | None, half: float | None
) -> None:
    made = requirement(text)
    assert made.limit_deg == pytest.approx(limit)
    assert (made.share, made.half_angle_deg) == (share, half)


@pytest.mark.parametrize(
    "text",
    ["", "0.1", "0.1deg", "0.1deg@4sigma", "0deg@rms", "1deg@100%", "1deg@rms,0deg", "x" * 9],
)
def test_what_is_no_requirement_is_refused(text: str) -> None:
    with pytest.raises(RequirementError, match="expected a"):
        requirement(text)


def test_a_requirement_is_met_not_met_or_not_shown(camera: Calibration) -> None:
    errors = known(np.radians(0.1) * towards(0))
    found = replace(camera, readings=errors.readings)
    words = {
        "0.11deg@95%,39deg": "met",
        "0.09deg@95%,39deg": "not met",
        "0.11deg@rms,55deg": "not shown",  # poses end at 40 deg
        "0.11deg@3sigma": "met",
        "0.11deg@3sigma,10deg": "not shown",  # 30 poses
    }
    made = {text: judged(requirement(text), found.readings.sun, errors) for text in words}
    assert {text: one.word for text, one in made.items()} == words
    assert made["0.11deg@95%,39deg"].margin_deg == pytest.approx(0.01)
    assert made["0.09deg@95%,39deg"].margin_deg == pytest.approx(-0.01)
    assert "do not reach 55 deg" in made["0.11deg@rms,55deg"].sentence
    assert "370 poses" in made["0.11deg@3sigma,10deg"].sentence


def test_names_that_are_markup_or_mathematics_are_shown_as_they_are(camera: Calibration) -> None:
    names = ("$x_{$", "<script>alert(1)</script>", r"\frac{")
    run = np.arange(len(camera.readings)) % 3
    readings = replace(camera.readings, run=run, run_names=names)
    page = report(replace(camera, readings=readings, sources=("<b>.csv",)))
    assert "<script>" not in page
    assert "<b>.csv" not in page
    for name in ("$x_{$", r"\frac{", "&lt;script&gt;"):
        assert name in page


def test_a_factory_calibration_is_compared_on_the_same_rows(
    camera: Calibration, tmp_path: Path
) -> None:
    """A table and a JSON: one is 0.3 deg off by its mount, the other is the calibration itself."""
    angles = grid(21, 50.0)
    turned = angles.copy()
    turned[:, 0] += 0.3  # about x, as a mount may be
    table = write(tmp_path / "factory.csv", HEADER, spots(sun_of(angles), 9), turned)
    found = compared_with(table, camera, [])
    assert found.rms_deg[0] == pytest.approx(0.3, abs=0.1)
    assert found.turned_rms_deg < 0.1
    assert found.rms_deg[1] < 0.05
    save(camera, tmp_path / "own.json")
    own = compared_with(tmp_path / "own.json", camera, [])
    assert own.rms_deg[0] <= own.rms_deg[1] * 1.01
    assert own.unanswered == 0
