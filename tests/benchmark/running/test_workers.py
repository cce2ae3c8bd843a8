"""Work handed to processes comes back whole, and once."""

from __future__ import annotations

import math
import os
import signal

import pytest

from benchmark.running.cluster import WorkerLostError
from benchmark.running.workers import as_completed


def kill(number: float) -> float:
    if number == 2.0:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_every_item_is_done_once(workers: int) -> None:
    items = [float(number) for number in range(9)]
    expected = [math.sqrt(number) for number in items]
    assert sorted(as_completed(math.sqrt, iter(items), workers)) == expected


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_an_error_of_the_work_is_raised_here(workers: int) -> None:
    with pytest.raises(ValueError, match="math domain"):
        list(as_completed(math.sqrt, [1.0, -1.0], workers))


def test_a_killed_worker_is_told_by_name() -> None:
    with pytest.raises(WorkerLostError, match="a worker process was killed"):
        list(as_completed(kill, [1.0, 2.0, 3.0], 2))


@pytest.mark.slow
def test_who_stops_early_can_ask_again() -> None:
    first = as_completed(math.sqrt, [4.0] * 50, 2)
    assert next(first) == 2.0
    first.close()
    assert list(as_completed(math.sqrt, [9.0, 16.0], 2)) == [3.0, 4.0]
