"""A flight table as one Python module that needs NumPy alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from api.calibrate.flight.channels import ChannelTable
from api.calibrate.flight.table import FlightTable


def python_module(table: FlightTable, said: Mapping[str, str]) -> str:
    """Return the text of a module with ``sun(x, y)``, the same table as the C code reads."""
    comment = "\n".join(f"{key}: {value}" for key, value in said.items()).replace('"""', "'''")
    return _MODULE.format(
        said=comment,
        low=table.low,
        step=table.step,
        nodes=[[[float(v) for v in node] for node in row] for row in table.nodes],
        sides=[[float(v) for v in side] for side in table.sides],
    )


def channels_module(table: ChannelTable, said: Mapping[str, str]) -> str:
    """Return the text of a module with ``sun(signals)``, the same numbers as the C code reads."""
    comment = "\n".join(f"{key}: {value}" for key, value in said.items()).replace('"""', "'''")
    return _CHANNELS.format(
        said=comment,
        first=table.first.tolist(),
        squared=table.squared,
        coefficients=table.coefficients.tolist(),
        expected=table.expected.tolist(),
        tolerance=np.where(table.used, table.tolerance, -1.0).tolist(),
        reach=(table.weakest, table.strongest),
    )


_CHANNELS = '''"""Sun direction of a calibrated Sun sensor. Written by sunatlas calibrate.

{said}
"""

from itertools import combinations_with_replacement

import numpy as np

FIRST = np.array({first})
SQUARED = {squared}
COEFFICIENTS = np.array({coefficients})
EXPECTED = np.array({expected})
TOLERANCE = np.array({tolerance})
WEAKEST, STRONGEST = {reach}


def sun(signals):
    """Unit vectors (N, 3) to the Sun of signals (N, n); NaN outside what was measured."""
    signals = np.atleast_2d(np.asarray(signals, dtype=float))
    finite = np.isfinite(signals).all(axis=1)
    signals = np.nan_to_num(signals)
    length = np.linalg.norm(signals, axis=1)
    unit = signals / np.maximum(length, 1e-300)[:, None]
    octant = (unit @ FIRST.T >= 0.0) @ np.array([1, 2, 4])
    terms = [np.ones(len(unit)), *unit.T]
    if SQUARED:
        pairs = combinations_with_replacement(range(unit.shape[1]), 2)
        terms += [unit[:, i] * unit[:, j] for i, j in pairs]
    found = np.einsum("nt,ntk->nk", np.column_stack(terms), COEFFICIENTS[octant])
    found /= np.maximum(np.linalg.norm(found, axis=1), 1e-300)[:, None]
    of = EXPECTED[octant]
    away = unit - of[:, :, 0] - np.einsum("nik,nk->ni", of[:, :, 1:], found)
    known = finite & (length >= WEAKEST) & (length <= STRONGEST)
    known &= np.linalg.norm(away, axis=1) <= TOLERANCE[octant]
    found[~known] = np.nan
    return found
'''

_MODULE = '''"""Sun direction of a calibrated Sun sensor. Written by sunatlas calibrate.

{said}
"""

import numpy as np

LOW = {low}
STEP = {step}
NODES = np.array({nodes})
SIDES = np.array({sides})


def _weights(t):
    return np.stack(
        [
            ((-0.5 * t + 1.0) * t - 0.5) * t,
            (1.5 * t - 2.5) * t * t + 1.0,
            ((-1.5 * t + 2.0) * t + 0.5) * t,
            (0.5 * t - 0.5) * t * t,
        ]
    )


def sun(x, y):
    """Unit vectors (N, 3) to the Sun of readings x (N,) and y (N,); NaN outside the hull."""
    place = np.stack([np.atleast_1d(x), np.atleast_1d(y)], axis=1).astype(float)
    cells = (place - LOW) / STEP
    rows, columns = NODES.shape[:2]
    corner = np.floor(np.nan_to_num(cells)).astype(int)
    corner[:, 0] = np.clip(corner[:, 0], 1, columns - 3)
    corner[:, 1] = np.clip(corner[:, 1], 1, rows - 3)
    wx, wy = _weights(cells[:, 0] - corner[:, 0]), _weights(cells[:, 1] - corner[:, 1])
    cosines = np.zeros((len(place), 2))
    for j in range(4):
        for i in range(4):
            node = NODES[corner[:, 1] + j - 1, corner[:, 0] + i - 1]
            cosines += (wy[j] * wx[i])[:, None] * node
    square = (cosines**2).sum(axis=1)
    found = np.column_stack([cosines, np.sqrt(np.maximum(1.0 - square, 0.0))])
    outside = (place @ SIDES[:, :2].T + SIDES[:, 2]).max(axis=1) > 0.0
    found[outside | ~np.isfinite(place).all(axis=1) | (square >= 1.0)] = np.nan
    return found
'''
