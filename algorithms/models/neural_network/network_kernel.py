"""Feed-forward networks: values, derivatives and Levenberg-Marquardt training, portable.

Only sums, products, quotients and roots, in a fixed order: the numbers are the same on every
processor, as those of the C library's exponential and of BLAS are not.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_row
from algorithms.models.neural_network.cholesky_kernel import solve

Layers = NDArray[np.int64]

LINEAR, LOG_SIGMOID, TANH = 0, 1, 2
"""How a layer answers its sums."""

_BLOCK = 64
"""Samples whose activations stay in the first cache; inner loops run along them."""
_TOGETHER = 8
"""Products are summed up in matrices of a multiple of so many columns."""
_FARTHEST = 32.0
"""Sums beyond are taken for this: both functions are flat there to 2e-14."""
_SHARE, _SQUARINGS = 1.0 / 128.0, 7
_SERIES = np.array([1.0 / factorial(term) for term in range(12, -1, -1)])
"""The exponential of a small share of a sum by its series (highest power first; to 2e-18 up to a
quarter), then squared so often."""

_BETTER = 0.999
"""Share of the best error held out below which one counts as better."""
_DAMPING, _LESS, _MORE = 1e-2, 0.1, 10.0
_LEAST, _MOST = 1e-14, 1e10
"""Damping, in units of the mean squared derivative: where it starts, how it changes, its limits."""


class _Room(NamedTuple):
    """Memory that the steps of a training share; the numbers between them are what it says.

    `units` and `held` (blocks, sum of widths, _BLOCK): answers of all units at the weights last
    tried, of the samples fitted and held out. `rows` (_BLOCK, outputs, >= C): derivatives of one
    block, sample by sample and output by output, then the errors; an odd number of cache lines
    long, so that rows do not drive each other out of the first cache. Zeros where no weight is, and
    where a weight is of another output.
    """

    units: Floats
    held: Floats
    slopes: Floats
    rows: Floats
    products: Floats
    factor: Floats


@compiled
def _respond(row: Floats, kind: int) -> None:
    """Turn sums (b,) of a unit of this kind into what it answers, in place."""
    if kind == LINEAR:
        return
    scale = 2.0 if kind == TANH else 1.0
    for i in range(len(row)):
        x = scale * row[i]
        # NaN passes both comparisons, as it would not minimum and maximum
        x = _FARTHEST if x > _FARTHEST else x  # noqa: FURB136
        x = -_FARTHEST if x < -_FARTHEST else x  # noqa: FURB136
        share = -x * _SHARE
        # spelled out: the compiler takes several samples at a time
        power = _SERIES[0] * share + _SERIES[1]
        power = (power * share + _SERIES[2]) * share + _SERIES[3]
        power = (power * share + _SERIES[4]) * share + _SERIES[5]
        power = (power * share + _SERIES[6]) * share + _SERIES[7]
        power = (power * share + _SERIES[8]) * share + _SERIES[9]
        power = (power * share + _SERIES[10]) * share + _SERIES[11]
        power = power * share + _SERIES[12]
        for _ in range(_SQUARINGS):
            power *= power
        row[i] = 1.0 + power
    np.divide(1.0, row, row)  # a quotient by itself is checked, one at a time
    for i in range(len(row)):
        row[i] = scale * row[i] - (scale - 1.0)


@compiled
def _forward(inputs: Floats, weights: Floats, widths: Layers, kinds: Layers, units: Floats) -> None:
    """Answers of all units (sum of widths, _BLOCK) of samples (b, F), the inputs' own first."""
    size = len(inputs)
    for column in range(widths[0]):
        for i in range(size):
            units[column, i] = inputs[i, column]
    before, at = 0, 0
    for layer in range(len(kinds)):
        first = before + widths[layer]
        for unit in range(widths[layer + 1]):
            row = units[first + unit, :size]  # sliced: contiguous for the compiler
            bias = weights[at + widths[layer]]
            for i in range(size):
                row[i] = bias
            for source in range(widths[layer]):
                weight = weights[at + source]
                seen = units[before + source, :size]
                for i in range(size):
                    row[i] += weight * seen[i]
            at += widths[layer] + 1
            _respond(row, kinds[layer])
        before = first


