"""The N-slit model: one line under a square slit between two slanted ones (Maji2015)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.forward import TURNS
from algorithms.calibration.parametric import RADIAN_DEG, FreeParameter
from algorithms.calibration.slit_sensor import NEEDS, SlitModel, shadow
from algorithms.contract import AboutModel, FeatureKind, Floats, UnsuitableDesignError
from algorithms.documented import documented

#: Largest difference of the outer slits' slants, degrees.
_SAME_SLANT_DEG = 1e-6


@documented
@dataclass
class NSlit(SlitModel):
    """One line under an N of slits; refraction factor, slant, position and rotation are fitted.

    The middle spot moves with the angle along the line alone, the mean of both outer ones with
    both angles; the difference, over the tangent of the slant, is the other angle's.

    Parameters
    ----------
    focal_length_mm : float
        Distance h from mask to line, positive; it stays, as K scales it.
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of the three slits, in the order of their positions;
        the middle one square to the line, the others of one slant.

    Attributes
    ----------
    vector_ : ndarray, shape (9,)
        K; the mask's shifts along and across the line in mm; the outer slits' slant, the line's
        deflection in the mask's plane and its slope out of it, the head's rotation and tilts about
        x and y in degrees.

    Notes
    -----
    Implements: eq:nslit1, eq:nslit2 (model:nslit, Maji2015): ``tan(alpha) = K (C_m - C_r) / h``,
    ``tan(beta) = K [(L_m - L_r + R_m - R_r) / 2 - (C_m - C_r)] / (h tan(delta))``. Extractors of
    profiles give the middle shift and the mean of the outer ones, which is all that the equations
    ask. The printed K is one number; no number undoes refraction over a wide field, so here it
    stands beside Snell's law (eq:refcomp1) for the drawing's plates, and is what the survey prints
    where there are none. Ours: the line's place and turns under the mask (see `v-slit`) and the
    head's turns; the reference centroids are the shifts.

    Failure: a NaN row for a NaN feature row, outside the hull, and where the steps have not
    converged within 6e-8 deg. fit raises UnusableDataError below 5 samples, where they do not
    determine the parameters or are inconsistent.

    Cost: 30 times 60 operations per sample; the fit, some ten times twenty passes of 60.

    Examples
    --------
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-40, 41, 20))
    >>> spots = 100.0 * sun[:, :2] / sun[:, 2:]
    >>> slits = ((-3.0, 45.0, 0.1), (0.0, 0.0, 0.1), (3.0, 45.0, 0.1))
    >>> lines = dict(line_axes=("y",), slits=slits, centre_px=(0.0, 0.0))
    >>> model = NSlit(focal_length_mm=1.2, pixel_pitch_mm=0.01, **lines).fit(spots, sun)
    >>> round(model.quality_.parameter("K").value, 6)
    1.2
    """

    about: ClassVar = AboutModel(
        name="n-slit",
        taxonomy="N-Slit",
        studies=("Maji2015",),
        labels=("model:nslit", "eq:nslit1", "eq:nslit2", "eq:refcomp1"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOT}),
    )

    def require_slits(self) -> None:
        """One line, a square slit between two of one slant."""
        slants = [slit[1] for slit in self.slits]
        if not (
            len(self.line_axes) == 1
            and len(slants) == 3
            and slants[1] == 0.0
            and slants[0] != 0.0
            and abs(slants[0] - slants[2]) <= _SAME_SLANT_DEG
        ):
            raise UnsuitableDesignError(
                f"{self.about.name} needs one line behind a slit square to it between two of one "
                f"slant; got lines {self.line_axes!r} and slits {self.slits!r}"
            )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal = self.focal_length_mm
        return (
            FreeParameter("K", "", 1.0, 1.0),
            FreeParameter("shift_along", "mm", focal),
            FreeParameter("shift_across", "mm", focal),
            FreeParameter("slant", "deg", RADIAN_DEG, self.slits[0][1]),
            FreeParameter("deflection", "deg", RADIAN_DEG),
            FreeParameter("slope", "deg", RADIAN_DEG),
            *TURNS,
        )

    def shifts(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) shifts, mm, of tangents (N, 2): of the outer spots' mean and the middle one."""
        height = self.focal_length_mm / vector[0] - self.glass(tangents)
        along_line = tangents if self.line_axes[0] == "x" else tangents[:, ::-1]
        line = (vector[1], vector[2], vector[4], vector[5])
        outer = (self.slits[0][0] + self.slits[2][0]) / 2.0, float(np.tan(np.radians(vector[3])))
        middle = self.slits[1][0], 0.0
        found = np.empty_like(tangents)
        for column, slit in enumerate((outer, middle)):
            found[:, column] = shadow(along_line, slit, height, line)
        return found
