"""The Slit model: two lines, each under a slit that stands off its drawing (KeQiang2020)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.forward import TILTS
from algorithms.calibration.parametric import RADIAN_DEG, FreeParameter
from algorithms.calibration.slit_sensor import NEEDS, SlitModel
from algorithms.contract import AboutModel, FeatureKind, Floats, UnsuitableDesignError
from algorithms.documented import documented


@documented
@dataclass
class DeflectedSlits(SlitModel):
    """Slits with errors of height, deflection and inclination over their lines.

    Each line measures one angle; deflection or inclination of the slit adds a dependence on the
    other angle. The three errors of each slit, both zero points and the head's tilts are fitted
    together.

    Parameters
    ----------
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of each slit over a line; all square to it.

    Attributes
    ----------
    vector_ : ndarray, shape (10,)
        f', theta and delta of the first line, then of the second, mm and degrees; centre (x, y)
        in px; tilts of the head about x and y in degrees.

    Notes
    -----
    Implements: eq:slit (model:slit, KeQiang2020) for each line, u along it and v across: ``tan(u')
    = (f'/f) [tan(u) + tan(v) tan(arctan(tan(u) tan(delta) / (1 - tan(v) tan(delta))) - theta)]``.
    The survey calls u' the corrected angle; it is the one that the sensor gives by its theoretical
    f, and u and v are the Sun's, as the geometry shows: with theta = 0 it is the spot ``f' tan(u)
    / (1 - tan(v) tan(delta))`` of a slit inclined by -delta. The two equations of both lines are
    solved for u and v by Newton's method. Ours: the zero points; the head's tilts, which bend both
    axes alike (a turn about the boresight is both deflections); plates of the drawing, which take
    ``t (1 - 1 / sqrt(n^2 + (n^2 - 1) tan^2))`` off each focal length (eq:refcomp1).

    Failure: a NaN row for a NaN feature row, outside the hull, and where the steps have not
    converged within 6e-8 deg. fit raises UnusableDataError below 6 samples, where they do not
    determine the parameters or are inconsistent. In a narrow field a tilt and a shift of the centre
    have nearly the same effect; their standard errors are then large.

    Cost: 30 times 60 operations per sample; the fit, some ten times twenty passes of 60.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-40, 41, 20))
    >>> x, y = (sun[:, :2] / sun[:, 2:]).T
    >>> spots = 350.0 * np.column_stack([x / (1 - 0.02 * y), y])  # one end of x's slit is lower
    >>> lines = dict(line_axes=("x", "y"), slits=((0.0, 0.0, 0.1),), centre_px=(0.0, 0.0))
    >>> model = DeflectedSlits(focal_length_mm=3.4, pixel_pitch_mm=0.01, **lines).fit(spots, sun)
    >>> round(float(np.tan(np.radians(model.quality_.parameter("inclination_x").value))), 6)
    0.02
    """

    about: ClassVar = AboutModel(
        name="slit",
        taxonomy="Slit",
        studies=("KeQiang2020",),
        labels=("model:slit", "eq:slit", "eq:refcomp1"),
        origin="survey",
        needs=NEEDS,
        accepts=frozenset({FeatureKind.SPOT}),
    )

    def require_slits(self) -> None:
        """Two lines at right angles, slits square to them."""
        if len(self.line_axes) != 2 or any(slit[1] for slit in self.slits):
            raise UnsuitableDesignError(
                f"{self.about.name} needs two lines at right angles behind slits square to them; "
                f"got lines {self.line_axes!r} and slits {self.slits!r}"
            )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal = self.focal_length_mm
        lines = (
            FreeParameter(f"{what}_{axis}", unit, scale, drawn)
            for axis in self.line_axes
            for what, unit, scale, drawn in (
                ("focal_length", "mm", focal, focal),
                ("deflection", "deg", RADIAN_DEG, 0.0),
                ("inclination", "deg", RADIAN_DEG, 0.0),
            )
        )
        reach = focal / self.pixel_pitch_mm
        x, y = self.centre_px
        centre = (
            FreeParameter("centre_x", "px", reach, x),
            FreeParameter("centre_y", "px", reach, y),
        )
        return (*lines, *centre, *TILTS)

    def shifts(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) shifts, mm, of tangents (N, 2): ``f tan(u')`` of both lines, with their zeros."""
        found = np.empty_like(tangents)
        glass = self.glass(tangents)
        for number, axis in enumerate(self.line_axes):
            focal, theta, delta = vector[3 * number : 3 * number + 3]
            u, v = tangents.T if axis == "x" else tangents.T[::-1]
            place = 0 if axis == "x" else 1
            zero = (vector[6 + place] - self.centre_px[place]) * self.pixel_pitch_mm
            found[:, number] = (focal - glass) * deflect(u, v, theta, delta) + zero
        return found


def deflect(along: Floats, across: Floats, theta_deg: float, delta_deg: float) -> Floats:
    """Tangents (N,) of u' that a slit deflected and inclined gives for those of u and v.

    The bracket of eq:slit: ``tan(u) + tan(v) tan(arctan(tan(u) tan(delta) / (1 - tan(v)
    tan(delta))) - theta)``, u along the line and v across it.

    Examples
    --------
    >>> deflect(np.array([1.0]), np.array([0.5]), theta_deg=0.0, delta_deg=0.0)
    array([1.])
    """
    slope, turn = np.tan(np.radians(delta_deg)), np.tan(np.radians(theta_deg))
    let_in = along * slope / (1.0 - across * slope)
    let_in = (let_in - turn) / (1.0 + let_in * turn)  # tan(arctan(let_in) - theta)
    return np.asarray(along + across * let_in)
