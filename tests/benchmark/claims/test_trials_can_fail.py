"""Trials of claims that once could not fail: made-up data under which each rule fails."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import pytest

from algorithms.contract import AboutModel, FeatureKind, SensorGeometry
from benchmark.claims.experiments.coarse import c18_interference as c18
from benchmark.claims.experiments.coarse import c24_filter_in_orbit as c24
from benchmark.claims.experiments.coarse import c25_drifting_assembly as c25
from benchmark.claims.experiments.fits import c05_overfitting as c05
from benchmark.claims.experiments.fits import c07_periodic_error as c07
from benchmark.claims.experiments.fits.poses import Poses
from benchmark.claims.experiments.geometry import c09_main_error as c09
from benchmark.claims.judgement import judge, verdict
from benchmark.claims.rules import claims
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.standard import pd_maskless_cube, pd_maskless_pyramid, pd_orbit


def outcome_of(claim, trials):
    """How each rule of a claim stands after these trials, and the verdict."""
    rules = [judge(rule, [t[rule.name] for t in trials]) for rule in claims()[claim].rules]
    return {one.rule.name: one.result for one in rules}, verdict(rules)


def poses(bend, noise, count, seed):
    """Balances that go with the angle as a polynomial of this degree, read with noise."""
    rng = np.random.default_rng(seed)
    balances = rng.uniform(-0.9, 0.9, (count, 2))
    angles = np.radians(30.0) * (balances + 0.3 * balances**bend)
    tangents = np.tan(angles)
    sun = np.column_stack([tangents[:, 0], tangents[:, 1], np.ones(count)])
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    return Poses(balances + noise * rng.standard_normal(balances.shape), sun)


def test_orders_do_not_overfit_a_response_that_needs_them():
    """C05: with many poses order 15 is as good as any, where the response is of order 15."""
    asked = poses(15, 1e-4, 300, 99)
    made = []
    for seed in range(8):
        worse = c05.worse(poses(15, 1e-4, 3000, seed), asked)
        made.append({"practice": worse, "few": worse})
    assert outcome_of("C05", made) == ({"practice": "fails", "few": "fails"}, "refuted")


def test_orders_overfit_a_line_read_with_noise():
    asked = poses(1, 0.0, 300, 99)
    made = [{"practice": c05.worse(poses(1, 0.01, 40, s), asked)} for s in range(8)]
    found = outcome_of("C05", [{**one, "few": one["practice"]} for one in made])
    assert found == ({"practice": "holds", "few": "holds"}, "reproduced")


def test_a_series_that_takes_up_little_of_a_wave_refutes():
    """C07: half of the wave's error is a quarter of its square left; two thirds are not enough."""
    assert c07.capture(waved=0.1, plain=0.1, unknowing=0.5) == 1.0
    assert c07.capture(waved=0.5, plain=0.1, unknowing=0.5) == 0.0
    assert c07.capture(waved=0.6, plain=0.1, unknowing=0.5) < 0.0
    half = c07.capture(waved=math.hypot(0.1, 0.2), plain=0.1, unknowing=math.hypot(0.1, 0.4))
    assert half == pytest.approx(0.75)
    made = [{"captures": c07.capture(0.3, 0.1, 0.4 + 0.001 * n), "better": 0.9, "costs": 0.8}
            for n in range(8)]  # fmt: skip
    assert outcome_of("C07", made)[1] == "refuted"
    made = [{"captures": 0.95, "better": 1.1, "costs": 1.3}] * 8
    assert outcome_of("C07", made)[1] == "reproduced"


def test_a_wrong_focal_length_or_a_bent_spot_refutes_the_main_error():
    def parts(**changed):
        like = {"misalignment": 0.3, "focal_length": 0.05, "neither": 0.003, "table": 0.003,
                "dark": 0.003, "expansion": 0.003}  # fmt: skip
        return c09.statistics(c09._Parts(**like | changed))

    good, long, bent = parts(), parts(focal_length=0.6), parts(neither=0.25, table=0.003)
    assert outcome_of("C09", [good] * 8)[1] == "reproduced"
    assert long["main"] == pytest.approx(0.5, rel=1e-3)
    assert bent["main"] == pytest.approx(math.sqrt(0.3**2 - 0.25**2) / 0.25)
    made = [parts(focal_length=0.6, table=0.001, dark=0.01, expansion=0.05)] * 8
    assert outcome_of("C09", made) == (dict.fromkeys(made[0], "fails"), "refuted")


