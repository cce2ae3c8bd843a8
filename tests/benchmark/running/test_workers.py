"""Work handed to processes comes back whole, and once."""

from __future__ import annotations

import math
import os
import signal
import warnings

import pytest

from benchmark.running.workers import WorkerLostError, as_completed


def kill(number: float) -> float:
    if number == 2.0:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_every_item_is_done_once_and_an_error_is_raised_here(workers: int) -> None:
    items = [float(number) for number in range(9)]
    expected = [math.sqrt(number) for number in items]
    assert sorted(as_completed(math.sqrt, iter(items), workers)) == expected
    with pytest.raises(ValueError, match="math domain"):
        list(as_completed(math.sqrt, [1.0, -1.0], workers))


@pytest.mark.slow
def test_a_killed_worker_is_told_by_name_and_others_take_its_place() -> None:
    with pytest.raises(WorkerLostError, match="a worker process was killed"):
        list(as_completed(kill, [1.0, 2.0, 3.0], 2))
    first = as_completed(math.sqrt, [4.0] * 50, 2)
    assert next(first) == 2.0
    with warnings.catch_warnings(action="error"):
        first.close()
    assert list(as_completed(math.sqrt, [9.0, 9.0], 2)) == [3.0, 3.0]
