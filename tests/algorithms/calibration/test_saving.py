"""Calibrations as files: whole or not at all, the same answers, refusals that name what came."""

from __future__ import annotations

import errno
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from algorithms.calibration.documents import digest_of
from algorithms.calibration.saving import (
    SCHEMA,
    UnreadableCalibrationError,
    document,
    load,
    pipeline_of,
    save,
)
from algorithms.compensations.optics.refraction import Refraction
from algorithms.contract import FeatureKind, NotFittedError
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.non_physical.polynomial import SurfacePolynomial
from algorithms.pipeline import Pipeline


@pytest.fixture
def calibrated(geometry, field):
    spots = 200.0 + 180.0 * field[:, :2] / field[:, 2:]
    glass = Refraction(2.0, 0.01, (200.0, 200.0), ((0.1, 1.5),))
    pipeline = Pipeline(BasicCentroid(), SurfacePolynomial(extrapolation=math.inf), (glass,))
    return pipeline.fit_features(spots, field), spots


def test_a_file_answers_as_what_was_saved(calibrated, geometry, tmp_path):
    pipeline, spots = calibrated
    path = tmp_path / "calibration.json"
    save(pipeline, path, geometry)
    again = load(path)
    assert again.name == "optical + polynomial-2d"
    np.testing.assert_array_equal(
        again.predict_features(spots * 1.5), pipeline.predict_features(spots * 1.5)
    )
    assert again.model.quality_ == pipeline.model.quality_
    assert again.model.extrapolation == math.inf
    stored = json.loads(path.read_text())
    assert stored["sensor"]["focal_length_mm"] == geometry.focal_length_mm
    assert {"sun", "angles", "pixels", "units"} <= set(stored["conventions"])
    save(again, path, geometry)
    assert json.loads(path.read_text()) == stored


def test_nothing_half_written_is_left(calibrated, tmp_path, monkeypatch):
    pipeline, _ = calibrated
    path = tmp_path / "calibration.json"
    path.write_text("what was there")
    unfitted = Pipeline(BasicCentroid(), SurfacePolynomial())
    with pytest.raises(NotFittedError, match="polynomial-2d"):
        save(unfitted, path)
    with pytest.raises(OSError, match="no-such"):
        save(pipeline, tmp_path / "no-such" / "calibration.json")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="No space left on device") as caught:
        save(pipeline, path)
    assert caught.value.filename == str(path)
    assert path.read_text() == "what was there"
    assert [entry.name for entry in tmp_path.iterdir()] == ["calibration.json"]


def test_what_a_killed_process_left_goes_and_what_a_living_one_writes_stays(calibrated, tmp_path):
    pipeline, _ = calibrated
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    for process in (dead.pid, os.getpid()):
        (tmp_path / f".calibration.json.{process}-1f.saving").write_text("half")
    save(pipeline, tmp_path / "calibration.json")
    left = f".calibration.json.{os.getpid()}-1f.saving"
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [left, "calibration.json"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda stored: stored.update(schema="other"), "expected a document of"),
        (lambda stored: stored.update(schema_version=99), "expected schema version 2; got 99"),
        (lambda stored: stored.update(schema_version=1), "got 1: calibrate and save anew"),
        (lambda stored: stored.update(note="mine"), "the member 'note' is unknown"),
        (lambda stored: stored["model"].update(name="nobody"), "no stage is named 'nobody'"),
        (lambda stored: stored["model"].update(version=99), "of version 99 of polynomial-2d"),
        (lambda stored: stored["model"]["fitted"].pop("hull_"), "is fitted with"),
        (lambda stored: stored["model"]["parameters"].update(nothing=1), "damaged"),
        (lambda stored: stored["model"]["parameters"].update(degree=99), "damaged: .*degree"),
        (lambda stored: stored.pop("extractor"), "damaged"),
        (
            lambda stored: stored["model"]["fitted"]["hull_"].update(object="algorithms.none:x"),
            "damaged: No module",
        ),
        (
            lambda stored: stored["model"]["parameters"].update(
                degree={"array": [1], "shape": [1], "dtype": "O"}
            ),
            "damaged: an array of 'O'",
        ),
        (
            lambda stored: stored["model"]["fitted"]["hull_"].update(object="os:system"),
            "holds no os:system",
        ),
        (
            lambda stored: stored["model"]["fitted"]["hull_"].update(
                object="algorithms.pipeline:extract_features"
            ),
            "holds no algorithms.pipeline:extract_features",
        ),
    ],
)
def test_a_document_that_is_none_is_named(calibrated, change, said):
    stored = json.loads(json.dumps(document(calibrated[0])))
    change(stored)
    stored["digest"] = digest_of(stored)  # whoever forges a file can do so
    with pytest.raises(UnreadableCalibrationError, match=said):
        pipeline_of(stored)


def test_a_number_with_another_digit_is_refused_by_the_digest(calibrated, tmp_path):
    path = tmp_path / "calibration.json"
    save(calibrated[0], path)
    sound = path.read_text()
    stored = json.loads(sound)
    del stored["digest"]
    path.write_text(json.dumps(stored))
    with pytest.raises(
        UnreadableCalibrationError, match=r"calibration.json: .*'digest' is missing"
    ):
        load(path)
    at = next(at for at in range(len(sound) // 2, len(sound)) if sound[at] in "12345678")
    path.write_text(sound[:at] + str(int(sound[at]) + 1) + sound[at + 1 :])
    with pytest.raises(UnreadableCalibrationError, match=r"calibration.json: .*digest of what"):
        load(path)
    path.write_text(json.dumps(json.loads(sound), sort_keys=True))  # the layout is no matter
    assert load(path).name == calibrated[0].name


@pytest.mark.parametrize(
    "text",
    ["[" * 200_000, '{"a": 1, "a": 2}', '{"a": NaN}', '{"a": 1e999}', '{"a": ' + "9" * 5000 + "}"],
)
def test_json_that_no_program_should_trip_over_is_refused(tmp_path, text):
    path = tmp_path / "calibration.json"
    path.write_text(text)
    with pytest.raises(UnreadableCalibrationError, match=r"calibration.json: not JSON"):
        load(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="named pipes")
def test_what_is_no_file_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.json")
    with pytest.raises(UnreadableCalibrationError, match=r"pipe.json: expected a file"):
        load(tmp_path / "pipe.json")


@pytest.mark.parametrize("text", ["", "[1, 2]", "{", '{"schema": 3}', "null"])
def test_a_file_that_is_none_is_named(tmp_path, text):
    path = tmp_path / "calibration.json"
    path.write_text(text)
    with pytest.raises(UnreadableCalibrationError, match=r"JSON|expected a document"):
        load(path)
    assert SCHEMA.endswith("calibration")


def test_a_fitted_vector_is_kept_to_the_last_bit(geometry, calibration_for):
    known = calibration_for(FeatureKind.SPOT)
    model = LeastSquaresGeometry.for_sensor(geometry, FeatureKind.SPOT)
    pipeline = Pipeline(BasicCentroid(), model).fit_features(known.features, known.sun)
    again = pipeline_of(json.loads(json.dumps(document(pipeline))))
    assert again.model.vector_.tobytes() == pipeline.model.vector_.tobytes()
