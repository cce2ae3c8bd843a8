"""Every panel's signal as a cosine of the slew angle, all solved together (Trig, direct)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.conditioning import WORST_CONDITION
from algorithms.calibration.faces_model import FEWEST_LIT, SquarePanelsModel
from algorithms.calibration.quality import Parameter
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.models.geometric.detector_faces import (
    opposite_pairs,
    require_square_pairs,
)
from algorithms.models.non_physical.regression_axes import solve_regression
from algorithms.row_arithmetic import normalise

SMALLEST_COSINE = 0.02
"""Of the angle of incidence from which on a panel counts as lit in the calibration."""


@documented
@dataclass
class TrigonometricPanels(SquarePanelsModel):
    """Each panel's signal as a cosine with amplitude, phase and offset; the Sun from lit panels.

    The fit gives sine and cosine of the slew angle, so the arc tangent has the right quadrant.
    Each panel has its own gain and mounting.

    Attributes
    ----------
    offsets_ : ndarray, shape (6,)
        Signal of each panel across the light.
    amplitudes_ : ndarray, shape (6, 3)
        Of the cosines along the sensor's x, y and z; their length is the panel's gain, their
        direction the way it looks.
    deviations_ : ndarray, shape (6, 4)
        Standard errors of offset and amplitudes; NaN for a panel that its opposite speaks for.
    quality_ : FitQuality
        Residuals, and offsets and amplitudes with standard errors by panel from 0.

    Notes
    -----
    Implements: model:trig (Richie2015, the direct relation of the scaled measurement), described
    in words: the measurements are fitted to a trigonometric function of the slew angle alike to
    their curves. A panel's is ``m = o + A cos(theta - phi) = o + a cos(theta) + b sin(theta)``;
    off the plane of the slew ``m = o + a s_x + b s_y + c s_z`` (ours), by least squares over the
    samples that light it. Of each pair the panel with the larger part counts; their three
    equations give ``A (cos(theta), sin(theta))`` and the component across, and with them ``theta =
    atan2``, no quadrant to be checked. Directions leave the solution's length alone.

    Shapes: signals (N, 6), in any common unit, to unit vectors (N, 3), all directions.

    Failure: a NaN row for a NaN feature row, where no panel shows more than its offset, and
    outside the cone. fit raises UnusableDataError where a pair is lit by fewer than eight samples
    or by some that do not determine its cosine, or where three cosines lie in one plane.

    Cost: 40 operations, 9 looked-up numbers and one root per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import face_signals
    >>> panels = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> sun = np.random.default_rng(1).normal(size=(200, 3))
    >>> sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    >>> signals = face_signals(sun, panels) * (1.0, 1.1, 0.9, 1.0, 1.2, 1.0)
    >>> np.linalg.norm(TrigonometricPanels(panels).fit(signals, sun).amplitudes_, axis=1).round(3)
    array([1. , 1.1, 0.9, 1. , 1.2, 1. ])
    """

    about: ClassVar = AboutModel(
        name="trig",
        taxonomy="Trig",
        studies=("Richie2015",),
        labels=("model:trig",),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    offsets_: Floats = field(init=False, repr=False, compare=False)
    amplitudes_: Floats = field(init=False, repr=False, compare=False)
    deviations_: Floats = field(init=False, repr=False, compare=False)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit every panel's cosine to the samples that light it."""
        del context
        by = self.about.name
        normals = require_square_pairs(self.face_normals, by)
        fitted, deviations = np.full((6, 4), np.nan), np.full((6, 4), np.nan)
        refusal: UnusableDataError | None = None
        for panel, normal in enumerate(normals):
            lit = sun @ normal > SMALLEST_COSINE
            if lit.sum() < FEWEST_LIT:
                continue
            design = np.column_stack([np.ones(int(lit.sum())), sun[lit]])
            try:
                fitted[panel] = solve_regression(design, features[lit, panel], by)
            except UnusableDataError as error:
                refusal = error
                continue
            residual = features[lit, panel] - design @ fitted[panel]
            size = residual @ residual / (len(design) - 4)
            inverse = np.linalg.inv(np.linalg.qr(design, mode="r"))
            deviations[panel] = np.sqrt(size * (inverse**2).sum(axis=1))
        for one, other in opposite_pairs(normals):
            for panel, mate in ((one, other), (other, one)):
                if np.isnan(fitted[panel, 0]):
                    fitted[panel] = fitted[mate] * (1.0, -1.0, -1.0, -1.0)
            if np.isnan(fitted[one, 0]):
                raise refusal or UnusableDataError(
                    f"{by} needs at least {FEWEST_LIT} samples that light a panel of each pair; "
                    f"panels {one} and {other} have fewer"
                )
        self.offsets_, self.amplitudes_ = fitted[:, 0].copy(), fitted[:, 1:].copy()
        self.deviations_ = deviations
        if not all(np.linalg.cond(lit) < WORST_CONDITION for lit in self._octants()):
            raise UnusableDataError(f"{by}: the fitted cosines of three panels lie in one plane")

    def fitted_parameters(self) -> tuple[Parameter, ...]:
        """Offsets and amplitudes of the panels that samples settle, in the signals' unit."""
        values = np.column_stack([self.offsets_, self.amplitudes_])
        return tuple(
            Parameter(f"{what}_{panel}", float(value), float(deviation))
            for panel in range(6)
            for what, value, deviation in zip(
                ("offset", "amplitude_x", "amplitude_y", "amplitude_z"),
                values[panel],
                self.deviations_[panel],
                strict=True,
            )
            if np.isfinite(deviation)
        )

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, 6)."""
        del context
        gains = np.sqrt((self.amplitudes_**2).sum(axis=1))
        octant = np.zeros(len(features), dtype=np.int64)
        seen, brightest = [], np.full(len(features), -np.inf)
        for bit, (one, other) in enumerate(self._pairs()):
            first = features[:, one] - self.offsets_[one]
            second = features[:, other] - self.offsets_[other]
            chosen = second / gains[other] > first / gains[one]
            octant += chosen * (1 << bit)
            seen.append(np.where(chosen, second, first))
            np.maximum(brightest, seen[-1], out=brightest)
        inverses = np.linalg.inv(self._octants())
        vectors = np.zeros((len(features), 3))
        for axis in range(3):
            for bit in range(3):
                vectors[:, axis] += inverses[octant, axis, bit] * seen[bit]
        vectors[~(brightest > 0)] = np.nan
        return normalise(vectors)

    def _pairs(self) -> tuple[tuple[int, int], ...]:
        return opposite_pairs(require_square_pairs(self.face_normals, self.about.name))

    def _octants(self) -> Floats:
        """(8, 3, 3) amplitudes of the panels lit: bit k is set where pair k's later one is."""
        return np.stack(
            [
                np.stack([self.amplitudes_[pair[octant >> k & 1]] for k, pair in enumerate(pairs)])
                for pairs in (self._pairs(),)
                for octant in range(8)
            ]
        )
