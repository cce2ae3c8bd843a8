"""Which of many pipelines are on the frontier of error and a cost, and which are not behind it.

A pipeline is on the frontier where none with at most its cost has a smaller error. What is behind
is compared with the frontier's pipeline of the least error at no higher cost, by the paired test
over units of the leaderboard (`benchmark.metrics.paired`), among all that cost no more: it is
dominated where the test separates them. Units of different data sets are other sensors; pairing
them by number keeps the test valid and only makes it separate less.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

Status = Literal["frontier", "not separable", "dominated", "untested"]


def frontier(
    errors_deg: Sequence[float],
    costs: Sequence[float],
    units_deg: Sequence[Sequence[float | None]],
) -> list[Status]:
    """Return where each of N pipelines stands; a smaller error and a smaller cost are better.

    Parameters
    ----------
    errors_deg
        Errors by which pipelines are compared, N.
    costs
        Their costs, N, in any unit.
    units_deg
        Errors of each pipeline by sensor unit, the standard one first.

    Returns
    -------
    list
        ``frontier``; ``not separable`` and ``dominated`` by the paired test against the frontier;
        ``untested`` behind the frontier with fewer than five units in common with it.

    Raises
    ------
    ValueError
        Where the three have different lengths.

    Examples
    --------
    >>> frontier([1.0, 2.0, 3.0], [5.0, 1.0, 9.0], [[1.0], [2.0], [3.0]])
    ['frontier', 'frontier', 'untested']
    """
    from benchmark.metrics import paired  # noqa: PLC0415 - loads SciPy

    if not len(errors_deg) == len(costs) == len(units_deg):
        raise ValueError("expected as many errors, costs and lists of units")
    order = sorted(range(len(costs)), key=lambda at: (costs[at], errors_deg[at]))
    found: list[Status] = ["frontier"] * len(costs)
    ends: list[tuple[int, list[int]]] = []  # a pipeline of the frontier, and who is behind it
    for at in order:
        leader, behind = ends[-1] if ends else (at, [])
        if not ends or errors_deg[at] < errors_deg[leader]:
            ends.append((at, []))
        elif (costs[at], errors_deg[at]) != (costs[leader], errors_deg[leader]):
            behind.append(at)
    for leader, behind in ends:
        if not behind:
            continue
        # The leader is the best of all that cost no more, so that all of them count in the test.
        among = {at: n for n, at in enumerate(order[: order.index(behind[-1]) + 1])}
        logs = paired.logarithms([units_deg[at] for at in among])
        first = among[leader]
        common = np.isfinite(logs - logs[first]).sum(axis=1)
        apart = paired.separate(logs, first)
        for at in behind:
            found[at] = "dominated" if apart[among[at]] else "not separable"
            if common[among[at]] < paired.FEWEST_UNITS:
                found[at] = "untested"
    return found
