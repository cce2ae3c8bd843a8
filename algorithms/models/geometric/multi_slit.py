"""The Multi-slit model: rows of slits in a thick mask over lines of pixels (Bolshakov2020)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.forward import TURNS
from algorithms.calibration.parametric import FreeParameter
from algorithms.calibration.slit_sensor import NEEDS, SlitModel
from algorithms.contract import AboutModel, FeatureKind, Floats, UnsuitableDesignError
from algorithms.documented import documented


@documented
@dataclass
class MultiSlit(SlitModel):
    """Spots of several slits whose edges come from the lower and the upper rim of the mask.

    The upper rim cuts oblique light on one side and the lower rim on the other, so the effective
    height is either the same everywhere or differs between the two sides of the boresight.

    Parameters
    ----------
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of each slit, at least two.

    Attributes
    ----------
    vector_ : ndarray, shape (8,)
        Focal length and zero shift of the first line (or slant), then of the second, and what both
        sides' heights differ by, mm; the head's rotation and tilts about x and y in degrees.

    Notes
    -----
    Implements: eq:mslit1, eq:mslit2 (model:mslit, Bolshakov2020): ``tan(theta_i) = (X_i - d_i) /
    h`` of edges from the lower rim (even i), ``(X_i - d_i) / (h + t)`` of those from the upper one
    (odd i); on the other side of the boresight they change places. Extractors of profiles give one
    shift for all edges of a line, not d_i: the mean over slits, and over both edges with a weight
    r of the upper end's, is ``tan(theta) (h + t / 2 + sign(theta) (1/2 - r) t)``. A method that
    sees both edges alike (r = 1/2) leaves one height, ``h + t / 2``. Both are fitted, not t itself:
    telling h from t takes each edge's own place. Of slits that slant, ``tan(theta)`` is ``tan(u) +
    tan(slant) tan(v)``. Ours: a focal length and a zero a line or slant, the head's turns, plates
    of the drawing by Snell's law (eq:refcomp1).

    Failure: a NaN row for a NaN feature row, outside the hull, and where the steps have not
    converged within 6e-8 deg. fit raises UnusableDataError below 5 samples, where they do not
    determine the parameters or are inconsistent. An inclined mask is left as a residual (`slit`).

    Cost: 30 times 40 operations per sample; the fit, some ten times twenty passes of 40.

    Examples
    --------
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-40, 41, 20))
    >>> spots = 24.5 * sun[:, :2] / sun[:, 2:]  # 1.225 mm over pixels of 50 um
    >>> lines = dict(line_axes=("x", "y"), slits=((-0.6, 0.0, 0.2), (0.7, 0.0, 0.2)))
    >>> model = MultiSlit(focal_length_mm=1.2, pixel_pitch_mm=0.05, centre_px=(0.0, 0.0), **lines)
    >>> round(model.fit(spots, sun).quality_.parameter("focal_length_1").value, 6)
    1.225
    """

    about: ClassVar = AboutModel(
        name="multi-slit",
        taxonomy="Multi-Slit",
        studies=("Bolshakov2020",),
        labels=("model:mslit", "eq:mslit1", "eq:mslit2", "eq:refcomp1"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOT}),
    )

    def require_slits(self) -> None:
        """More than one slit of a slant."""
        if len(self.slits) < 2 * len(self.slants()):
            raise UnsuitableDesignError(
                f"{self.about.name} needs several slits of each slant; got slits {self.slits!r}"
            )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal = self.focal_length_mm
        return (
            FreeParameter("focal_length_1", "mm", focal, focal),
            FreeParameter("zero_1", "mm", focal),
            FreeParameter("focal_length_2", "mm", focal, focal),
            FreeParameter("zero_2", "mm", focal),
            FreeParameter("sides_differ", "mm", focal),
            *TURNS,
        )

    def shifts(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) shifts, mm, of tangents (N, 2), by line and slant."""
        found, glass = np.empty_like(tangents), self.glass(tangents)
        for number, (x, y) in enumerate(self.layout()):
            focal, zero = vector[2 * number : 2 * number + 2]
            reach = x * tangents[:, 0] + y * tangents[:, 1]
            found[:, number] = (focal - glass) * reach + 0.5 * vector[4] * np.abs(reach) + zero
        return found
