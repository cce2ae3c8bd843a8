"""Work handed to processes of this machine, which end with the one that hands it out.

On Ctrl-C, on a request to terminate and on any error they are ended before it goes on; when this
process is killed they end by themselves (`benchmark.processes`).
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Generator, Iterable
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children
from typing import TypeVar

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky.backend.process import LokyProcess

from benchmark.processes import end_if_told, work_for
from benchmark.running.cluster import WorkerLostError

A = TypeVar("A")
B = TypeVar("B")


def in_order(work: Callable[[A], B], items: Iterable[A], workers: int) -> Generator[B, None, None]:
    """Do work in processes and give the results in the order of the items.

    Parameters
    ----------
    work
        Pure function of an item, of a module.
    items
        Handed out one at a time.
    workers
        Number of processes; with 1 all happens in this one.

    Raises
    ------
    WorkerLostError
        When a worker was killed.
    """
    return _results(work, items, workers, "generator")


def as_completed(
    work: Callable[[A], B], items: Iterable[A], workers: int
) -> Generator[B, None, None]:
    """As `in_order`, but each result as soon as it is there."""
    return _results(work, items, workers, "generator_unordered")


def _results(
    work: Callable[[A], B], items: Iterable[A], workers: int, order: str
) -> Generator[B, None, None]:
    if workers == 1:
        for item in items:
            result = work(item)
            end_if_told()  # what a signal broke off, though a library took it, is no result
            yield result
        return
    # As the workers are started, not with their first task: one that waits ends as well.
    own = {"initializer": work_for, "initargs": (os.getpid(),)}
    try:
        with parallel_config("loky", n_jobs=workers, inner_max_num_threads=1, **own):
            parallel = Parallel(return_as=order, batch_size=1, pre_dispatch="2*n_jobs")
            results = parallel(delayed(work)(item) for item in items)
        try:
            # "yield from" would close them itself, before their warnings are kept quiet
            for result in results:
                yield result
        finally:
            with warnings.catch_warnings():
                # joblib's advice on what was in flight: who asked for it has said what is kept
                warnings.filterwarnings("ignore", ".*tasks which were still being processed.*")
                results.close()
    except BrokenProcessPool as error:
        raise WorkerLostError(
            "a worker process was killed, or died of what it did; what was done before is kept"
        ) from error
    except KeyboardInterrupt:
        _end_those_being_started()
        raise


def _end_those_being_started() -> None:
    """End workers that joblib does not know of yet, where it was broken off while starting them."""
    for process in active_children():
        if isinstance(process, LokyProcess):
            process.kill()
