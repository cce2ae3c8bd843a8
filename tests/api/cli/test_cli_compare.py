"""`sunatlas compare`: architectures side by side, and masks at equal height."""

import json

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from benchmark.datasets import get
from benchmark.equal_height.designs import DESIGNS, DETECTOR


def sunatlas(*arguments):
    return CliRunner().invoke(app, ["compare", *map(str, arguments)])


def test_architectures_have_their_height_and_their_error_at_1_mm():
    named = ("--architecture", "CCD:Lens", "--architecture", "PD:Maskless")
    shown = sunatlas(*named, "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    lens, bare = json.loads(shown.stdout)["items"]
    assert lens["height_mm"] == get("ccd-lens").geometry.focal_length_mm == 3.0
    assert lens["own_at_1_mm_deg"] == pytest.approx(3.0 * lens["own_error_deg"])
    assert bare["height_mm"] is None
    assert bare["own_at_1_mm_deg"] is None


def test_every_mask_at_equal_height_is_shown_by_its_error_in_flight():
    shown = sunatlas("--equal", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    document = json.loads(shown.stdout)
    rows = document["items"]
    assert {row["design"] for row in rows} == set(DESIGNS)
    assert {(row["height_mm"], row["half_fov_deg"], row["units"]) for row in rows} == {(0.5, 60, 9)}
    errors = [row["flight_error_deg"] for row in rows]
    assert errors == sorted(errors)
    for row in rows:
        assert row["bound_deg"] < row["own_error_deg"] < row["flight_error_deg"]
        assert DESIGNS[row["design"]].mask == row["mask"]
    array = f"{DETECTOR.columns} x {DETECTOR.rows} pixels of {1e3 * DETECTOR.pitch_mm:g} um"
    assert array in document["detector"]
    said = " ".join(sunatlas("--equal").stdout.split())
    assert "height 0.5 mm, field 120 deg, 9 units" in said
    (partly,) = (row["design"] for row in rows if row["flight_low_deg"] is None)
    assert f"{partly}: in flight without its units below 95 % availability" in said
