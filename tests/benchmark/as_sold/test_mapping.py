"""How built sensors are mapped: rows that are simulated, settings that rows state, and why not."""

import csv
from pathlib import Path

import pytest

import survey_data
from benchmark import datasets
from benchmark.as_sold.mapping import as_sold, left_out, readings

TABLE = Path(survey_data.__file__).parent / "hardware.csv"


@pytest.fixture(scope="module")
def rows():
    with TABLE.open(encoding="utf-8", newline="") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def test_every_row_is_simulated_or_says_why_not(rows):
    assert as_sold().keys() | left_out().keys() == rows.keys()
    assert not as_sold().keys() & left_out().keys()
    for name in as_sold():
        assert rows[name]["accuracy_deg"]
        assert rows[name]["detector"]
        assert rows[name]["mask"]


def test_data_sets_have_the_detector_and_mask_of_the_sensor_or_stand_for_it(rows):
    elsewhere = set()
    for name, one in as_sold().items():
        preset = datasets.get(one.dataset)
        assert not preset.context_columns  # in no orbit
        if (preset.detector, preset.mask) != (rows[name]["detector"], rows[name]["mask"]):
            elsewhere.add(name)
    # Adcole's encoders are read by photodiodes here; the CCD of the SS-411 is that of its heir
    assert elsewhere == {"C07", "C50", "C51"}


def test_settings_are_those_that_rows_state():
    known = as_sold()
    assert (known["C12"].depth, known["C13"].depth) == ("table", "uncalibrated")
    assert known["C12"].dataset == known["C13"].dataset  # one unit, with and without its table
    assert (known["C08"].depth, known["C08"].depth_basis) == ("constants", "stated")
    assert (known["C47"].depth, known["C47"].depth_basis) == ("table", "family")  # by C02
    assert (known["C53"].depth, known["C53"].depth_basis) == ("uncalibrated", "assumed")
    assert (known["C55"].depth, known["C55"].depth_basis) == ("constants", "assumed")
    assert (known["P15"].depth, known["P15"].depth_basis) == ("table", "assumed")
    assert {name for name, one in known.items() if one.level == "flight"} == {"C15", "C18"}
    assert known["P24"].half_fov_deg == 5.0  # a field of 10 deg, narrower than the data set's
    assert known["C10"].statistic == "mean"


def test_what_is_stated_below_the_standard_bench_takes_the_fine_one():
    for one in as_sold().values():
        divisor = {"3sigma": 3.0, "max": 3.0, "p95": 1.96, "mean": 0.7979}.get(one.statistic, 1.0)
        assert (one.bench == "fine") == (one.sensor.accuracy_deg / divisor < 0.016)


def test_readings_say_where_in_the_row_they_are_from(rows):
    for name, one in readings().items():
        assert one.because.partition(":")[0] in {"calibration", "notes"}
        assert rows[name]["calibration"] or rows[name]["notes"]
