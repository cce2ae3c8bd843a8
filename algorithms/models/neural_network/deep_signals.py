"""A deep network that corrects the direction that a few detectors' signals give (DNN)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.faces_model import SignalsModel
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.models.neural_network.direction_errors import (
    Corrected,
    Correction,
    combine,
    least_squares,
)
from algorithms.models.neural_network.training import on_grid, require_training
from algorithms.row_arithmetic import normalise


@documented
@dataclass
class DeepSignals(Corrected, SignalsModel):
    """Sun direction linear in all signals, corrected by a deep network.

    The network learns the error of the direction as a function of the signals: errors due to
    albedo, to responses that differ from the cosine, and to unlit faces. It needs no model of these
    effects, only samples that contain them.

    Attributes
    ----------
    middle_, half_range_ : ndarray, shape (K,)
        The signals' scaling ``u = (signal - middle) / half_range`` onto [-1, 1]; a signal that
        never changed is left alone.
    coefficients_ : ndarray, shape (K + 1, 3)
        Of one and of each scaled signal in s_x, s_y and s_z, before they are brought to length one.

    Notes
    -----
    Implements: model:dnn (model:nn, Soken2023), described in words: a network of the photodiodes'
    voltages gives the errors of the two Sun angles, trained on attitudes known from elsewhere in
    orbit or on the ground. Its layers are the study's, 4-n-n-2: units as many as voltages with a
    log-sigmoid, two layers of hyperbolic tangents, linear outputs. n is not known from the study;
    eight is ours. So is the direction that is corrected, linear in the signals by least squares,
    where the study's is its sensor's own. Errors are tangents along two axes across the direction;
    of a sensor that was calibrated with Suns behind it too, the three components of the vector to
    be added, for no two axes are smooth on a whole sphere. Signals are not normalised, because
    their sum shows light other than the Sun's. Trained by Levenberg and Marquardt's method on four
    fifths of the poses until the error on the other fifth, in blocks, no longer falls.

    Failure: a NaN row for a NaN feature row, and outside the cone. Effects that are absent in the
    calibration, such as albedo in a calibration on the ground, are corrected wrongly. Faces that
    all see Sun and Earth measure little but their sum: if the same sum fits several positions of
    the Earth, as on a tumbling satellite, no network can resolve it. fit raises UnusableDataError
    for fewer samples than the network has weights an output, 75 of four signals.
    UnsuitableDesignError for more than eight detectors.

    Cost: 1200 operations per sample for four signals. A fit takes some 10 ms per sample and start.

    Examples
    --------
    >>> import numpy as np
    >>> normals = np.array([[0.6, 0, 0.8], [-0.6, 0, 0.8], [0, 0.6, 0.8], [0, -0.6, 0.8]])
    >>> sun = np.random.default_rng(1).uniform((-0.5, -0.5, 1), (0.5, 0.5, 1), (300, 3))
    >>> sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    >>> signals = (sun @ normals.T) ** 1.3
    >>> model = DeepSignals(signals=4).fit(signals, sun)
    >>> model.predict((np.array([[0.28, 0.0, 0.96]]) @ normals.T) ** 1.3)[:, ::2].round(2)
    array([[0.28, 0.96]])
    """

    about: ClassVar = AboutModel(
        name="dnn",
        taxonomy="DNN",
        studies=("Soken2023",),
        labels=("model:nn", "model:dnn"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    hidden: int = 8
    restarts: int = 3
    seed: int = 0

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)
    correction_: Correction = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_training(self.about.name, self.hidden, self.restarts, self.seed)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the direction, then train on what it leaves, samples (n, K) of Suns (n, 3)."""
        del context
        by = self.about.name
        features, sun = on_grid(features, sun)
        low, high = features.min(axis=0), features.max(axis=0)
        half = (high - low) / 2.0
        if not (half > 0).any():
            raise UnusableDataError(f"{by} needs samples in which a signal changes; got none")
        self.middle_, self.half_range_ = (low + high) / 2.0, np.where(half > 0, half, 1.0)
        inputs = self._scaled(features)
        design = np.column_stack([np.ones(len(inputs)), inputs])
        self.coefficients_ = least_squares(design, sun, by)
        self._train(by, inputs, sun)

    def _base(self, inputs: Floats) -> Floats:
        """Directions (N, 3) before they are corrected."""
        columns = [np.ones(len(inputs)), *inputs.T]
        return normalise(combine(columns, self.coefficients_))
