"""Rows of sweeps: what is planned, tracked, refused, compared, and drawn where nothing is found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

import numpy as np
import pytest

from algorithms.contract import (
    AboutExtractor,
    FeatureKind,
    Observation,
    SensorGeometry,
)
from benchmark.sweeps import plan
from benchmark.sweeps.differences import differences
from benchmark.sweeps.measure import SweepTask, measure
from benchmark.sweeps.points import Point
from benchmark.synthetic_features.series import SeriesPoint


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
