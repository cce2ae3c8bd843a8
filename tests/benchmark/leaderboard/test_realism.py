"""Data sets beside built sensors: the pairing, the ratios, and what wants a sentence."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmark import datasets
from benchmark.datasets.realism import (
    HardwareMatch,
    hardware_matches,
)
from benchmark.leaderboard.realism import FACTOR, nearest_ratio, realism
from benchmark.metrics.rings import RINGS
from benchmark.results.store import PUBLISHED, Store
from survey_data.hardware import hardware

NOMINAL = {"fake": "nominal"}


def row(**more: Any) -> dict[str, Any]:
    given = {
        "dataset": "fake", "condition": "nominal", "unit": 0, "extractor": "e", "model": "m",
        "rms_deg": 0.1, "bound_deg": 0.01, "repeatability_deg": 0.02, "half_fov_deg": 60.0,
        "availability": 1.0,
    }  # fmt: skip
    given |= {"rms_all_answers_deg": more.get("rms_deg", 0.1)}
    return {**given, **{ring.column: 0.05 for ring in RINGS}, **more}


def fake(*ids: str, sentence: str = "") -> dict[str, HardwareMatch]:
    sensors = tuple(hardware()[name] for name in ids)
    return {"fake": HardwareMatch("fake", sensors, "" if ids else "none", sentence)}


def test_every_dataset_has_a_row_and_every_row_a_dataset() -> None:
    assert set(hardware_matches()) == {*datasets.names(), *datasets.study_names()}


def test_no_published_difference_is_unexplained() -> None:
    """Of the record as it is; a renewed one may ask for other sentences: they are named."""
    nominal = {name: datasets.get(name).conditions[0] for name in datasets.names()}
    table = realism(Store(PUBLISHED).rows(), nominal)
    assert [row["dataset"] for row in table if row["unexplained"]] == []


def test_a_sensor_stands_beside_data_of_its_own_kind() -> None:
    """Mask as the table has it; detectors differ where no nearer sensor is known."""
    masks = {
        (datasets.get(name).mask, sensor.mask)
        for name, one in hardware_matches().items()
        for sensor in one.sensors
        if sensor.mask
    }
    different = {pair for pair in masks if pair[0] != pair[1]}
    # a vernier is encoded or of several slits; several apertures beside one another are heads
    assert different <= {("Encoded", "Multi-Slit"), ("Single-Ap.", "Multi-Ap.")}


def test_the_best_answering_pipeline_of_the_standard_unit_is_compared() -> None:
    rows = [
        row(rms_deg=0.2, model="slow"),
        row(rms_deg=0.1, model="best"),
        row(rms_deg=0.01, model="silent", availability=0.5),
        row(rms_deg=0.01, model="other unit", unit=1),
        row(rms_deg=0.01, model="other condition", condition="low-noise"),
        row(rms_deg=None, model="failed"),
    ]
    (found,) = realism(rows, NOMINAL, fake("C12"))
    assert found["model"] == "best"
    # 0.2 deg, three sigma
    assert found["sensors"][0]["accuracy_ratio"] == pytest.approx(0.1 / (0.2 / 3))
    assert found["accuracy_ratio"] == found["sensors"][0]["accuracy_ratio"]
    assert found["precision_ratio"] == pytest.approx(0.02 / 0.05)


def test_a_narrower_sensor_is_compared_over_its_field() -> None:
    """C44 sees +-25 deg: the rings to 20 deg count."""
    (found,) = realism([row()], NOMINAL, fake("C44"))
    assert found["sensors"][0]["our_rms_deg"] == pytest.approx(0.05)
    (found,) = realism([row()], NOMINAL, fake("C03"))
    assert found["sensors"][0]["our_rms_deg"] == 0.1


def test_a_difference_wants_a_sentence() -> None:
    beyond = [row(rms_deg=0.5 * FACTOR * 1.01)]  # 0.5 deg is claimed
    for sentence, wanted in (("", True), ("Because.", False)):
        table = realism(beyond, NOMINAL, fake("C03", sentence=sentence))
        assert table[0]["unexplained"] is wanted
    within = [row(rms_deg=0.9, repeatability_deg=0.1)]
    assert not realism(within, NOMINAL, fake("C03"))[0]["unexplained"]
    (ideal,) = realism(beyond, NOMINAL, fake())
    assert (ideal["accuracy_ratio"], ideal["unexplained"], ideal["idealisation"]) == (
        None,
        False,
        "none",
    )
    (unscored,) = realism([], NOMINAL, fake("C03"))
    assert unscored["rms_deg"] is None
    assert not unscored["unexplained"]


@given(st.lists(st.floats(1e-3, 1e3), min_size=1))
def test_the_nearest_ratio_is_that_of_the_range(ratios: list[float]) -> None:
    found = nearest_ratio(ratios)
    if min(ratios) <= 1 <= max(ratios):
        assert found == 1.0
    else:
        assert found in ratios
        assert all(max(found, 1 / found) <= max(one, 1 / one) * (1 + 1e-12) for one in ratios)
    assert nearest_ratio([None, *ratios]) == found
    assert nearest_ratio([None]) is None
