"""The V-slit model: one line under a square and a slanted slit, and glass (Fan2015, Fan2016)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.forward import TURNS
from algorithms.calibration.parametric import RADIAN_DEG, FreeParameter
from algorithms.calibration.slit_sensor import NEEDS, SlitModel, refraction_height_mm, shadow
from algorithms.contract import AboutModel, FeatureKind, Floats, UnsuitableDesignError
from algorithms.documented import documented


@documented
@dataclass
class VSlit(SlitModel):
    """One line under a V of two slits; position and rotation of the line and the glass are fitted.

    Both angles come from one line, so every error of its position and rotation couples them. Five
    parameters describe the line, two the glass, and three the rotation of the head.

    Parameters
    ----------
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of both slits: one square to the line, one slanted.

    Attributes
    ----------
    vector_ : ndarray, shape (8,) or (10,)
        Focal length, the mask's shifts along and across the line in mm, the line's deflection in
        the mask's plane and its slope out of it, the head's rotation and tilts about x and y in
        degrees; with glass, its thickness in mm and its index.

    Notes
    -----
    Implements: eq:vslit1, eq:vslit2 (model:vslit, Fan2015, Fan2016) as what they are solved from:
    with ``p = (X - X_slit + T_1, T_2, T_3)`` a point of the line and ``p' = R^T p`` in the mask's
    frame, a ray from p' meets the plane of the mask on the slit, ``p'_1 - p'_3 tan(u) = 0`` for
    the square one (eq:vslit1) and ``p'_1 - p'_3 tan(u) + tan(slant) (p'_2 - p'_3 tan(v)) = 0`` for
    the slanted one (eq:vslit2, whose angle v counts the other way). Six structural and two
    refraction parameters in the survey. Of R's three turns, that about the line itself is a turn
    of the head with a shift T_2: with angles counted in the mask's frame, as printed, no sample
    distinguishes them. So five are left here, T and two turns, and the head has three of its own,
    which the survey leaves out. X is counted without refraction in print; here a plate takes ``t
    (1 - 1 / sqrt(n^2 + (n^2 - 1) tan^2))`` off the height (Snell's law, eq:refcomp1), for all
    plates together, starting from their whole thickness and mean index.

    Failure: a NaN row for a NaN feature row, outside the hull, and where the steps have not
    converged within 6e-8 deg. fit raises UnusableDataError below 5 samples (6 with glass), where
    they do not determine the parameters or are inconsistent. Thickness and index act alike but far
    off the boresight: their standard errors are large together, those of directions are not.

    Cost: 30 times 60 operations per sample; the fit, some ten times twenty passes of 60.

    Examples
    --------
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-40, 41, 20))
    >>> spots = 180.0 * sun[:, :2] / sun[:, 2:]
    >>> lines = dict(line_axes=("y",), slits=((-3.3, 0.0, 0.1), (0.5, 45.0, 0.1)))
    >>> model = VSlit(focal_length_mm=1.7, pixel_pitch_mm=0.01, centre_px=(0.0, 0.0), **lines)
    >>> round(model.fit(spots, sun).quality_.parameter("focal_length").value, 6)
    1.8
    """

    about: ClassVar = AboutModel(
        name="v-slit",
        taxonomy="V-Slit",
        studies=("Fan2015", "Fan2016"),
        labels=("model:vslit", "eq:vslit1", "eq:vslit2", "eq:refcomp1"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOT}),
    )

    def require_slits(self) -> None:
        """One line, a square slit and a slanted one."""
        slants = [slit[1] for slit in self.slits]
        if len(self.line_axes) != 1 or len(slants) != 2 or slants.count(0.0) != 1:
            raise UnsuitableDesignError(
                f"{self.about.name} needs one line behind one slit square to it and one slanted; "
                f"got lines {self.line_axes!r} and slits {self.slits!r}"
            )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal = self.focal_length_mm
        glass: tuple[FreeParameter, ...] = ()
        if self.cover_glass:
            thickness = sum(plate[0] for plate in self.cover_glass)
            index = sum(t * n for t, n in self.cover_glass) / thickness
            glass = (
                FreeParameter("glass_thickness", "mm", focal, thickness),
                FreeParameter("glass_index", "", 1.0, index),
            )
        return (
            FreeParameter("focal_length", "mm", focal, focal),
            FreeParameter("shift_along", "mm", focal),
            FreeParameter("shift_across", "mm", focal),
            FreeParameter("deflection", "deg", RADIAN_DEG),
            FreeParameter("slope", "deg", RADIAN_DEG),
            *TURNS,
            *glass,
        )

    def shifts(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) shifts, mm, of tangents (N, 2) by slant, in the order of the slits."""
        height = np.full(len(tangents), vector[0])
        if self.cover_glass:
            height -= refraction_height_mm(tangents, vector[8], vector[9])
        along_line = tangents if self.line_axes[0] == "x" else tangents[:, ::-1]
        line = (vector[1], vector[2], vector[3], vector[4])
        slits = [(position, np.tan(np.radians(slant))) for position, slant, _ in self.slits]
        found = np.empty_like(tangents)
        for column, slit in enumerate(slits):
            found[:, column] = shadow(along_line, slit, height, line)
        return found
