"""One averaged curve a pair of opposite panels, inverted for the angle of incidence (Trig)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
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
from algorithms.models.non_physical.trigonometric import SMALLEST_COSINE
from algorithms.row_arithmetic import normalise


@documented
@dataclass
class AveragedPanelCurves(SquarePanelsModel):
    """One trigonometric curve for both panels of a pair; the lit panel gives angle and sign.

    Averaging opposite panels leaves only three curves to invert, but does not correct differences
    between panels. The lit panels determine the quadrant of the angle.

    Attributes
    ----------
    curves_ : ndarray, shape (3, 3)
        Level and the amplitudes of the cosines of the angle of incidence and of twice it, pair by
        pair in the order of their earlier panels, in the signals' unit.
    deviations_ : ndarray, shape (3, 3)
        Their standard errors.
    quality_ : FitQuality
        Residuals, and the nine with their standard errors by pair from 0.

    Notes
    -----
    Implements: model:trig (Richie2015, averaged combined panel curves), described in words: the
    scaled measurements of opposite panels, merged, are fitted with ``m = a + b cos(theta) + c
    cos(2 theta)``, theta the angle of incidence, over the samples that light them. Along each pair
    the brighter panel is the lit one; its curve's inverse is ``cos(theta)``, with the panel's sign
    a component of the Sun vector. In the plane of a slew two of them are the four estimates of its
    angle, arc cosines and arc sines, of which the lit sides leave one each; the vector's direction
    is what they agree on, weighted (ours, for Suns off the plane too).

    Shapes: signals (N, 6), in any common unit, to unit vectors (N, 3), all directions.

    Failure: a NaN row for a NaN feature row, where no panel shows more than its curve at grazing
    light, past a curve's turning point, and outside the cone. fit raises UnusableDataError where a
    pair is lit by fewer than eight samples or by some that do not determine its curve, or where a
    curve turns back among them.

    Cost: 30 operations and 4 roots per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import face_signals
    >>> panels = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> sun = np.random.default_rng(1).normal(size=(200, 3))
    >>> sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    >>> cosines = face_signals(sun, panels)
    >>> AveragedPanelCurves(panels).fit(0.9 * cosines + 0.1 * cosines**2, sun).curves_[0].round(3)
    array([0.05, 0.9 , 0.05])
    """

    about: ClassVar = AboutModel(
        name="trig-averaged",
        taxonomy="Trig",
        studies=("Richie2015",),
        labels=("model:trig",),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    curves_: Floats = field(init=False, repr=False, compare=False)
    deviations_: Floats = field(init=False, repr=False, compare=False)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit a curve a pair to the samples that light one of its panels."""
        del context
        by = self.about.name
        normals = require_square_pairs(self.face_normals, by)
        self.curves_, self.deviations_ = np.empty((3, 3)), np.empty((3, 3))
        for pair, panels in enumerate(opposite_pairs(normals)):
            cosines = np.concatenate([sun @ normals[panel] for panel in panels])
            lit = cosines > SMALLEST_COSINE
            count = int(lit.sum())
            if count < FEWEST_LIT:
                raise UnusableDataError(
                    f"{by} needs at least {FEWEST_LIT} samples that light a panel of each pair; "
                    f"got {count} for panels {panels[0]} and {panels[1]}"
                )
            x = cosines[lit]
            design = np.column_stack([np.ones(count), x, 2.0 * x * x - 1.0])
            wanted = np.concatenate([features[:, panel] for panel in panels])[lit]
            curve = solve_regression(design, wanted, by)
            rises = curve[1] + 4.0 * curve[2] * np.array([x.min(), x.max()])
            if not (rises > 0).all():
                raise UnusableDataError(
                    f"{by}: the fitted curve of panels {panels[0]} and {panels[1]} turns back "
                    "within the calibrated range, so that one signal stands for two angles"
                )
            residual = wanted - design @ curve
            inverse = np.linalg.inv(np.linalg.qr(design, mode="r"))
            size = residual @ residual / (count - 3)
            self.curves_[pair] = curve
            self.deviations_[pair] = np.sqrt(size * (inverse**2).sum(axis=1))

    def fitted_parameters(self) -> tuple[Parameter, ...]:
        """Levels and amplitudes, in the signals' unit."""
        return tuple(
            Parameter(f"{what}_{pair}", float(value), float(deviation))
            for pair in range(3)
            for what, value, deviation in zip(
                ("level", "cosine", "double"),
                self.curves_[pair],
                self.deviations_[pair],
                strict=True,
            )
        )

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, 6)."""
        del context
        normals = require_square_pairs(self.face_normals, self.about.name)
        vectors = np.zeros((len(features), 3))
        brightest = np.full(len(features), -np.inf)
        for (one, other), (level, single, double) in zip(
            opposite_pairs(normals), self.curves_, strict=True
        ):
            later = features[:, other] > features[:, one]
            above = np.where(later, features[:, other], features[:, one]) - (level - double)
            np.maximum(brightest, above, out=brightest)
            # a root of 2 c x^2 + b x = m - (a - c), the one that rises
            square = single * single + 8.0 * double * above
            square[~(square >= 0)] = np.nan
            if single > 0:
                cosine = 2.0 * above / (single + np.sqrt(square))
            else:  # it rises only past its lowest point, for which it must bend upwards
                cosine = (np.sqrt(square) - single) / (4.0 * double)
            component = np.where(later, -cosine, cosine)
            for axis in range(3):
                vectors[:, axis] += normals[one, axis] * component
        vectors[~(brightest > 0)] = np.nan
        return normalise(vectors)
