"""A pinhole as it was built: turned, tilted, mirrored, with two focal lengths (ours)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.angles import tangents_from_sun
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.forward import TURNS
from algorithms.calibration.parametric import FreeParameter, ParametricModel
from algorithms.calibration.projection import ProjectionModel
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.nominal_projection import (
    POSITIONS,
)


@documented
@dataclass
class BuiltPinhole(ProjectionModel, ParametricModel):
    """Pinhole projection with all assembly errors: seven parameters and a mirror image.

    The detector may be turned about the boresight, mounted from its back, and have another scale
    along either axis; the head may be tilted. Effects outside this model remain as residuals.

    Attributes
    ----------
    mirrored_ : bool
        Whether x runs the other way.
    vector_ : ndarray, shape (7,)
        Focal lengths along x and y in mm, rotation and the two tilts in degrees, centre (x, y).

    Notes
    -----
    Implements: model:spm (eq:stdproj) with the errors of assembly that model:lsq leaves out: ``t =
    (+-(x - x_0) unit / f_x, (y - y_0) unit / f_y, 1)``, ``s = R_x(tilt_x) R_y(tilt_y) R_z(rotation)
    t / |t|``. In a narrow field a tilt and a shift of the centre have nearly the same effect; their
    standard errors are then large, but directions remain accurate.

    Failure: a NaN row for a NaN feature row and outside the hull. fit raises UnusableDataError
    below 4 samples, where they do not determine the parameters or are inconsistent.

    Cost: 25 operations and one root per sample; the fit, some ten times fifteen passes.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-40, 41, 20))
    >>> x, y = (200.0 * sun[:, :2] / sun[:, 2:]).T
    >>> turned = np.column_stack([y, x])  # a quarter turn and a mirror
    >>> model = BuiltPinhole(focal_length_mm=2.1, unit_mm=0.01).fit(turned, sun)
    >>> model.mirrored_, round(model.quality_.parameter("focal_length_x").value, 6)
    (True, 2.0)
    """

    about: ClassVar = AboutModel(
        name="pinhole",
        taxonomy="LSQ",
        labels=("model:spm", "model:lsq", "eq:stdproj"),
        needs=("focal_length_mm",),
        accepts=POSITIONS,
    )

    mirrored_: bool = field(init=False, repr=False, compare=False)

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal, reach = self.focal_length_mm, self.focal_length_mm / self.unit_mm
        x, y = self.centre
        return (
            FreeParameter("focal_length_x", "mm", focal, focal),
            FreeParameter("focal_length_y", "mm", focal, focal),
            *TURNS,
            FreeParameter("centre_x", "", reach, x),
            FreeParameter("centre_y", "", reach, y),
        )

    def starts(self, features: Floats, sun: Floats, context: Columns) -> Sequence[Sequence[float]]:
        """Read turn and mirror off the plane that fits the tangents best."""
        del context
        require_samples(len(features), 4, self.about.name, "seven parameters, two angles each")
        tangents = tangents_from_sun(sun)[:, ::-1]
        middle = features.mean(axis=0)
        moved, wanted = features - middle, tangents - tangents.mean(axis=0)
        slopes = np.linalg.lstsq(moved, wanted, rcond=None)[0].T  # tangents = slopes moved
        self.mirrored_ = bool(np.linalg.det(slopes) < 0)
        way = -1.0 if self.mirrored_ else 1.0
        x, y = slopes[:, 0] * way, slopes[:, 1]
        turn = np.degrees(np.arctan2(x[1] - y[0], x[0] + y[1]))
        lengths = self.unit_mm / np.maximum(np.hypot(*slopes), 1e-12)
        nominal = (self.focal_length_mm, self.focal_length_mm)
        return (
            (*lengths, turn, 0.0, 0.0, *self.centre),
            (*nominal, turn, 0.0, 0.0, *self.centre),
        )

    def directions(self, vector: Floats, features: Floats, context: Columns) -> Floats:
        """(N, 3) directions of features (N, 2)."""
        from algorithms.calibration.parametric_kernel import directions_outside  # noqa: PLC0415 - Numba

        del context
        focal_x, focal_y = vector[:2]
        x = (features[:, 0] - vector[5]) * (self.unit_mm / focal_x)
        y = (features[:, 1] - vector[6]) * (self.unit_mm / focal_y)
        if self.mirrored_:
            x = -x
        turns = np.radians(vector[2:5])
        rotation, tilt_x, tilt_y = zip(np.cos(turns).tolist(), np.sin(turns).tolist(), strict=True)
        found = np.empty((len(features), 3))
        directions_outside(x, y, rotation, tilt_x, tilt_y, found)
        return found
