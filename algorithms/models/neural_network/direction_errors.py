"""What a network adds to a direction that another way has found: errors, and their undoing."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.quality import Setting
from algorithms.contract import Floats, UnusableDataError
from algorithms.models.neural_network.training import (
    Network,
    Trained,
    Training,
    hold_out,
    train_network,
)
from algorithms.row_arithmetic import normalise

#: Added to the diagonal of normal equations, as a share of its mean: an element that no sample
#: lights has no part.
_RIDGE = 1e-10
#: Errors, in radians, below which there is nothing to learn, and the share of the largest that
#: need not be learnt.
_NOTHING, _GOAL = 1e-6, 1e-5


@dataclass(frozen=True)
class Correction:
    """A network whose outputs, times their scale, are the errors of directions.

    Parameters
    ----------
    network : Network
        With two outputs, tangents of the errors along two axes across the direction, or with
        three, components of the vector to be added.
    scale : float
        What an output of one means.
    held_deg : float
        Error on the samples held out.
    steps : int
        Of training; 0 where there was nothing to correct.
    """

    network: Network
    scale: float
    held_deg: float
    steps: int

    def correct(self, base: Floats, inputs: Floats) -> Floats:
        """Give unit vectors (N, 3) of directions (N, 3) and the network's inputs (N, F)."""
        errors = self.network.values(inputs) * self.scale
        if errors.shape[1] == base.shape[1]:
            return normalise(base + errors)
        first, second = across_from_boresight(base)
        return normalise(base + errors[:, :1] * first + errors[:, 1:] * second)


class Corrected:
    """What models share that correct directions `_base` by a network: mixed into a model.

    Parameters
    ----------
    hidden : int
        Units of each of the two hidden layers, 1 to 40.

    Attributes
    ----------
    correction_ : Correction
        The network, with its error on the samples held out.
    """

    hidden: int
    restarts: int
    seed: int
    middle_: Floats
    half_range_: Floats
    correction_: Correction

    def settings(self) -> Mapping[str, Setting]:
        """Give the units, and the steps at which the held-out error was least."""
        return {"hidden": self.hidden, "steps": self.correction_.steps}

    def validation_rms_deg(self) -> float:
        """Error on the samples held out."""
        return self.correction_.held_deg

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, F)."""
        del context
        inputs = self._scaled(features)
        return self.correction_.correct(self._base(inputs), inputs)

    def _train(self, by: str, inputs: Floats, sun: Floats) -> None:
        """Learn the correction of `_base`, of scaled features (n, F) and Suns (n, 3)."""
        self.correction_ = learn_correction(
            self._base(inputs),
            inputs,
            sun,
            hidden=self.hidden,
            restarts=self.restarts,
            seed=self.seed,
            by=by,
        )

    @abstractmethod
    def _base(self, inputs: Floats) -> Floats:
        """Directions (N, 3) before they are corrected."""
        ...

    def _scaled(self, features: Floats) -> Floats:
        return np.asarray((features - self.middle_) / self.half_range_)


def across_from_boresight(directions: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors (N, 3) across each direction: x and y turned with +z, the shortest way.

    Smooth everywhere but behind the sensor, at -z, where they are not defined.

    Parameters
    ----------
    directions : ndarray, shape (N, 3)
        Unit vectors.

    Examples
    --------
    >>> first, second = across_from_boresight(np.array([[0.0, 0.6, 0.8]]))
    >>> first + 0.0, second + 0.0
    (array([[1., 0., 0.]]), array([[ 0. ,  0.8, -0.6]]))
    """
    x, y, z = directions.T
    with np.errstate(divide="ignore", invalid="ignore"):
        share = 1.0 / (1.0 + z)
    first = np.column_stack([1.0 - x * x * share, -x * y * share, -x])
    second = np.column_stack([-x * y * share, 1.0 - y * y * share, -y])
    return first, second


