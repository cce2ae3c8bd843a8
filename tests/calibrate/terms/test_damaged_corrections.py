"""Forged or damaged numbers of a saved correction are refused by name, in one sentence."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import bench
import numpy as np
import pytest

from algorithms.calibration.documents import DIGEST, digest_of
from algorithms.calibration.saving import UnreadableCalibrationError
from calibrate.calibration import calibrate
from calibrate.documents import document, load, with_correction
from calibrate.readings import readings_of
from calibrate.recalibration import Correction, Errors
from calibrate.settings import Settings
from calibrate.table import Table

ERRORS = Errors(1.0, 1.0, 1.0, 1.0)
STILL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@pytest.fixture(scope="module")
def held(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Document of a small camera's calibration."""
    angles = bench.grid(5, 40.0)
    path = tmp_path_factory.mktemp("held") / "a.csv"
    bench.write(path, bench.HEADER, bench.spots(bench.sun_of(angles), 1), angles)
    return document(calibrate([path], models=("homography",)))


def forged(held: dict[str, Any], path: Path, change: dict[str, Any]) -> Path:
    made = {**{k: v for k, v in held.items() if k != DIGEST}, **change}
    path.write_text(json.dumps({**made, DIGEST: digest_of(made)}))
    return path


@pytest.mark.parametrize(
    ("correction", "said"),
    [
        ({"offset": [1e29, 0.0]}, "correction.offset must be 2 finite numbers; got"),
        ({"offset": [True, 0.0]}, "correction.offset must be 2 finite numbers; got"),
        ({"offset": [1.0, 2.0, 3.0]}, "correction.offset must be 2 finite numbers; got"),
        ({"gain": [1.0, 0.0]}, "correction.gain must be 2 finite numbers above 0; got"),
        ({"rotation": [[1.0, 0, 0], [0, 1, 0], [0, 0, -1]]}, "correction.rotation must be a rot"),
        ([], "correction must be a table; got"),
    ],
)
def test_numbers_of_a_correction_that_are_none_are_named(
    held: dict[str, Any], tmp_path: Path, correction: Any, said: str
) -> None:
    file = forged(held, tmp_path / "a.json", {"correction": correction})
    with pytest.raises(UnreadableCalibrationError, match=rf"^a\.json: {said}"):
        load(file)


@pytest.mark.parametrize(
    ("fit", "said"),
    [
        ({"interval_factor": True}, "fit.interval_factor must be one finite number"),
        ({"interval_factor": 0.0}, "fit.interval_factor must be one finite number above 0"),
        ({"temperature_K": [300.0]}, "fit.temperature_K must be 2 finite"),
        ({"temperature_K": [300.0, 200.0]}, "fit.temperature_K must rise; got 300, 200"),
        ({"rms_left_out_deg": "small"}, "fit.rms_left_out_deg must be one finite number"),
    ],
)
def test_numbers_of_the_fit_that_are_none_are_named(
    held: dict[str, Any], tmp_path: Path, fit: dict[str, Any], said: str
) -> None:
    file = forged(held, tmp_path / "a.json", {"fit": {**held["fit"], **fit}})
    with pytest.raises(UnreadableCalibrationError, match=rf"^a\.json: {said}"):
        load(file)


@pytest.mark.parametrize("part", ["fit", "settings", "model", "compensations"])
@pytest.mark.parametrize("value", [None, [], {"name": "homography"}])
def test_a_part_that_is_something_else_is_refused(
    held: dict[str, Any], tmp_path: Path, part: str, value: Any
) -> None:
    if part == "compensations" and value == []:
        return  # which has none
    file = forged(held, tmp_path / "a.json", {part: value})
    with pytest.raises(UnreadableCalibrationError, match=r"^a\.json: "):
        load(file)


@pytest.mark.parametrize(
    "change", [{"array": ["1"] * 10, "dtype": "U1"}, {"array": [1.0], "shape": [1]}]
)
def test_parameters_of_another_number_or_kind_are_refused(
    held: dict[str, Any], tmp_path: Path, change: dict[str, Any]
) -> None:
    model = json.loads(json.dumps(held["model"]))
    model["fitted"]["vector_"].update(change)
    with pytest.raises(UnreadableCalibrationError, match=r"^a\.json: homography has 10 parameters"):
        load(forged(held, tmp_path / "a.json", {"model": model}))


@pytest.mark.parametrize("apply", [(), ("rotate-90", "mirror-x")])
def test_flight_settings_do_what_the_correction_does(
    held: dict[str, Any], tmp_path: Path, apply: tuple[str, ...]
) -> None:
    stated = {**held["settings"], "apply": list(apply)}
    stated["readings"] = {**stated["readings"], "dark": [3.0, -2.0], "gain": [1.1, 0.9]}
    file = forged(held, tmp_path / "a.json", {"settings": stated})
    found = Correction(("scale",), (1.02, 0.97), (5.0, -7.0), STILL, ERRORS, ERRORS, (), 9)
    file.write_text(json.dumps(with_correction(load(file), found, [file])))
    loaded = load(file)
    columns = np.random.default_rng(3).uniform(450.0, 560.0, (9, 2))
    angles = np.full((9, 2), 10.0)
    names = (*loaded.settings.readings.columns, *loaded.settings.direction.columns)
    cells = dict(zip(names, np.column_stack([columns, angles]).T, strict=True))
    table = Table(cells, 2, "a", {})

    def features(settings: Settings) -> Any:
        return readings_of(table, settings).features

    plain = (features(loaded.settings) - loaded.offset) / loaded.gain
    assert features(loaded.corrected.settings(loaded.settings)) == pytest.approx(plain)
    before = load(forged(held, tmp_path / "b.json", {"settings": stated})).settings
    turned = features(
        before.model_copy(
            update={
                "readings": before.readings.model_copy(
                    update={
                        "dark": (3.0 + 1.1 * 5.0, -2.0 - 0.9 * 7.0),
                        "gain": (1.1 * 1.02, 0.9 * 0.97),
                    }
                )
            }
        )
    )
    assert plain == pytest.approx(turned)
