"""A calibration and its JSON document state the same uncertainty, turned as a correction turns."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import bench
import numpy as np
import pytest

from algorithms.calibration.documents import DIGEST, digest_of
from algorithms.calibration.saving import UnreadableCalibrationError
from calibrate.calibration import Calibration
from calibrate.documents import document, load, save, with_correction
from calibrate.places import tangent_axes
from calibrate.recalibration import Correction, Errors

FEATURES = bench.spots(bench.sun_of(np.random.default_rng(5).uniform(-40.0, 40.0, (60, 2))), 6)
OUTSIDE = np.array([[-4000.0, 0.0]])


def changed(found: Calibration, path: Path, **fit: Any) -> Path:
    """A document of it with other members under ``fit``, or without those that are None."""
    held = document(found)
    held["fit"] = {k: v for k, v in (held["fit"] | fit).items() if v is not None}
    held["schema_version"] = 1 if "interval_factor" in fit else held["schema_version"]
    path.write_text(json.dumps(held | {DIGEST: digest_of(held)}), encoding="utf-8")
    return path


def test_a_loaded_calibration_states_the_same_uncertainty(
    camera: Calibration, tmp_path: Path
) -> None:
    save(camera, tmp_path / "camera.json")
    loaded = load(tmp_path / "camera.json")
    at = np.vstack([FEATURES, OUTSIDE])
    assert loaded.deviation_deg(at) == pytest.approx(camera.deviation_deg(at), nan_ok=True)
    assert loaded.deviations_deg(at) == pytest.approx(camera.deviations_deg(at), nan_ok=True)
    assert loaded.covariance(at) == pytest.approx(camera.covariance(at), nan_ok=True)
    assert np.isnan(camera.covariance(OUTSIDE)).all()


def test_the_covariance_has_the_stated_deviations_and_none_along_the_direction(
    camera: Calibration,
) -> None:
    covariance, sun = camera.covariance(FEATURES), camera.model.predict(FEATURES)
    stated = np.radians(camera.deviations_deg(FEATURES))
    for axis, one in enumerate(tangent_axes(sun)):
        along = np.einsum("ni,nij,nj->n", one, covariance, one)
        assert np.sqrt(along) == pytest.approx(stated[:, axis])
    assert np.einsum("nij,nj->ni", covariance, sun) == pytest.approx(0.0, abs=1e-15)


def test_a_correction_turns_the_covariance_with_the_direction(
    camera: Calibration, tmp_path: Path
) -> None:
    save(camera, tmp_path / "camera.json")
    turn = bench.turn("z", 90.0)
    rotation = tuple(tuple(float(c) for c in row) for row in turn)
    errors = Errors(1.0, 1.0, 1.0, 1.0)
    found = Correction(("boresight",), (1.0, 1.0), (0.0, 0.0), rotation, errors, errors, (), 12)
    held = with_correction(load(tmp_path / "camera.json"), found, [])
    (tmp_path / "turned.json").write_text(json.dumps(held), encoding="utf-8")
    turned = load(tmp_path / "turned.json").covariance(FEATURES)
    assert turned == pytest.approx(turn @ camera.covariance(FEATURES) @ turn.T)


def test_a_document_of_version_1_states_its_factor_times_what_the_model_states(
    camera: Calibration, tmp_path: Path
) -> None:
    loaded = load(changed(camera, tmp_path / "old.json", intervals=None, interval_factor=1.5))
    assert loaded.intervals is None
    stated = 1.5 * camera.model.deviation_deg(FEATURES)
    assert loaded.deviation_deg(FEATURES) == pytest.approx(stated)


def test_a_table_of_another_shape_is_refused(camera: Calibration, tmp_path: Path) -> None:
    held = document(camera)["fit"]["intervals"] | {"sectors": 3}
    with pytest.raises(UnreadableCalibrationError, match="expected intervals of shape"):
        load(changed(camera, tmp_path / "odd.json", intervals=held))
