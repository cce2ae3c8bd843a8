"""The Camera model: a lens with its distortion (Saleem2019)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.forward import TURNS, ForwardModel
from algorithms.calibration.parametric import FreeParameter
from algorithms.calibration.projection import ProjectionModel
from algorithms.contract import AboutModel, FeatureKind, Floats, SensorGeometry
from algorithms.documented import documented
from algorithms.models.nominal_projection import nominal_projection


@documented
@dataclass
class LensCamera(ProjectionModel, ForwardModel):
    """Camera with OpenCV's intrinsics: two focal lengths, principal point, lens distortion.

    A lens images tangents with radial distortion, and with decentring distortion if its elements
    are misaligned. All parameters are fitted to known Sun directions, with the camera's rotation.

    Parameters
    ----------
    distortion : tuple of two float
        Nominal (k1, k2), where the fit starts.

    Attributes
    ----------
    vector_ : ndarray, shape (11,)
        Focal lengths along x and y in mm, principal point (x, y) in px, k1, k2, p1, p2, the
        camera's rotation and tilts about x and y in degrees.

    Notes
    -----
    Implements: eq:cameq (model:cam, Saleem2019): ``tan(phi) = (u - p_x) / f``, ``tan(theta) = -(v
    - p_y) / f``, with phi along x (beta here) and theta upwards. The minus sign is omitted here,
    because y increases in the direction in which alpha moves a spot. It holds for undistorted
    places: the camera's own are ``x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2)``, ``y (1 +
    k1 r^2 + k2 r^4) + p1 (r^2 + 2 y^2) + 2 p2 x y`` of the tangents x and y (Brown and Conrady, as
    OpenCV counts them), solved for by Newton's method. Least squares of our own:
    ``cv2.calibrateCamera`` looks for where a target stands, which of the Sun at infinity nothing
    tells. In a narrow field tilts, principal point and p1, p2 have nearly the same effect; their
    standard errors are then large.

    Failure: a NaN row for a NaN feature row, outside the hull, and where the steps have not
    converged within 6e-8 deg, as where the distortion folds the picture back. fit raises
    UnusableDataError below 6 samples, where they do not determine the parameters or are
    inconsistent.

    Cost: 36 times 40 operations per sample; the fit, some ten times 23 passes of 40.

    Examples
    --------
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-30, 31, 15))
    >>> tangents = sun[:, :2] / sun[:, 2:]
    >>> stretch = 1.0 - 0.1 * (tangents**2).sum(axis=1, keepdims=True)
    >>> model = LensCamera(focal_length_mm=3.0, unit_mm=0.01).fit(305.0 * stretch * tangents, sun)
    >>> [round(model.quality_.parameter(name).value, 6) for name in ("focal_length_x", "k1")]
    [3.05, -0.1]
    """

    about: ClassVar = AboutModel(
        name="camera",
        taxonomy="Camera",
        studies=("Saleem2019",),
        labels=("model:cam", "eq:cameq"),
        origin="survey",
        needs=("focal_length_mm", "pixel_pitch_mm", "centre_px", "lens_distortion"),
        accepts=frozenset({FeatureKind.SPOT}),
    )

    distortion: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.shape(self.distortion) != (2,) or not np.isfinite(self.distortion).all():
            raise ValueError(
                f"{self.about.name}: distortion must be two finite numbers; got {self.distortion!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model that starts from the sensor's drawing."""
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls(
            **nominal_projection(geometry, kind, cls.about),
            distortion=geometry.lens_distortion or (0.0, 0.0),
        )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal, reach = self.focal_length_mm, self.focal_length_mm / self.unit_mm
        (x, y), (k1, k2) = self.centre, self.distortion
        return (
            FreeParameter("focal_length_x", "mm", focal, focal),
            FreeParameter("focal_length_y", "mm", focal, focal),
            FreeParameter("principal_x", "px", reach, x),
            FreeParameter("principal_y", "px", reach, y),
            FreeParameter("k1", "", 1.0, k1),
            FreeParameter("k2", "", 1.0, k2),
            FreeParameter("p1", "", 1.0),
            FreeParameter("p2", "", 1.0),
            *TURNS,
        )

    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent of a pixel, and the spot on the boresight."""
        return self.unit_mm / self.focal_length_mm, self.centre

    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) places in px of tangents (N, 2)."""
        x, y = tangents.T
        k1, k2, p1, p2 = vector[4:8]
        square, product = x * x + y * y, 2.0 * x * y
        stretch = 1.0 + square * (k1 + square * k2)
        across = x * stretch + p1 * product + p2 * (square + 2.0 * x * x)
        up = y * stretch + p1 * (square + 2.0 * y * y) + p2 * product
        focal_x, focal_y = vector[:2] / self.unit_mm
        return np.stack([focal_x * across + vector[2], focal_y * up + vector[3]], axis=1)