@compiled
def network_values(
    inputs: Floats, weights: Floats, widths: Layers, kinds: Layers, out: Floats
) -> None:
    """Write outputs (N, O) of a network for inputs (N, F), into `out`; NaN rows for NaN rows.

    Parameters
    ----------
    inputs : ndarray, shape (N, F)
        Scaled.
    weights : ndarray, shape (P,)
        Unit by unit, layer by layer: one weight a unit of the layer before, then the bias.
    widths : ndarray of int, shape (L + 1,)
        Units of the inputs and of every layer.
    kinds : ndarray of int, shape (L,)
        How every layer answers: `LINEAR`, `LOG_SIGMOID` or `TANH`.
    out : ndarray, shape (N, O)
        Overwritten.
    """
    everything, outputs = np.sum(widths), widths[-1]
    units = np.empty((everything, _BLOCK))
    for start in range(0, len(inputs), _BLOCK):
        size = min(_BLOCK, len(inputs) - start)
        _forward(inputs[start : start + size], weights, widths, kinds, units)
        for output in range(outputs):
            answers = units[everything - outputs + output, :size]
            copy_row(answers, out[start : start + size, output])


@compiled
def _lean(slope: Floats, answer: Floats, kind: int) -> None:
    """Multiply (b,) by how steep units of this kind are at their answers (b,)."""
    if kind == TANH:
        for i in range(len(slope)):
            slope[i] *= 1.0 - answer[i] * answer[i]
    elif kind == LOG_SIGMOID:
        for i in range(len(slope)):
            slope[i] *= answer[i] * (1.0 - answer[i])


@compiled
def _derivatives(  # noqa: PLR0917 - Numba takes no keyword-only ones
    units: Floats,
    output: int,
    weights: Floats,
    widths: Layers,
    kinds: Layers,
    slopes: Floats,
    rows: Floats,
) -> None:
    """Derive one output of samples by all weights, rows (b, P): the chain rule backwards.

    Rows keep what they hold of weights of other outputs, which is to be zero. `units` and `slopes`
    (sum of widths, _BLOCK): answers, and derivatives by what they answer.
    """
    at, before, size = len(weights), len(slopes), len(rows)
    slopes[before - widths[-1] :] = 0.0
    slopes[before - widths[-1] + output] = 1.0
    for layer in range(len(kinds) - 1, -1, -1):
        width, sources = widths[layer + 1], widths[layer]
        last_at, last = at, before
        at -= width * (sources + 1)
        before -= width
        below = before - sources
        for unit in range(width):
            slope = slopes[before + unit, :size]
            if last < len(slopes):
                slope[:] = 0.0
                for target in range(widths[layer + 2]):
                    above = slopes[last + target, :size]
                    weight = weights[last_at + target * (width + 1) + unit]
                    for i in range(len(slope)):
                        slope[i] += above[i] * weight
            elif unit != output:
                continue  # the answer does not depend on weights of another output
            _lean(slope, units[before + unit, :size], kinds[layer])
            place = at + unit * (sources + 1)
            for source in range(sources):
                seen = units[below + source, :size]
                for i in range(size):
                    rows[i, place + source] = slope[i] * seen[i]
            copy_row(slope, rows[:, place + sources])


@compiled
def network_derivatives(
    inputs: Floats, weights: Floats, widths: Layers, kinds: Layers, out: Floats
) -> None:
    """Write derivatives (N, O, P) of outputs by weights into `out`, as `network_values`."""
    everything = np.sum(widths)
    units, slopes = np.empty((everything, _BLOCK)), np.empty((everything, _BLOCK))
    out[:] = 0.0
    for start in range(0, len(inputs), _BLOCK):
        size = min(_BLOCK, len(inputs) - start)
        _forward(inputs[start : start + size], weights, widths, kinds, units)
        for output in range(widths[-1]):
            rows = out[start : start + size, output]
            _derivatives(units, output, weights, widths, kinds, slopes, rows)


