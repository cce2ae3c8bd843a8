"""Networks as fitted attributes, and how they are trained: seeded starts, stopped early."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.blocks import folds
from algorithms.contract import Floats, UnusableDataError
from algorithms.inputs import require_samples
from algorithms.row_arithmetic import normalise

TRIAL_STEPS = 30
"""Steps of every start, after which only the best goes on."""

STEPS = 200
"""Most further steps of that one."""

PATIENCE = 60
"""Steps without a better error on the samples held out after which it ends."""

#: Of the outputs' weights where a training starts, beside those of other layers.
_SMALL = 0.1
#: In a first layer of as many units as inputs: of its own input, of what is drawn; and of the next
#: layer's weights, since sigmoids vary by half as much as hyperbolic tangents.
_OWN, _OTHERS, _OF_SIGMOIDS = 3.0, 0.2, 2.0
#: Fold whose samples are held out.
_HELD = 0
#: Steps of the grid that training data are rounded to: a column's range, or a unit, has so many.
_GRID = 2.0**22


@dataclass(frozen=True)
class Network:
    """A feed-forward network with its weights.

    Parameters
    ----------
    weights : ndarray, shape (P,)
        Unit by unit, layer by layer: one a unit of the layer before, then the bias.
    widths : ndarray of int, shape (L + 1,)
        Units of the inputs and of every layer.
    kinds : ndarray of int, shape (L,)
        How every layer answers: 0 linear, 1 log-sigmoid, 2 hyperbolic tangent.

    Examples
    --------
    >>> line = Network(np.array([2.0, 1.0]), np.array([1, 1]), np.array([0]))
    >>> line.values(np.array([[3.0], [0.5]]))
    array([[7.],
           [2.]])
    """

    weights: Floats
    widths: NDArray[np.int64]
    kinds: NDArray[np.int64]

    def values(self, inputs: Floats) -> Floats:
        """Give outputs (N, O) of inputs (N, F), row by row; a NaN row where an input is NaN."""
        from algorithms.models.neural_network.network_kernel import network_values  # noqa: PLC0415 - Numba

        out = np.empty((len(inputs), int(self.widths[-1])))
        network_values(np.ascontiguousarray(inputs), self.weights, self.widths, self.kinds, out)
        return out


@dataclass(frozen=True)
class Training:
    """How a network is trained.

    Parameters
    ----------
    widths, kinds : tuple of int
        As `Network` has them.
    restarts : int
        Starts from other weights, of which the best on the samples held out goes on.
    seed : int
        Of the weights they start from.
    steps, patience : int
        Most further steps of that one, and how many without a better error on the samples held
        out end it.
    goal : float
        Root mean square error on the samples held out that is good enough.
    """

    widths: tuple[int, ...]
    kinds: tuple[int, ...]
    restarts: int
    seed: int
    steps: int = STEPS
    patience: int = PATIENCE
    goal: float = 1e-7

    @property
    def count(self) -> int:
        """Weights."""
        pairs = zip(self.widths[:-1], self.widths[1:], strict=True)
        return sum((before + 1) * after for before, after in pairs)

    def start(self, number: int) -> Floats:
        """Weights (P,) of one start: uniform, a unit's sum about one for inputs in [-1, 1].

        Those of the outputs are a tenth of that, so that a network starts near zero. A first layer
        of as many units as inputs starts with hardly more than its own input in each: of two units
        drawn at random, often both see the same. Drawn and scaled without a logarithm or a sine:
        the same on every processor.
        """
        draw = np.random.default_rng([self.seed, number])
        found = []
        for before, after in zip(self.widths[:-1], self.widths[1:], strict=True):
            drawn = draw.uniform(-1.0, 1.0, (after, before + 1))
            drawn[:, :before] *= np.sqrt(3.0 / before)
            found.append(drawn.ravel())
        found[-1] *= _SMALL
        inputs, first = self.widths[:2]
        if inputs == first and len(found) > 1:
            own = np.column_stack([_OWN * np.eye(inputs), np.zeros(inputs)])
            found[0] = _OTHERS * found[0] + own.ravel()
            found[1] *= _OF_SIGMOIDS
        return np.concatenate(found)


@dataclass(frozen=True)
class Trained:
    """A network, and what is known of it.

    Attributes
    ----------
    network : Network
        The best.
    held : float
        Root mean square error on the samples held out, outputs added; it chose the network.
    fitted : float
        The same on the samples fitted.
    steps : int
        That led to it.
    """

    network: Network
    held: float
    fitted: float
    steps: int


def on_grid(features: Floats, sun: Floats) -> tuple[Floats, Floats]:
    """Round training data to a grid of 2**-22 of each column's range, and of unit vectors.

    Training amplifies any difference until it shows. What it is given must therefore be the same
    bits where other sums of the same readings differ by a rounding; the grid is far finer than
    noise. Its steps are powers of two, so that they do not change with a rounding either.

    Parameters
    ----------
    features : ndarray, shape (n, F)
        Finite.
    sun : ndarray, shape (n, 3)
        Unit vectors.

    Examples
    --------
    >>> features, sun = on_grid(np.array([[0.1], [0.9]]), np.eye(3)[:2])
    >>> bool((features == on_grid(features * (1 + 1e-15), sun)[0]).all())
    True
    """
    spread = features.max(axis=0) - features.min(axis=0)
    # half way between powers of two for a spread that is one: counts often are
    power = np.floor(np.log2(np.where(spread > 0, spread, 1.0) * np.sqrt(2.0)))
    step = np.ldexp(1.0 / _GRID, power.astype(np.int64))
    return np.round(features / step) * step, normalise(np.round(sun * _GRID) / _GRID)


def hold_out(sun: Floats) -> NDArray[np.bool_]:
    """Which calibration samples (n,) tell a training when to stop: every fifth block of poses.

    None on the rim, which all fits keep, and repeats of a pose together.
    """
    return np.asarray(folds(sun) == _HELD)


def train_network(
    inputs: Floats, wanted: Floats, held: NDArray[np.bool_], training: Training, by: str
) -> Trained:
    """Train a network on what is not held out; of all starts the best on what is.

    Parameters
    ----------
    inputs : ndarray, shape (n, F)
        Scaled to about [-1, 1].
    wanted : ndarray, shape (n, O)
        Scaled to about 1.
    held : ndarray of bool, shape (n,)
        Samples that are not fitted.
    training : Training
        How.
    by : str
        Whose it is, for the message.

    Raises
    ------
    UnusableDataError
        If there are fewer samples to fit than weights an output, or none to hold out.
    """
    from algorithms.models.neural_network.network_kernel import train  # noqa: PLC0415 - Numba

    count, outputs = training.count, wanted.shape[1]
    needed = -(-count // outputs)
    require_samples(int((~held).sum()), needed, by, f"{count} weights of {outputs} outputs")
    if not held.any():
        raise UnusableDataError(f"{by} needs samples of more poses, to hold some out of the fit")
    widths, kinds = (np.array(v, dtype=np.int64) for v in (training.widths, training.kinds))
    parts = (
        np.ascontiguousarray(inputs[~held]),
        np.ascontiguousarray(wanted[~held]),
        np.ascontiguousarray(inputs[held]),
        np.ascontiguousarray(wanted[held]),
    )
    best: tuple[Floats, tuple[float, float, int]] | None = None
    for number in range(training.restarts):
        weights = training.start(number)
        limits = min(TRIAL_STEPS, training.steps), TRIAL_STEPS, training.goal**2
        found = train(*parts, weights, widths, kinds, *limits)
        if best is None or found[0] < best[1][0]:
            best = weights, found
    if best is None or not np.isfinite(best[1][0]):
        raise UnusableDataError(f"{by}: no start of the training gave finite errors")
    weights, (_, _, before) = best
    square_held, square, steps = train(
        *parts, weights, widths, kinds, training.steps, training.patience, training.goal**2
    )
    network = Network(weights, widths, kinds)
    return Trained(network, float(np.sqrt(square_held)), float(np.sqrt(square)), before + steps)


def require_training(by: str, units: int, restarts: int, seed: int) -> None:
    """Raise ValueError unless there are hidden units and starts, and the seed is not negative."""
    if not 1 <= units <= MOST_UNITS:
        raise ValueError(f"{by}: hidden must be from 1 to {MOST_UNITS}; got {units!r}")
    if not 1 <= restarts <= MOST_RESTARTS:
        raise ValueError(f"{by}: restarts must be from 1 to {MOST_RESTARTS}; got {restarts!r}")
    if not seed >= 0:
        raise ValueError(f"{by}: seed must not be negative; got {seed!r}")


MOST_UNITS = 40
"""Most units of a hidden layer; more than some hundred poses settle."""

MOST_RESTARTS = 50
