"""The Panoramic model with its temperature term (Zhang2022b)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.quality import Parameter
from algorithms.contract import AboutModel, FeatureKind, Floats, UnusableDataError
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.geometric.panoramic import WeightedCells

#: Of the temperatures, as a share of what they and their mean are off the reference.
_STEADIEST = 1e-9
#: Newton's method on one number, which starts near: it rests after three or four.
_STEPS = 20


@documented
@dataclass
class WarmCells(WeightedCells):
    """Weighted least squares over all lit cells, with temperature-dependent reference currents.

    The current of a cell depends on temperature; without a correction cells near the limit of
    incidence are included or excluded wrongly. One thermometer serves all cells.

    Parameters
    ----------
    largest_incidence_deg : float
        Largest angle of incidence, in (0, 90); a cell counts as lit if its signal over its
        reference current is at least the cosine of this angle.
    reference_temperature_K : float
        T_0, positive.

    Attributes
    ----------
    coefficient_ : float
        K over the reference current, per kelvin: what of it a kelvin takes.
    coefficient_deviation_ : float
        Its standard error.
    reference_ : ndarray, shape (K,)
        Current of every cell under perpendicular sunlight at T_0, in units of the features.

    Notes
    -----
    Implements: eq:msfpano (model:pano, Zhang2022b): ``s = (A^T W A)^-1 A^T W (I_i / (I_max,T0 - K
    (T_i - T_0)))`` over lit cells. The survey prints ``W A^T`` as the last factor; corrected
    because only ``A^T W`` is weighted least squares. T_i is there a cell's own, here the one
    temperature of the context's ``temperature_K``. I_max,T0 is learnt for every cell, and K in
    proportion to it, as one amplifier's gain scales both: ``K = coefficient I_max,T0``; both by
    least squares of the calibration signals on the cosines up to `largest_incidence_deg`. A common
    factor of all signals leaves the direction as it is, so temperature tells through the reference
    currents of the calibration and through which cells count as lit.

    Shapes: signals (N, K), in any common unit, to unit vectors (N, 3), all directions; context
    ``temperature_K`` (N,).

    Failure: a NaN row for a NaN feature row or temperature, outside the hull, where fewer than
    three cells are lit or those lit look along one plane, and where it is so warm that no current
    is left. fit raises UnusableDataError where no sample lights a cell, and where temperatures
    hardly differ. Albedo is not distinguished from sunlight.

    Cost: 22 operations per cell, 32 per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import face_signals
    >>> normals = ((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.0, -0.6, 0.8))
    >>> sun = np.array([[0.0, 0.0, 1.0], [0.28, 0.0, 0.96], [0.0, -0.28, 0.96]])
    >>> warm = {"temperature_K": np.array([298.15, 318.15, 338.15])}
    >>> fall = 1.0 - 0.004 * (warm["temperature_K"] - 298.15)
    >>> model = WarmCells(normals).fit(face_signals(sun, normals) * fall[:, None], sun, warm)
    >>> round(model.coefficient_, 6)
    0.004
    """

    about: ClassVar = AboutModel(
        name="panoramic-temperature",
        taxonomy="Panoramic",
        studies=("Zhang2022b",),
        labels=("model:pano", "eq:msfpano"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
        context=("temperature_K",),
    )

    reference_temperature_K: float = 298.15  # noqa: N815 - a unit, as in the context

    coefficient_: float = field(init=False, repr=False, compare=False)
    coefficient_deviation_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (np.isfinite(self.reference_temperature_K) and self.reference_temperature_K > 0):
            raise ValueError(
                f"{self.about.name}: reference_temperature_K must be positive and finite; "
                f"got {self.reference_temperature_K!r}"
            )

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn the reference currents and the temperature coefficient."""
        warmth = context["temperature_K"] - self.reference_temperature_K
        known = np.isfinite(warmth)
        require_samples(int(known.sum()), 2, self.about.name, "with a temperature")
        features, warmth = features[known], warmth[known]
        cosines = sun[known] @ np.asarray(self.face_normals, dtype=np.float64).T
        cosines[cosines < self._smallest_cosine] = 0.0
        lit = (cosines**2).sum(axis=0) > 0
        require_samples(int(lit.sum()), 1, self.about.name, "that light a cell")
        self.coefficient_, self.coefficient_deviation_, currents = _fit(
            features[:, lit], cosines[:, lit], warmth, self.about.name
        )
        reference = np.full(len(lit), currents.mean())
        reference[lit] = currents
        if not (reference > 0).all():
            raise UnusableDataError(
                f"{self.about.name}: cells turned to the Sun must have positive signals; the "
                f"calibration gives a reference current of {reference.min():.6g}"
            )
        self.reference_ = reference

    def fitted_parameters(self) -> tuple[Parameter, ...]:
        """Return the temperature coefficient."""
        return (
            Parameter(
                "temperature_coefficient", self.coefficient_, self.coefficient_deviation_, "1/K"
            ),
        )

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, K)."""
        warmth = context["temperature_K"] - self.reference_temperature_K
        fall = 1.0 - self.coefficient_ * warmth
        fall[~(fall > 0)] = np.nan
        cold = np.empty_like(features)
        for column, scaled in zip(features.T, cold.T, strict=True):
            np.divide(column, fall, out=scaled)
        return super().answer(cold, {})


def _fit(signals: Floats, cosines: Floats, warmth: Floats, by: str) -> tuple[float, float, Floats]:
    """Coefficient, its standard error and the currents (K,) that explain signals (n, K) best.

    ``signal = current cosine (1 - coefficient warmth)``: for a coefficient the currents follow one
    by one, so Gauss and Newton's steps go along the one number that is left.
    """
    coefficient = 0.0
    for _ in range(_STEPS):
        scaled = cosines * (1.0 - coefficient * warmth)[:, None]
        squares = (scaled**2).sum(axis=0)
        currents = (signals * scaled).sum(axis=0) / squares
        off = signals - scaled * currents
        slope = -(cosines * warmth[:, None]) * currents
        # what of the slope no change of a current makes up for
        free = slope - scaled * ((slope * scaled).sum(axis=0) / squares)
        strength = float((free**2).sum())
        if not strength > _STEADIEST * float((slope**2).sum()):
            raise UnusableDataError(
                f"{by} needs calibration samples at different temperatures; those given span "
                f"{np.ptp(warmth):.6g} K"
            )
        step = float((free * off).sum()) / strength
        coefficient += step
    freedom = max(int((cosines > 0).sum()) - len(currents) - 1, 1)
    variance = float((np.where(cosines > 0, off, 0.0) ** 2).sum()) / freedom
    return coefficient, float(np.sqrt(variance / strength)), currents
