"""Forged errors and intervals of a saved calibration are refused by name."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import bench
import pytest

from algorithms.calibration.documents import DIGEST, digest_of
from algorithms.calibration.saving import UnreadableCalibrationError
from calibrate.calibration import calibrate
from calibrate.documents import document, load


@pytest.fixture(scope="module")
def held(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Document of a small camera's calibration, with intervals by place."""
    angles = bench.grid(13, 40.0)
    path = tmp_path_factory.mktemp("held") / "a.csv"
    bench.write(path, bench.HEADER, bench.spots(bench.sun_of(angles), 1), angles)
    made: dict[str, Any] = json.loads(
        json.dumps(document(calibrate([path], models=["homography"])))
    )
    assert made["fit"]["intervals"]["factor"] > 0
    return made


def refusal(held: dict[str, Any], path: Path, fit: dict[str, Any]) -> str:
    made = {**held, "fit": {**held["fit"], **fit}}
    path.write_text(json.dumps({**made, DIGEST: digest_of(made)}))
    with pytest.raises(UnreadableCalibrationError) as refused:
        load(path)
    return str(refused.value)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"factor": False}, "fit.intervals.factor must be one finite number above 0"),
        ({"factor": 1e29}, "fit.intervals.factor must be one finite number above 0"),
        ({"sectors": True}, "fit.intervals.sectors must be one finite number above 0"),
        ({"coverage": 1.5}, "expected intervals of a coverage of at most 1"),
        ({"axis": [0.0, "1", 0.0]}, "fit.intervals.axis must be 3 finite numbers"),
    ],
)
def test_an_interval_that_is_no_number_is_named(
    held: dict[str, Any], tmp_path: Path, change: dict[str, Any], said: str
) -> None:
    fit = {"intervals": {**held["fit"]["intervals"], **change}}
    assert said in refusal(held, tmp_path / "a.json", fit)


@pytest.mark.parametrize("name", ["rms_left_out_deg", "rms_fitted_deg", "fit_spread_deg"])
@pytest.mark.parametrize(("value", "said"), [(-1.0, " must be 0 or more"), (False, " must be one")])
def test_an_error_that_is_none_is_named(
    held: dict[str, Any], tmp_path: Path, name: str, value: Any, said: str
) -> None:
    assert f"fit.{name}{said}" in refusal(held, tmp_path / "a.json", {name: value})
