"""Work done in parallel by joblib: in processes of this machine, or on a Dask cluster.

Processes of this machine are ended on Ctrl-C and on any error; when this one is killed they end by
themselves (`benchmark.processes`).
"""

from __future__ import annotations

import atexit
import os
import warnings
from collections.abc import Callable, Generator, Iterable
from concurrent.futures.process import BrokenProcessPool
from contextlib import nullcontext
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky import process_executor

from benchmark.processes import end_if_requested, work_for
from benchmark.simulator.light.memory import memory
from files.atomic import temporary_directory

A = TypeVar("A")
B = TypeVar("B")


class WorkerLostError(RuntimeError):
    """A worker process was killed."""


def as_completed(
    work: Callable[[A], B], items: Iterable[A], workers: int, scheduler: str | None = None
) -> Generator[B, None, None]:
    """Do work and yield each result as soon as it is there; what is not taken is given up.

    `work` is a pure function of a module; items are handed out one at a time, in order. With one
    worker all happens in this process; `scheduler` is the address of a Dask scheduler to use
    instead, such as ``tcp://127.0.0.1:8786``. WorkerLostError when a worker was killed;
    ClusterError and ImportError as `benchmark.running.cluster.on_cluster`.
    """
    if scheduler is not None:
        from benchmark.running.cluster import on_cluster  # noqa: PLC0415 - needs an extra

    with nullcontext(_here(workers)) if scheduler is None else on_cluster(scheduler) as backend:
        with parallel_config(**backend):
            parallel = Parallel(return_as="generator_unordered", batch_size=1)
        results = parallel(delayed(work)(item) for item in items)
        try:
            for result in results:
                end_if_requested()  # what a signal broke off, though a library took it, is none
                yield result
        except BrokenProcessPool as error:
            raise WorkerLostError(
                "a worker process was killed, or died of what it did; what was done before is kept"
            ) from error
        finally:
            with warnings.catch_warnings(action="ignore"):  # of results that are given up
                results.close()


def _here(workers: int) -> dict[str, Any]:
    if workers == 1:
        return {"backend": "sequential"}
    # as they start: one that has not got an item yet is to end with this process as well
    begin = {"initializer": _begin, "initargs": (os.getpid(), _tables())}
    limits = {"n_jobs": workers, "inner_max_num_threads": 1, "max_nbytes": None}
    return {"backend": "loky", **limits, **begin}


@cache
def _tables() -> Path:
    """Directory that workers of this process share tables in; gone when it ends."""
    held = temporary_directory()
    atexit.register(held.__exit__, None, None, None)
    return held.__enter__()


def _begin(coordinator: int, tables: Path) -> None:
    """Prepare a worker process: stop with its parent, and share tables of light."""
    process_executor._USE_PSUTIL = False  # noqa: SLF001 - else it is taken for a leak, and replaced
    work_for(coordinator)
    memory.share_tables(tables)
