"""The verdict on lasers, on rows that were made up."""

from __future__ import annotations

from typing import Any

import pytest

from benchmark.directions.outcomes import outcomes
from benchmark.directions.trials import laser
from benchmark.experiments.spoofing import SENSORS
from benchmark.spoofing.record import RECORD


def row(noticed: int, turned: int = 400, alarms: int = 0, **more: Any) -> dict[str, Any]:
    level = {
        "sun": True,
        "suns": 1.0,
        "readings": 500,
        "answered": 450,
        "flagged": 0,
        "deceived": 350,
        "pull_deg": 20.0,
        "turned": turned,
        "noticed": {"pattern": noticed, "brightness": 390, "either": 400, "agreement": 300},
        "curve": [400, 400, noticed, noticed],
    }
    made = {
        "dataset": "any",
        "extractor": "bcm",
        "model": "lut",
        "has_pattern": True,
        "own_error_deg": 0.01,
        "setting": 1000,
        "checking": 100_000,
        "answered": 100_000,
        "flagged": 0,
        "alarms": {"pattern": alarms, "brightness": 0},
        "knowable": None,
        "levels": [{**level, "suns": 0.1}, {**level, "sun": False}, level],
        "rises": [],
    }
    return {**made, **more}


@pytest.mark.parametrize(
    ("rows", "verdict"),
    [
        ([], "not tried"),
        ([row(396), row(400)], "pays"),
        ([row(395), row(400)], "depends on the data set"),
        ([row(395), row(390)], "does not pay"),
        # bare faces have no pattern: they are shown, and decide nothing
        ([row(400), row(100, has_pattern=False)], "pays"),
        # 10 alarms of 100,000 are expected; 16 or more come by chance 4.9 times in 100
        ([row(400, alarms=15)], "pays"),
        ([row(400, alarms=17)], "does not pay"),
    ],
)
def test_the_rule_asks_for_99_percent_of_every_sensor_with_a_pattern(rows, verdict) -> None:
    assert laser(rows).verdict == verdict


def test_shares_are_of_readings_turned_away_with_the_interval_of_clopper_and_pearson() -> None:
    (one,) = laser([row(400)]).sensors
    assert (one["noticed"], one["noticed_high"]) == (1.0, 1.0)
    # none missed of n: (1 - share)^n is 2.5 %
    assert one["noticed_low"] == pytest.approx(0.025 ** (1.0 / 400), abs=1e-5)
    assert (one["deceived"], one["agreement"]) == (0.7, 0.75)
    (other,) = laser([row(0)]).sensors
    assert (other["noticed_low"], other["noticed"]) == (0.0, 0.0)
    assert other["noticed_high"] == pytest.approx(1.0 - 0.025 ** (1.0 / 400), abs=1e-5)


def test_the_worst_sensor_is_named_with_what_physics_allows_there() -> None:
    found = laser([row(400), row(380, dataset="qpd-single-aperture", knowable=0.96)])
    assert found.value == pytest.approx(0.95)
    assert "qpd-single-aperture, 95.0 %" in found.text
    assert "would notice 96.0 %" in found.text
    assert "does not count: any" in laser([row(400, alarms=20)]).text


def test_every_sensor_is_in_the_record_or_named_as_missing() -> None:
    rows = list(RECORD.read().values())
    missing = set(SENSORS) - {one["dataset"] for one in rows}
    (one,) = (one for one in outcomes([], {"spoofing": rows}) if one["id"] == "D12")
    assert one["verdict"] in {"pays", "does not pay", "depends on the data set"}
    assert len(one["sensors"]) == len(rows)
    assert all(name in one["text"] for name in missing)
