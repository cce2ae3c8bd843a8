"""The series `frames`: sets of faults, and what share of the answers to them is wrong."""

import dataclasses

import numpy as np
import pytest

from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Observation
from benchmark.sweeps.measure import SweepTask, measure
from benchmark.sweeps.plan import SERIES, plan_points
from benchmark.sweeps.points import Point
from benchmark.synthetic_features.series import WRONG_PX

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
