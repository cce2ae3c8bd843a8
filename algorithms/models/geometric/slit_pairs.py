"""The Slit model over two pairs of photodiodes, read by their balance (KeQiang2020)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.forward import TILTS, ForwardModel
from algorithms.calibration.parametric import RADIAN_DEG, FreeParameter
from algorithms.calibration.slit_sensor import require_crossed_slits
from algorithms.contract import AboutModel, FeatureKind, Floats, SensorGeometry
from algorithms.models.geometric.single_slit import deflect
from algorithms.parameters import require_positive

_DIAGONAL = math.sqrt(0.5)  # sine and cosine of 45 deg


@dataclass
class DeflectedSlitPairs(ForwardModel):
    """Slits over photodiode pairs, with errors of height, deflection and inclination.

    A strip of light lies over each pair; the balance says how far its middle is from the gap, as a
    line of pixels would. Both slits' errors, zero points and the head's tilts are fitted together.

    Parameters
    ----------
    focal_length_mm : float
        Theoretical distance f from slits to photodiodes, positive.
    unit_mm : float
        Displacement for one unit of balance, positive: a slit's width over sqrt(2).
    extrapolation : float
        Allowed extrapolation beyond the convex hull of the calibrated features, as a share of its
        half width, at least 0; infinity: unlimited.

    Attributes
    ----------
    vector_ : ndarray, shape (10,)
        f', theta and delta of the pair along (1, 1), then of that along (-1, 1), mm and degrees;
        balance (a, b) on the boresight; tilts of the head about x and y in degrees.
    covariance_ : ndarray, shape (10, 10)
        Of their errors.
    condition_ : float
        Of the equations at the solution.
    quality_ : FitQuality
        Residuals, and the ten with their standard errors by name.
    hull_ : Hull
        Of the calibrated features.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: eq:slit (model:slit, KeQiang2020) for each slit (`slit`), u along its pair and v
    across: ``f tan(u') = f' [tan(u) + tan(v) tan(arctan(tan(u) tan(delta) / (1 - tan(v)
    tan(delta))) - theta)]``. The survey files studies that read a voltage balance under it; their
    measured angle is ``tan(u') = S_u w / (2 f)`` (alg:VB), S_u the balance along the pair and w
    the width that the drawing gives the opening. Pairs lie at 45 deg to the sensor's axes:
    ``u = (x + y) / sqrt(2)`` and ``(y - x) / sqrt(2)``. Ours: the zero points and the head's tilts.
    What a gap takes off both diodes scales a balance, as f' does; light that a thick slit's walls
    take is left to a compensation (`slit-shadow`).

    Shapes: balances ``(s_a, s_b)`` (N, 2), dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, outside the hull, and where the steps have not
    converged within 6e-8 deg. fit raises UnusableDataError below 6 samples, where they do not
    determine the parameters or are inconsistent.

    Cost: 30 times 60 operations per sample; the fit, some ten times twenty passes of 60.

    References
    ----------
    KeQiang2020; survey model:slit, eq:slit, alg:VB.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import sun_from_angles
    >>> steps = [-40, -20, 0, 20, 40]
    >>> sun = sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))
    >>> balances = 0.52 / 2.0 * sun[:, :2] / sun[:, 2:]  # slits stand 0.02 mm too high
    >>> model = DeflectedSlitPairs(focal_length_mm=0.5, unit_mm=2.0).fit(balances, sun)
    >>> round(model.quality_.parameter("focal_length_u").value, 6)
    0.52
    """

    about: ClassVar = AboutModel(
        name="slit-pairs",
        taxonomy="Slit",
        studies=("KeQiang2020",),
        labels=("model:slit", "eq:slit", "alg:VB"),
        origin="survey",
        needs=("focal_length_mm", "aperture_width_mm", "slits"),
        accepts=frozenset({FeatureKind.BALANCE}),
    )

    focal_length_mm: float
    unit_mm: float

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(
            self.about.name, focal_length_mm=self.focal_length_mm, unit_mm=self.unit_mm
        )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model that starts from the sensor's drawing.

        UnsuitableDesignError unless its slits are two of one width, 45 deg to the axes.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        require_crossed_slits(geometry, by=cls.about.name)
        return cls(
            focal_length_mm=geometry.focal_length_mm or 0.0,
            unit_mm=(geometry.aperture_width_mm or 0.0) / 2.0,
        )

    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent of a unit of balance, and the balance on the boresight."""
        return self.unit_mm / self.focal_length_mm, (0.0, 0.0)

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal = self.focal_length_mm
        pairs = (
            FreeParameter(f"{what}_{pair}", unit, scale, drawn)
            for pair in "uv"
            for what, unit, scale, drawn in (
                ("focal_length", "mm", focal, focal),
                ("deflection", "deg", RADIAN_DEG, 0.0),
                ("inclination", "deg", RADIAN_DEG, 0.0),
            )
        )
        centres = (FreeParameter(f"centre_{of}", "", focal / self.unit_mm) for of in "ab")
        return (*pairs, *centres, *TILTS)

    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) balances of tangents (N, 2)."""
        x, y = tangents.T
        first, second = _DIAGONAL * (x + y), _DIAGONAL * (y - x)
        u = vector[0] * deflect(first, second, vector[1], vector[2])
        v = vector[3] * deflect(second, first, vector[4], vector[5])
        found = np.empty_like(tangents)
        found[:, 0] = vector[6] + _DIAGONAL / self.unit_mm * (u - v)
        found[:, 1] = vector[7] + _DIAGONAL / self.unit_mm * (u + v)
        return found
