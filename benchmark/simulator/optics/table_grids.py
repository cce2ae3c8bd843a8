"""What tables of diffracted light are made with on their grids: slopes, the Sun, the pixel."""

from __future__ import annotations

import math

import numpy as np

from algorithms.contract import Floats

Cell = tuple[Floats, Floats]


def slopes(values: Floats, axis: int) -> Floats:
    """Return differences of fourth order a step along an axis of values even about its start.

    At its end those of a cubic.
    """
    line = np.moveaxis(values, axis, 0)
    f = np.concatenate([line[2:0:-1], line])
    out = np.empty((len(f) - 2, *f.shape[1:]))
    out[:-2] = (8.0 * (f[3:-1] - f[1:-3]) - (f[4:] - f[:-4])) / 12.0
    out[-1] = (11.0 * f[-1] - 18.0 * f[-2] + 9.0 * f[-3] - 2.0 * f[-4]) / 6.0
    out[-2] = (2.0 * f[-1] + 3.0 * f[-2] - 6.0 * f[-3] + f[-4]) / 6.0
    return np.moveaxis(out, 0, axis)


def both_sides(light: Floats, rest: Floats | None = None) -> Floats:
    """(2 S - 1, S) of quadrants: light the same on both sides along, the rest opposite."""
    rest = np.zeros(light.shape) if rest is None else rest
    return np.concatenate([(light - rest)[:0:-1], light + rest])


def spread(
    light: Floats, shifts: Floats, weights: Floats, margin: int, cell: Cell | None = None
) -> Floats:
    """(2 n + 1, n + 1) means of light, a `margin` wider all around, moved by (K, 2) steps.

    Light is even across its second axis, and is known on one side of it. Every shift has all of
    the places of a `cell`, (C, 2) steps and (C,) weights.
    """
    from scipy.fft import irfft2, next_fast_len, rfft2  # noqa: PLC0415 - SciPy on demand

    from benchmark.simulator.kernels.diffraction_patterns import stencil  # noqa: PLC0415 - Numba

    places = (np.zeros((1, 2)), np.ones(1)) if cell is None else cell
    weight = stencil(np.ascontiguousarray(shifts), weights, places, margin)
    both = np.concatenate([light[:, margin:0:-1], light], axis=1)
    # whole as long as no sum goes round the ends
    size = tuple(next_fast_len(n, real=True) for n in both.shape)
    product = rfft2(both, size) * rfft2(weight[::-1, ::-1], size)
    whole = irfft2(product, size)
    return np.asarray(whole[2 * margin : both.shape[0], 2 * margin : both.shape[1]])


def turned_cell(side: int) -> tuple[Floats, Floats]:
    """(K, 2) places in a square of side 1 about its middle, turned all ways, and (K,) weights.

    The mean over all ways to turn a square leaves out what changes four times a turn: for a wave
    of k radians a side ``k^4 / 11520`` of it at most. Gauss's rule of `side` nodes; eight turns of
    an eighth of a right angle leave out what changes 32 times a turn.
    """
    nodes, weights = np.polynomial.legendre.leggauss(side)
    x, y = np.repeat(nodes / 2.0, side), np.tile(nodes / 2.0, side)
    places = []
    for turn in range(8):
        angle = math.pi / 2.0 * (turn + 0.5) / 8.0
        c, s = math.cos(angle), math.sin(angle)
        places.append(np.column_stack([c * x - s * y, s * x + c * y]))
    shares = np.outer(weights, weights).ravel() / 4.0
    return np.concatenate(places), np.tile(shares / 8.0, 8)
