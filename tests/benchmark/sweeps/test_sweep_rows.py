"""Rows of sweeps: what is planned, tracked, refused, compared, and drawn where nothing is found."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

import numpy as np
import pytest

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Observation,
    SensorGeometry,
)
from benchmark.sweeps import plan
from benchmark.sweeps.differences import differences
from benchmark.sweeps.measure import SweepTask, measure
from benchmark.sweeps.plan import SERIES, plan_points
from benchmark.sweeps.points import Point
from benchmark.synthetic_features.series import WRONG_PX, SeriesPoint


@dataclass(frozen=True)
class Lines:
    """The brightest pixel of either array; followed, the brightest near the one before."""

    about: ClassVar[AboutExtractor] = AboutExtractor(
        name="fake-lines",
        taxonomy="BCM",
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )
    features: ClassVar[tuple[str, ...]] = ("x_px", "y_px")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Any:
        return cls()

    def extract(self, observations: Any) -> Any:
        both = np.asarray(observations, dtype=float).reshape(len(observations), 2, -1)
        return both.argmax(axis=2).astype(float)

    def track(self, observations: Any) -> Any:
        both = np.array(observations, dtype=float).reshape(len(observations), 2, -1)
        both[:, :, 100:] = 0.0  # where the glint stands
        return self.extract(both)


class Unbuildable(Lines):
    about = replace(Lines.about, name="fake-unbuildable")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Any:
        raise RuntimeError("no such sensor")


def setting_of(sweep: str, point: str) -> SeriesPoint:
    settings = plan.SERIES["slit"].settings()
    (found,) = [one for one in settings if (one.sweep, one.point) == (sweep, point)]
    return replace(found, frames=12)


def measured(extractor: type[Lines], sweep: str, point: str) -> dict[str, Any]:
    place = Point("slit", sweep, point, extractor.about.name)
    extractors = {place: cast("Any", extractor)}
    ((at, row),) = measure(SweepTask(extractors, setting_of(sweep, point), {}))
    assert at == place
    return dict(row)


def test_a_method_that_remembers_follows_a_feature_past_a_glint() -> None:
    class Forgetful(Lines):
        about = replace(Lines.about, name="fake-forgetful")
        track: Any = None

    class Simple(Lines):
        about = replace(Lines.about, name="fake-simple")

        def track(self, observations: Any) -> Any:
            return self.extract(observations)

    followed, lost = measured(Lines, "tracking", "glint"), measured(Simple, "tracking", "glint")
    # the brightest pixel of a flat bar 16 px wide may lie 8 px off: what counts is the glint
    assert followed["rms"] < 9.0
    assert lost["rms"] > 20.0
    assert measured(Forgetful, "location", "middle")["status"] == "ok"
    assert measured(Forgetful, "tracking", "glint")["status"] == "failed"


def test_a_method_that_breaks_on_a_design_is_planned_and_its_row_says_so() -> None:
    planned = plan.plan_points({"fake-unbuildable": cast("Any", Unbuildable)})
    assert not planned.refused
    assert {point.series for point in planned.settings} == {"slit", "slits"}
    row = measured(Unbuildable, "noise", "50")
    assert (row["status"], row["reason"]) == ("failed", "RuntimeError: no such sensor")


ROW: dict[str, Any] = {
    "series": "slit",
    "sweep": "noise",
    "point": "50",
    "extractor": "fake-lines",
    "extractor_taxonomy": "BCM",
    "status": "ok",
    "value": 50.0,
    "n": 100,
    "unit": "px",
    "found_fraction": 0.5,
    "kept_fraction": 0.5,
    "wrong_fraction": 0.0,
    "rms": 0.1,
    "bias": 1e-5,
    "bound": 0.05,
    "over_bound": 2.0,
    "reason": "",
}


@pytest.mark.parametrize(
    ("column", "near", "far"),
    [
        ("found_fraction", 0.51, 0.52),  # one sample of 100 at the edge, and two
        ("bias", 1.9e-5, 2.1e-5),  # a ten thousandth of the root mean square
        ("rms", 0.100009, 0.10002),
    ],
)
def test_numbers_differ_beyond_what_each_is_known_to(column: str, near: float, far: float) -> None:
    assert list(differences([ROW], [{**ROW, column: near}])) == []
    (found,) = differences([ROW], [{**ROW, column: far}])
    assert found == (f"slit/noise/50/fake-lines/{column}", str(ROW[column]), str(far))


FRAMES = SERIES["frames"]
SETTINGS = {setting.point: setting for setting in FRAMES.settings()}


def answering(answers):
    """Return an extractor that gives these answers (N, 2), whatever it sees."""

    @dataclasses.dataclass(frozen=True)
    class Told(Extractor):
        about = AboutExtractor(
            name="fake", taxonomy="None", observation=Observation.FRAMES, kind=FeatureKind.SPOT
        )

        def extract(self, observations):
            return np.array(answers[: len(observations)])

    return Told


def row_of(point, answers, frames=40):
    """Measure given answers to the first frames of a set."""
    setting = dataclasses.replace(SETTINGS[point], frames=frames)
    place = Point("frames", setting.sweep, point, "fake")
    ((_, row),) = measure(SweepTask({place: answering(answers)}, setting, {}))
    assert row["status"] == "ok", row["reason"]
    return row


def test_every_single_spot_extractor_of_frames_is_measured_on_every_set():
    from algorithms.discovery import discover_extractors

    plan = plan_points(discover_extractors())
    seen = {}
    for point in plan.settings:
        if point.series == "frames":
            seen.setdefault(point.extractor, set()).add(point.point)
    assert {"bcm", "bctm", "hough-circle", "tm", "mirror", "gaussian-fit"} <= seen.keys()
    refused = {(p.extractor, p.point) for p in plan.refused if p.series == "frames" and p.point}
    for extractor, points in seen.items():
        assert points | {point for name, point in refused if name == extractor} == set(SETTINGS)
    assert len(refused) < 3, "designs that a method of spots does not read"


def test_answers_further_off_than_a_pixel_are_wrong_and_silence_is_not():
    truth = FRAMES.draw(dataclasses.replace(SETTINGS["two apart"], frames=40)).truth
    answers = truth.copy()
    answers[:5] += [0.0, 0.99 * WRONG_PX]
    answers[5:12] += [0.8 * WRONG_PX, 0.8 * WRONG_PX]  # further along the diagonal
    answers[12:20] = np.nan
    row = row_of("two apart", answers)
    assert row["wrong_fraction"] == pytest.approx(7 / 40)
    assert row["found_fraction"] == pytest.approx(32 / 40)


@pytest.mark.parametrize("point", ["no Sun", "no Sun, 1 hot"])
def test_without_a_sun_every_answer_is_wrong_and_there_is_no_error(point):
    answers = np.full((40, 2), np.nan)
    answers[:13] = 31.5
    row = row_of(point, answers)
    assert row["wrong_fraction"] == pytest.approx(13 / 40)
    assert (row["rms"], row["bound"], row["over_bound"]) == (None, None, None)
    assert row_of(point, np.full((40, 2), np.nan))["wrong_fraction"] == 0.0


def test_error_over_bound_is_that_of_answers_with_a_truth():
    drawn = FRAMES.draw(dataclasses.replace(SETTINGS["disc"], frames=40))
    row = row_of("disc", drawn.truth + 0.01)
    assert row["rms"] == pytest.approx(0.01, rel=1e-6)
    assert row["over_bound"] == pytest.approx(0.01 / drawn.bound, rel=1e-4)
    assert row["wrong_fraction"] == 0.0