def test_a_filter_that_its_gyroscope_misleads_is_refuted():
    """C24: its memory makes answers worse, and it is more hurt by noise than without."""
    made = [c24.values(c24._Pair(0.6 + 0.01 * n, 0.5), c24._Pair(4.0, 3.0)) for n in range(8)]
    assert outcome_of("C24", made) == ({"filter": "fails", "noise": "fails"}, "refuted")
    made = [c24.values(c24._Pair(0.2, 0.5 + 0.01 * n), c24._Pair(1.0, 3.0)) for n in range(8)]
    assert outcome_of("C24", made)[1] == "reproduced"


def test_an_earth_that_costs_little_or_far_more_refutes():
    assert outcome_of("C26", [{"mean": 5.0 + 0.1 * n, "bright": 12.0} for n in range(6)])[0] == {
        "mean": "fails", "bright": "holds"}  # fmt: skip
    assert outcome_of("C26", [{"mean": 30.0 + n, "bright": 60.0 + n} for n in range(6)])[1] == (
        "refuted"
    )


@pytest.mark.parametrize("preset", [pd_maskless_cube.PRESET, pd_orbit.PRESET])
def test_true_directions_come_with_the_same_readings(preset):
    reported, truly = (
        one.generate("nominal", "calibration", 40) for one in (preset, with_true_directions(preset))
    )
    np.testing.assert_array_equal(truly.observations, reported.observations)
    assert np.abs(reported.sun - reported.true_sun).max() > 1e-5
    np.testing.assert_allclose(truly.sun, reported.true_sun, atol=1e-15)


def test_an_assembly_that_is_better_left_alone_refutes():
    """C25: tracking makes a sensor worse that hardly drifts, and takes up none of the drift."""
    still = c25._Pair(kept=0.10, tracked=0.20, kept_last=0.10, tracked_last=0.20)
    moving = c25._Pair(kept=0.15, tracked=0.25, kept_last=0.15, tracked_last=0.25)
    made = [c25.values(moving, still)] * 8
    assert outcome_of("C25", made) == ({"corrects": "fails", "drift": "fails"}, "refuted")
    tracked = c25._Pair(kept=0.50, tracked=0.20, kept_last=0.50, tracked_last=0.20)
    assert outcome_of("C25", [c25.values(tracked, still)] * 8)[1] == "reproduced"


@pytest.mark.parametrize(
    ("claim", "lost", "kept"),
    [
        ("C02", {"refines": 1.002}, {"refines": 1.05}),
        ("C15", {"corrects": 1.4}, {"corrects": 2.5}),
    ],
)
def test_an_effect_that_nobody_would_notice_does_not_count(claim, lost, kept):
    for one, said in ((lost, "refuted"), (kept, "reproduced")):
        spread = [{name: value * (1 + 1e-4 * n) for name, value in one.items()} for n in range(6)]
        assert outcome_of(claim, spread)[1] == said


@dataclass
class Silenced:
    """Answers straight ahead, and nothing once signals add up to more than ever in calibration."""

    about: ClassVar = AboutModel(
        name="fake-silenced", taxonomy="LSQ", accepts=frozenset({FeatureKind.SIGNALS})
    )
    most_: float = field(default=math.inf, init=False)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Silenced:
        return cls()

    def fit(self, features: Any, sun: Any, context: Any = None) -> Silenced:
        self.most_ = 1.05 * float(np.sum(features, axis=1).max())
        return self

    def predict(self, features: Any, context: Any = None) -> Any:
        silent = np.sum(features, axis=1).max() > self.most_
        return np.full((len(features), 3), np.nan) if silent else np.eye(3)[[2] * len(features)]


def test_a_method_that_interference_silences_has_no_ratio_of_errors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    preset = dataclasses.replace(pd_maskless_pyramid.PRESET, directions=ConeField(55.0, 40, 40))
    monkeypatch.setattr(pd_maskless_pyramid, "PRESET", preset)
    monkeypatch.setattr(c18, "METHODS", dict.fromkeys(c18.METHODS, Silenced))
    found = c18.trial(1000)
    assert math.isnan(found.values["constant"])
    _, errors = found.lines["pyramidal, constant"]
    assert np.isfinite(errors).tolist() == [share < c18.JUDGED for share in c18.SHARES]
    assert errors[0] == errors[1] == 0.0  # an answer that never moves
