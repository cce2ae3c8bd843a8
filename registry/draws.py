"""Errors at a confidence: over sensor units and calibration benches that are drawn alike.

A requirement on the error is met by a pipeline where a share of its draws meets it. A draw is a
unit with its own error and a bench with its own fixed error; their squares add. Units are those
measured, or, of a pipeline that was measured on too few, spread as those of its data set are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from registry.requirements import UNITS

Numbers = NDArray[np.float64]
Positions = NDArray[np.int64]

#: Fixed error of the standard bench over its root mean square over benches: the middles of twenty
#: equal shares of 3,000 drawn benches (a test draws them anew).
BENCHES: tuple[float, ...] = (
    *(0.347, 0.440, 0.519, 0.586, 0.631, 0.679, 0.722, 0.768, 0.816, 0.856),
    *(0.903, 0.950, 1.003, 1.056, 1.117, 1.185, 1.258, 1.361, 1.489, 1.714),
)
#: Measured units from which on their own spread counts.
FEWEST_UNITS = 5

_BENCHES = np.array(BENCHES)
#: Draws, itself among them, in which neither the unit's nor the bench's error is smaller.
_AS_LARGE = np.outer(np.arange(UNITS, 0, -1), np.arange(len(BENCHES), 0, -1))
_SHARES = [(at + 0.5) / UNITS for at in range(UNITS)]


def unit_ratios(errors_deg: Sequence[float], spread: float) -> tuple[float, ...]:
    """Return errors of ten units over their geometric mean, ascending.

    `errors_deg` are of the units measured, the standard one first. Of what was measured on fewer
    than five units, the standard one's error is taken as the middle of log errors of this standard
    deviation, which is that of units of the data set.
    """
    if len(errors_deg) < FEWEST_UNITS:
        normal = NormalDist()
        return tuple(math.exp(spread * normal.inv_cdf(share)) for share in _SHARES)
    logs = sorted(math.log(max(error, 1e-12)) for error in errors_deg)
    middle = math.fsum(logs) / len(logs)
    return tuple(math.exp(logs[int(share * len(logs))] - middle) for share in _SHARES)


def at_confidence(
    own_error_deg: Numbers, ratios: Numbers, bench_deg: float, share: float
) -> Numbers:
    """Return the errors (R,) that a share of the draws keeps within, of R pipelines.

    `own_deg` (R,) is infinite where there is none; `ratios` (R, units) of units over these ascend;
    `bench_deg` is the root mean square of the fixed errors of the benches.
    """
    reach, unit, bench = _largest_draws(share)
    squares = ((own_error_deg[:, None] * ratios) ** 2)[:, unit] + ((bench_deg * _BENCHES) ** 2)[
        bench
    ]
    place = len(unit) - reach
    squares.partition(place, axis=1)
    return np.asarray(np.sqrt(squares[:, place]))


def unit_errors(own_error_deg: Numbers, ratios: Numbers, bench_deg: float, share: float) -> Numbers:
    """Return the error (R, units) that each unit keeps on a share of the benches.

    Parameters as `at_confidence`. Infinite where a pipeline has no own error.
    """
    bench = bench_deg * BENCHES[_fewest(share, len(BENCHES)) - 1]
    return np.asarray(np.sqrt((own_error_deg[:, None] * ratios) ** 2 + bench**2))


def bench_for(own_error_deg: Numbers, ratios: Numbers, limit_deg: float, share: float) -> Numbers:
    """Return the largest bench error (R,) with which a share of the draws meets a limit.

    A draw meets it up to the bench error that takes its squares to the limit's: of these, the one
    that the share of the draws reaches. At most the limit; 0 where none would do. Arrays as for
    `at_confidence`.
    """
    reach, unit, bench = _largest_draws(share)
    most = np.sqrt(np.maximum(limit_deg**2 - (own_error_deg[:, None] * ratios) ** 2, 0.0))
    draws = most[:, unit] / _BENCHES[bench]
    draws.partition(reach - 1, axis=1)
    return np.asarray(np.minimum(draws[:, reach - 1], limit_deg))


def _largest_draws(share: float) -> tuple[int, Positions, Positions]:
    """Return the draws among which the error kept by a share of all is, as units and benches.

    It is the n-th largest, and n is returned first. Errors of units and benches ascend, so a draw
    that n others equal or exceed in both is not it.
    """
    size = UNITS * len(BENCHES)
    reach = size - _fewest(share, size) + 1
    unit, bench = np.nonzero(reach >= _AS_LARGE)
    return reach, unit, bench


def _fewest(share: float, draws: int) -> int:
    """Return how many of some draws are a share of them at least."""
    return min(math.ceil(share * draws - 1e-9), draws)
