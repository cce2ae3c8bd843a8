"""C10: what least squares of five numbers leaves of focal length and tilt errors (Rufino2004a).

Focal length error and both tilts of each unit are scaled from what careful assembly leaves up to
twenty times that, where the tilts are those of the condition ``misaligned``; rotation and offsets
stay careful. The sensor with careful assembly is the well aligned one, the one with twenty times
the errors the misaligned one. The second method fits the survey's eq:lsq, written down again from
print (with its two misprints corrected), by SciPy's trust-region method with its own derivatives.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import least_squares

from algorithms.angles import rotations_from_sun, sun_from_rotations
from algorithms.contract import Floats
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.geometric.standard_projection import StandardProjection
from benchmark.claims.benches import ConditionView, ratio, rms, separation
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import assemble
from benchmark.datasets.standard import cmos_single_aperture
from benchmark.simulator.optics.assembly import Assembly

TIMES = (1.0, 5.0, 10.0, 20.0)


def trial(number: int) -> Trial:
    """Measure one unit with each size of error."""
    drawn, fitted, again = [], [], []
    for times in TIMES:
        preset = assemble(cmos_single_aperture.PRESET, partial(_tilt, times=times))
        seen = ConditionView(preset, unit=number)
        drawn.append(rms(seen.errors(ThresholdedCentroid, StandardProjection)))
        fitted.append(rms(seen.errors(ThresholdedCentroid, LeastSquaresGeometry)))
        again.append(rms(_by_scipy(seen)))
    lines = {"spm": (TIMES, drawn), "lsq": (TIMES, fitted), "scipy.optimize": (TIMES, again)}
    return Trial(_statistics(drawn, fitted), lines, _statistics(drawn, again))


def _statistics(drawn: list[float], fitted: list[float]) -> dict[str, float]:
    return {"removes": ratio(drawn[-1], fitted[-1]), "whole": ratio(fitted[-1], fitted[0])}


def _tilt(assembly: Assembly, times: float) -> Assembly:
    return replace(
        assembly,
        tilt_x_deg=times * assembly.tilt_x_deg,
        tilt_y_deg=times * assembly.tilt_y_deg,
        focal_length_error_mm=times * assembly.focal_length_error_mm,
    )


def _by_scipy(seen: ConditionView) -> Floats:
    """Errors (N,) of eq:lsq fitted by SciPy; (Delta F, alpha_0, beta_0, x_zp, y_zp), mm and rad."""
    geometry = seen.preset.geometry
    focal, pitch = geometry.focal_length_mm or 0.0, geometry.pixel_pitch_mm or 0.0
    known, asked = (seen.features(ThresholdedCentroid, part) for part in ("calibration", "test"))
    wanted = np.radians(rotations_from_sun(seen.samples("calibration").sun))
    there = np.isfinite(known).all(axis=1)
    middle = np.asarray(geometry.centre_px)

    def angles(vector: Floats, spots: Floats) -> Floats:
        long, alpha_0, beta_0, x_zp, y_zp = vector
        x, y = (pitch * (spots - middle) - (x_zp, y_zp)).T
        inner = np.arctan((x + (focal + long) * np.tan(beta_0)) / (focal + long))
        outer = y + (focal + long) * np.tan(alpha_0) / np.cos(beta_0)
        alpha = np.arctan(np.cos(inner) * outer / (focal + long)) - alpha_0
        return np.column_stack([alpha, inner - beta_0])

    def residuals(vector: Floats) -> Floats:
        return (angles(vector, known[there]) - wanted[there]).ravel()

    found = least_squares(residuals, np.zeros(5), x_scale="jac", xtol=1e-12, ftol=1e-12).x
    said = sun_from_rotations(np.degrees(angles(found, asked)))
    return separation(said, seen.samples("test").sun)
