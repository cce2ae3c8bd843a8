"""Work handed to processes of this machine, which end with the one that hands it out.

On Ctrl-C, on a request to terminate and on any error they are ended before it goes on; when this
process is killed they end by themselves (`benchmark.processes`).
"""

from __future__ import annotations

import atexit
import os
import signal
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from functools import cache, partial
from itertools import islice
from multiprocessing import active_children
from pathlib import Path
from queue import SimpleQueue
from typing import Any, TypeVar

from joblib.externals.loky import get_reusable_executor, process_executor
from joblib.externals.loky.backend.process import LokyProcess

from benchmark.processes import end_if_requested, release_free_memory, work_for
from benchmark.running.cluster import WorkerLostError
from benchmark.simulator.light.memory import memory
from files.temporary import temporary_directory

A = TypeVar("A")
B = TypeVar("B")

#: Seconds after which a worker that is given nothing ends.
_IDLE_S = 300
#: Each worker computes in one thread, whichever library does.
_ONE_THREAD = dict.fromkeys(
    (
        *("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"),
        *("VECLIB_MAXIMUM_THREADS", "NUMBA_NUM_THREADS", "NUMEXPR_NUM_THREADS"),
    ),
    "1",
)


#: Frames take tens of MB: until other data are made, the C library (glibc) keeps what is freed for
#: the next ones, which costs less than to have the system clear pages for each.
_MEMORY = {
    "MALLOC_MMAP_THRESHOLD_": str(64 * 2**20),
    "MALLOC_TRIM_THRESHOLD_": str(64 * 2**20),
}


class LocalHands:
    """Worker processes, each with one piece of work at a time."""

    def __init__(self, executor: Any, workers: int) -> None:
        self._executor = executor
        self._workers = workers
        self._given = 0
        self._done: SimpleQueue[Future[Any]] = SimpleQueue()

    def is_free(self) -> bool:
        """Say whether a worker has nothing to do."""
        return self._given < self._workers

    def is_busy(self) -> bool:
        """Say whether something is still to come back."""
        return self._given > 0

    def give(self, work: Callable[[], Any]) -> None:
        """Have a worker do a piece of work."""
        self._executor.submit(_do, work).add_done_callback(self._done.put)
        self._given += 1

    def take(self) -> Any:
        """Wait for the next piece that is done and return what it gives, or raise its error."""
        result = self._done.get().result()
        self._given -= 1
        return result


@contextmanager
def hands_of(workers: int) -> Iterator[LocalHands]:
    """Hold worker processes; what is under way when they are left is given up.

    Raises
    ------
    WorkerLostError
        When a worker was killed.
    """
    hands = None
    try:
        executor = get_reusable_executor(
            workers,
            timeout=_IDLE_S,
            env=_ONE_THREAD | _MEMORY,
            # as the workers are started, not with their first task: one that waits ends as well
            initializer=_begin,
            initargs=(os.getpid(), _tables()),
        )
        hands = LocalHands(executor, workers)
        yield hands
    except BrokenProcessPool as error:
        raise WorkerLostError(
            "a worker process was killed, or died of what it did; what was done before is kept"
        ) from error
    finally:
        if hands is None:
            _kill()
        elif hands.is_busy():
            _kill()
            executor.shutdown()


def as_completed(
    work: Callable[[A], B], items: Iterable[A], workers: int
) -> Generator[B, None, None]:
    """Do work in processes and give each result as soon as it is there.

    Parameters
    ----------
    work
        Pure function of an item, of a module.
    items
        Handed out one at a time.
    workers
        Number of processes; with 1 all happens in this one, in the order of the items.

    Raises
    ------
    WorkerLostError
        When a worker was killed.
    """
    if workers == 1:
        for item in items:
            result = work(item)
            end_if_requested()  # what a signal broke off, though a library took it, is no result
            yield result
        return
    waiting = iter(items)
    with hands_of(workers) as hands:
        for item in islice(waiting, 2 * workers):
            hands.give(partial(work, item))
        while hands.is_busy():
            result = hands.take()
            for item in islice(waiting, 1):
                hands.give(partial(work, item))
            yield result


@cache
def _tables() -> Path:
    """Directory that workers of this process share tables in; gone when it ends."""
    held = ExitStack()
    atexit.register(held.close)
    return held.enter_context(temporary_directory())


def _begin(coordinator: int, tables: Path) -> None:
    """Begin as a worker, which keeps what it knows of a data set until the next one comes.

    The pool would take 300 MB more than after the first bundle for a leak, and start another.
    """
    process_executor._USE_PSUTIL = False  # noqa: SLF001 - there is no public way
    work_for(coordinator)
    memory.share_tables(tables)


def _do(work: Callable[[], A]) -> A:
    """Do a piece of work; memory that is free after it goes back to the system."""
    try:
        return work()
    finally:
        release_free_memory()


def _kill() -> None:
    """Kill workers, those that are being started among them.

    The pool sees that they are gone and makes others for who asks next. To have it kill them ends
    its thread by an error where it was just given something.
    """
    for process in active_children():
        if isinstance(process, LokyProcess) and process.pid:  # its own kill() is not made
            with suppress(ProcessLookupError):
                os.kill(process.pid, signal.SIGKILL)
