"""A bare detector as it stands behind its mask: homography and radial stretch (ours)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.forward import ForwardModel
from algorithms.calibration.parametric import FreeParameter
from algorithms.calibration.projection import ProjectionModel
from algorithms.contract import AboutModel, FeatureKind, Floats
from algorithms.documented import documented

_ELEMENTS = "h11", "h12", "h13", "h21", "h22", "h23", "h31", "h32"
_FREE = tuple(FreeParameter(name, "", 1.0) for name in (*_ELEMENTS, "k1", "k2"))


@documented
@dataclass
class BareDetector(ProjectionModel, ForwardModel):
    """Homography between mask and a detector at any orientation, after a radial distortion.

    Eight parameters describe any plane behind a pinhole: scale, rotation, tilt, skew and mirror
    image. Refraction and the aperture's depth stretch tangents about the mask's normal before.

    Attributes
    ----------
    vector_ : ndarray, shape (10,)
        The homography's first eight elements by rows, the ninth being 1, in nominal focal lengths
        off the nominal centre; k1 and k2.

    Notes
    -----
    Implements: model:cam (eq:cameq) for a sensor without a lens: ``(x', y', 1) ~ H (t (1 + k1 r^2 +
    k2 r^4), 1)`` with t the tangents, r their length. Without distortion a homography is a camera
    with skew, turned: ``H = K R``. With it, it is not: a camera's distortion comes after its turn,
    about its optical axis, a bare sensor's before the detector's tilt, about the mask's normal.
    Hence a class of its own. The start is the affine map that fits best.

    Failure: a NaN row for a NaN feature row, outside the hull, and where the steps have not
    converged within 6e-8 deg. fit raises UnusableDataError below 6 samples, where they do not
    determine the parameters or are inconsistent.

    Cost: 36 times 30 operations per sample; the fit, some ten times 21 passes of 30.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-40, 41, 20))
    >>> x, y = (sun[:, :2] / sun[:, 2:]).T
    >>> tilted = 200.0 * np.column_stack([x, y]) / (1.0 + 0.05 * x)[:, None]
    >>> model = BareDetector(focal_length_mm=2.0, unit_mm=0.01).fit(tilted, sun)
    >>> round(model.quality_.parameter("h31").value, 6)
    0.05
    """

    about: ClassVar = AboutModel(
        name="homography",
        taxonomy="Camera",
        labels=("model:cam", "eq:cameq"),
        needs=("focal_length_mm", "pixel_pitch_mm", "centre_px"),
        accepts=frozenset({FeatureKind.SPOT}),
    )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """In focal lengths and tangents, the head's turns among them."""
        return _FREE

    def starts(self, features: Floats, sun: Floats, context: Columns) -> Sequence[Sequence[float]]:
        """Give the affine map that fits best."""
        del context
        slope, centre = self.drawing()
        design = np.column_stack([sun[:, :2] / sun[:, 2:], np.ones(len(sun))])
        affine = np.linalg.lstsq(design, (features - centre) * slope, rcond=None)[0].T
        return ((*affine.ravel().tolist(), 0.0, 0.0, 0.0, 0.0),)

    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent of a pixel, and the spot on the boresight."""
        return self.unit_mm / self.focal_length_mm, self.centre

    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) places in px of tangents (N, 2); NaN where the detector does not reach."""
        from algorithms.models.geometric.projection_kernel import cast_by_homography  # noqa: PLC0415 - Numba

        slope, (left, low) = self.drawing()
        places = np.empty((len(tangents), 2))
        cast_by_homography(tangents, vector, slope, (float(left), float(low)), places)
        return places
