"""One network with one hidden layer for each Sun angle (ANN)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.quality import Setting
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.models.neural_network.training import (
    Network,
    Training,
    hold_out,
    on_grid,
    require_training,
    train_network,
)
from algorithms.models.nominal_projection import POSITIONS
from algorithms.models.non_physical.regression_axes import feature_scaling, sun_from_target

_LAYERS = (1, 0)  # log-sigmoid, then linear
_STEPS = 400


@documented
@dataclass
class AxisNetworks(CalibratedModel):
    """Each Sun angle by its own network of sigmoid units with both features as inputs.

    The method needs no sensor model; it learns distortion, tilt and other deviations from the
    drawing as far as the poses show them.

    Parameters
    ----------
    hidden : int
        Sigmoid units of each network, 1 to 40.

    Attributes
    ----------
    reach_deg_ : ndarray, shape (2,)
        Largest calibrated ``alpha`` and ``beta``: what an output of one means.
    networks_ : tuple of two Network
        Of ``alpha`` and of ``beta``.
    held_deg_ : float
        Error on the samples held out, of both angles together.
    steps_ : tuple of two int
        Steps of training to the networks kept.

    Notes
    -----
    Implements: model:ann (model:nn, Rufino2009b), described in words: ``alpha = v_0 + sum_j v_j /
    (1 + exp(-(w_j . (x, y) + b_j)))`` and the same for beta, each with weights of its own. The
    study's inputs are the mean centroid of the spots that its mask casts, always as many (S-FOV) or
    as many as are seen (X-FOV); here features are the displacement of the whole pattern, whatever
    was seen of it, so that no input jumps where a spot drops out, and both modes are one network
    that was shown other poses. The study's number of units is not known; our default is twelve.
    Trained by Levenberg and Marquardt's method on four fifths of the poses until the error on the
    other fifth, in blocks, no longer falls.

    Failure: a NaN row for a NaN feature row, outside the hull, or where an angle reaches 90
    degrees. fit raises UnusableDataError for fewer poses than a network has weights, 49 for twelve
    units, or where they lie on one line.

    Cost: 40 operations per unit and sample. A fit takes some 0.1 ms a pose and start.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-30, 31, 5))
    >>> spots = 200.0 * sun[:, :2] / sun[:, 2:] + (100.0, 80.0)
    >>> model = AxisNetworks().fit(spots, sun)
    >>> angles_from_sun(model.predict([spots[0], [900.0, 80.0]])).round(2)
    array([[-30., -30.],
           [ nan,  nan]])
    """

    about: ClassVar = AboutModel(
        name="ann",
        taxonomy="ANN",
        studies=("Rufino2009b",),
        labels=("model:nn", "model:ann"),
        origin="survey",
        accepts=POSITIONS,
    )

    hidden: int = 12
    restarts: int = 3
    seed: int = 0

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    reach_deg_: Floats = field(init=False, repr=False, compare=False)
    networks_: tuple[Network, ...] = field(init=False, repr=False, compare=False)
    held_deg_: float = field(init=False, repr=False, compare=False)
    steps_: tuple[int, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_training(self.about.name, self.hidden, self.restarts, self.seed)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Train both networks on samples (n, 2) of Suns (n, 3)."""
        from algorithms.models.neural_network.portable_kernel import angles_deg  # noqa: PLC0415 - Numba

        del context
        by = self.about.name
        features, sun = on_grid(features, sun)
        self.middle_, self.half_range_ = feature_scaling(features, by)
        inputs, held = self._scaled(features), hold_out(sun)
        self.reach_deg_ = np.empty(2)
        networks, steps, square = [], [], 0.0
        for axis, component in enumerate((1, 0)):  # alpha goes with y, beta with x
            angle = np.empty(len(sun))
            angles_deg(sun[:, component] / sun[:, 2], angle)
            reach = max(float(np.abs(angle).max()), 1e-9)
            widths = 2, self.hidden, 1
            training = Training(widths, _LAYERS, self.restarts, self.seed, steps=_STEPS)
            found = train_network(inputs, (angle / reach)[:, None], held, training, by)
            self.reach_deg_[axis] = reach
            networks.append(found.network)
            steps.append(found.steps)
            square += (reach * found.held) ** 2
        self.networks_, self.steps_ = tuple(networks), tuple(steps)
        self.held_deg_ = float(np.sqrt(square))

    def settings(self) -> Mapping[str, Setting]:
        """Give the units, and the steps at which the held-out error was least."""
        alpha, beta = self.steps_
        return {"hidden": self.hidden, "steps_alpha": alpha, "steps_beta": beta}

    def validation_rms_deg(self) -> float:
        """Error on the samples held out."""
        return self.held_deg_

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        del context
        inputs = self._scaled(features)
        values = np.empty((len(features), 2), order="F")
        for axis, network in enumerate(self.networks_):
            np.multiply(network.values(inputs)[:, 0], self.reach_deg_[axis], out=values[:, axis])
        return sun_from_target(values, "angle")

    def _scaled(self, features: Floats) -> Floats:
        return np.asarray((features - self.middle_) / self.half_range_)