def errors_of(base: Floats, sun: Floats, *, frontal: bool) -> Floats:
    """Errors (n, 2) of directions (n, 3), or (n, 3) where Suns are behind the sensor too.

    Parameters
    ----------
    base, sun : ndarray, shape (n, 3)
        Unit vectors, found and true.
    frontal : bool
        Whether every Sun is in front of the sensor: then tangents of the errors along the two axes
        of `across_from_boresight`, NaN where they reach 90 degrees; else ``sun - base``.
    """
    if not frontal:
        return np.asarray(sun - base)
    along = _dot(base, sun)
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = [_dot(axis, sun) / along for axis in across_from_boresight(base)]
    found = np.column_stack(errors)
    found[~(along > 0.0)] = np.nan
    return found


def learn_correction(
    base: Floats,
    inputs: Floats,
    sun: Floats,
    *,
    hidden: int,
    restarts: int,
    seed: int,
    by: str,
) -> Correction:
    """Train a network on the errors of directions that another way has found.

    Layers as Soken2023: as many log-sigmoid units as inputs, two layers of `hidden` hyperbolic
    tangents, linear outputs.

    Parameters
    ----------
    base : ndarray, shape (n, 3)
        Unit vectors found; rows that are NaN are left out.
    inputs : ndarray, shape (n, F)
        Scaled to [-1, 1].
    sun : ndarray, shape (n, 3)
        Unit vectors, true.
    hidden : int
        Units of either hidden layer.
    restarts, seed : int
        Starts, and the seed of their weights.
    by : str
        Whose it is, for the message.

    Raises
    ------
    UnusableDataError
        If the samples are too few for the weights.
    """
    wanted = errors_of(base, sun, frontal=bool((sun[:, 2] > 0).all()))
    usable = np.isfinite(wanted).all(axis=1)
    if not usable.any():
        raise UnusableDataError(f"{by}: no sample has a direction that is about right")
    wanted = wanted[usable]
    scale = float(np.abs(wanted).max())
    count, outputs = inputs.shape[1], wanted.shape[1]
    held = hold_out(sun)
    training = Training(
        (count, count, hidden, hidden, outputs), (1, 2, 2, 0), restarts, seed, goal=_GOAL
    )
    if scale < _NOTHING:
        silent = Network(
            np.zeros(training.count), np.array(training.widths), np.array(training.kinds)
        )
        return Correction(silent, 1.0, float(np.degrees(scale)), 0)
    found: Trained = train_network(inputs[usable], wanted / scale, held[usable], training, by)
    held_deg = float(np.degrees(scale * found.held))
    return Correction(found.network, scale, held_deg, found.steps)


def least_squares(design: Floats, wanted: Floats, by: str) -> Floats:
    """Coefficients (P, T) of a design (n, P) for columns (n, T), the same on every processor.

    Raises
    ------
    UnusableDataError
        If the samples do not determine them.
    """
    from algorithms.models.neural_network.cholesky_kernel import solve  # noqa: PLC0415 - Numba
    from algorithms.models.neural_network.portable_kernel import products  # noqa: PLC0415 - Numba

    terms = design.shape[1]
    normal, factor = np.empty((terms, terms)), np.empty((terms, terms))
    right, found = np.empty(terms), np.empty((terms, wanted.shape[1]))
    contiguous = np.ascontiguousarray(design)
    for number in range(wanted.shape[1]):
        products(contiguous, np.ascontiguousarray(wanted[:, number]), normal, right)
        added = _RIDGE * float(np.diag(normal).mean())
        column = np.empty(terms)
        if not solve(normal, added, right, factor, column):
            raise UnusableDataError(f"{by}: the calibration samples do not settle {terms} terms")
        found[:, number] = column
    return found


def combine(columns: list[Floats], coefficients: Floats) -> Floats:
    """Add up columns (N,) times their coefficients (P, T) to (N, T), one by one.

    A matrix product rounds a sample differently in batches of another size.
    """
    found = np.zeros((len(columns[0]), coefficients.shape[1]), order="F")
    for column, shares in zip(columns, coefficients, strict=True):
        for number, share in enumerate(shares):
            found[:, number] += share * column
    return found


def _dot(first: Floats, second: Floats) -> Floats:
    x, y, z = (a * b for a, b in zip(first.T, second.T, strict=True))
    return np.asarray(x + y + z)