@compiled
def _mean_square(  # noqa: PLR0917 - Numba takes no keyword-only ones
    inputs: Floats, wanted: Floats, weights: Floats, widths: Layers, kinds: Layers, units: Floats
) -> float:
    """Mean over samples (n, F) of squared errors, outputs added; all units' answers in `units`."""
    outputs = wanted.shape[1]
    first, total = units.shape[1] - outputs, 0.0
    for start in range(0, len(inputs), _BLOCK):
        size, block = min(_BLOCK, len(inputs) - start), units[start // _BLOCK]
        _forward(inputs[start : start + size], weights, widths, kinds, block)
        for output in range(outputs):
            for i in range(size):
                off = block[first + output, i] - wanted[start + i, output]
                total += off * off
    return total / len(inputs)


@compiled
def _add_products(products: Floats, rows: Floats, count: int) -> None:
    """Add products of the first columns of rows (count, >= C) to the upper triangle (C, C).

    Four lines at a time share what is read of four rows; they start and end (C) at multiples of
    `_TOGETHER`, so that the compiler takes several elements at a time. `count` is a multiple of 4.
    """
    wide, long = len(products), rows.shape[1]
    # all in one line: a part of that is found faster than a part of a row
    sums, numbers = products.reshape(-1), rows.reshape(-1)
    for p in range(0, wide, 4):
        left = p // _TOGETHER * _TOGETHER
        first, size = p - left, wide - left
        # sliced one by one: contiguous for the compiler
        end = (p + 1) * wide
        line, line1 = sums[end - size : end], sums[end + wide - size : end + wide]
        end += 2 * wide
        line2, line3 = sums[end - size : end], sums[end + wide - size : end + wide]
        for r in range(count // 4):
            start = 4 * r * long + left
            row, row1 = numbers[start:], numbers[start + long :]
            row2, row3 = numbers[start + 2 * long :], numbers[start + 3 * long :]
            a, b, c, d = row[first], row1[first], row2[first], row3[first]
            e, f, g, h = row[first + 1], row1[first + 1], row2[first + 1], row3[first + 1]
            i, j, k, m = row[first + 2], row1[first + 2], row2[first + 2], row3[first + 2]
            n, o, s, t = row[first + 3], row1[first + 3], row2[first + 3], row3[first + 3]
            for q in range(len(line)):
                u, v, w, x = row[q], row1[q], row2[q], row3[q]
                line[q] += a * u + b * v + c * w + d * x
                line1[q] += e * u + f * v + g * w + h * x
                line2[q] += i * u + j * v + k * w + m * x
                line3[q] += n * u + o * v + s * w + t * x


@compiled
def _normal_equations(
    wanted: Floats, weights: Floats, widths: Layers, kinds: Layers, room: _Room
) -> None:
    """Mean products (C, C; the upper triangle) of derivatives; with the errors in column P < C.

    At the weights whose answers `room.units` holds.
    """
    products, rows = room.products, room.rows
    count, outputs, everything = len(weights), wanted.shape[1], len(room.slopes)
    products[:] = 0.0
    listed = rows.reshape(-1, rows.shape[2])
    for start in range(0, len(wanted), _BLOCK):
        size, units = min(_BLOCK, len(wanted) - start), room.units[start // _BLOCK]
        for output in range(outputs):
            found = rows[:size, output]
            _derivatives(units, output, weights, widths, kinds, room.slopes, found[:, :count])
            answer = units[everything - outputs + output, :size]
            for i in range(size):
                found[i, count] = answer[i] - wanted[start + i, output]
        rows[size:] = 0.0
        _add_products(products, listed, (size * outputs + 3) // 4 * 4)
    products /= len(wanted)


@compiled
def _lower(  # noqa: PLR0917 - Numba takes no keyword-only ones
    inputs: Floats,
    wanted: Floats,
    here: Floats,
    widths: Layers,
    kinds: Layers,
    cost: float,
    damping: float,
    room: _Room,
    trial: Floats,
) -> tuple[float, float]:
    """Step from weights `here` to `trial`: its mean square error, and the damping it took.

    The error is `cost` itself where no step lowers it. `room.units` holds the answers at `here`,
    then those at `trial`.
    """
    count, products = len(here), room.products
    _normal_equations(wanted, here, widths, kinds, room)
    normal, gradient = products[:count, :count], products[:count, count].copy()
    mean = 0.0
    for p in range(count):
        mean += normal[p, p]
    mean /= count
    while damping <= _MOST:
        if solve(normal, damping * mean, gradient, room.factor, trial):
            for p in range(count):
                trial[p] = here[p] - trial[p]
            found = _mean_square(inputs, wanted, trial, widths, kinds, room.units)
            if found < cost:
                return found, damping
        damping *= _MORE
    return cost, damping


@compiled
def _make_room(count: int, fitted: int, held: int, widths: Layers) -> _Room:
    """Give memory for training `count` weights on so many samples fitted and held out."""
    everything, wide = np.sum(widths), (count // _TOGETHER + 1) * _TOGETHER
    return _Room(
        np.empty((fitted // _BLOCK + 1, everything, _BLOCK)),
        np.empty((held // _BLOCK + 1, everything, _BLOCK)),
        np.empty((everything, _BLOCK)),
        np.zeros((_BLOCK, widths[-1], (wide // _TOGETHER | 1) * _TOGETHER)),
        np.empty((wide, wide)),
        np.empty((count, count)),
    )


@compiled
def train(  # noqa: PLR0917 - Numba takes no keyword-only ones
    inputs: Floats,
    wanted: Floats,
    held_inputs: Floats,
    held_wanted: Floats,
    weights: Floats,
    widths: Layers,
    kinds: Layers,
    steps: int,
    patience: int,
    goal: float,
) -> tuple[float, float, int]:
    """Levenberg-Marquardt from `weights`, left as they were best on the samples held out.

    Parameters
    ----------
    inputs, wanted, held_inputs, held_wanted : ndarray, shapes (n, F), (n, O), (m, F) and (m, O)
        Samples that are fitted, and those that say when to stop.
    weights : ndarray, shape (P,)
        Where to start; overwritten by the best.
    widths, kinds
        As `network_values`.
    steps, patience : int
        Most steps, and those without a better error on the samples held out after which it stops.
    goal : float
        Mean square error on the samples held out that is good enough.

    Returns
    -------
    held, fitted : float
        Mean square errors of the weights left on both, outputs added.
    taken : int
        Steps to those weights.
    """
    room = _make_room(len(weights), len(inputs), len(held_inputs), widths)
    here, trial = weights.copy(), np.empty(len(weights))
    cost = _mean_square(inputs, wanted, here, widths, kinds, room.units)
    best = _mean_square(held_inputs, held_wanted, here, widths, kinds, room.held)
    fitted, taken, damping, stale = cost, 0, _DAMPING, 0
    for number in range(1, steps + 1):
        if best <= goal or stale >= patience:
            break
        found, damping = _lower(inputs, wanted, here, widths, kinds, cost, damping, room, trial)
        if not found < cost:
            break
        damping = max(damping * _LESS, _LEAST)
        copy_row(trial, here)
        cost = found
        held = _mean_square(held_inputs, held_wanted, here, widths, kinds, room.held)
        stale += 1
        if held < best:
            if held < best * _BETTER:
                stale = 0
            best, fitted, taken = held, cost, number
            copy_row(here, weights)
    return best, fitted, taken
