"""Errors that intervals are made from: the rim's are among them, and those of removed samples."""

from __future__ import annotations

import bench
import numpy as np
from samples import samples

from algorithms.angles import separation_deg
from algorithms.contract import SensorGeometry
from algorithms.discovery import discover_models
from calibrate.selection import compare, fitted
from calibrate.uncertainty import errors_left_out

SUN = bench.sun_of(bench.grid(13, 40.0))
CAMERA = SensorGeometry(focal_length_mm=3.5, pixel_pitch_mm=0.01, centre_px=(512.0, 512.0))
HOMOGRAPHY = discover_models()["homography"]


def left_out(wrong_deg: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Errors and directions of a grid of spots whose row 6 was removed, that being wrong."""
    used = samples(bench.spots(SUN, 1), SUN)
    kept, gone = np.arange(len(SUN)) != 6, np.arange(len(SUN)) == 6
    turned = samples(used.features[gone], SUN[gone] @ bench.turn("x", wrong_deg).T)
    used = used.only(kept)
    (chosen,) = compare(used, CAMERA, {"homography": HOMOGRAPHY})
    model = fitted(HOMOGRAPHY, used, CAMERA)
    return errors_left_out(HOMOGRAPHY, chosen, used, CAMERA, model, turned)


def test_the_rim_of_the_field_is_left_out_too() -> None:
    used = samples(bench.spots(SUN, 1), SUN)
    (chosen,) = compare(used, CAMERA, {"homography": HOMOGRAPHY})
    rim = np.isnan(np.asarray(chosen.offsets)).all(axis=1)
    assert rim.sum() >= 20
    assert rim[0]  # a corner
    model = fitted(HOMOGRAPHY, used, CAMERA)
    offsets, sun = errors_left_out(HOMOGRAPHY, chosen, used, CAMERA, model, used.only(rim & False))
    assert np.isfinite(offsets).all(axis=1).mean() > 0.95
    # 0.05 px an axis at 350 px of focal length, foreshortened away from the middle
    size = separation_deg(offsets + sun, sun)[rim]
    assert 0.003 < np.sqrt(np.nanmean(size**2)) < 0.0116


def test_a_sample_that_the_model_removed_counts_with_its_error() -> None:
    offsets, sun = left_out(wrong_deg=2.0)
    assert len(offsets) == len(sun) == len(SUN)
    assert np.degrees(np.linalg.norm(offsets[-1])) > 1.0
