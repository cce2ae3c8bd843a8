"""Bundles of tasks measured by the workers of a Dask cluster; its scheduler is named by address.

The package's own client and not joblib's backend for it: there a task whose worker died too often
never comes back, so that the run waits for ever, and with a single worker nothing leaves this
process. A worker that dies takes with it what it had in hand; Dask gives that to another.
"""

from __future__ import annotations

import gc
import os
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol, TypeVar

from benchmark.results.closure import closure_digest
from benchmark.results.digests import entries_of, method_entries
from benchmark.running.task import Task
from files.temporary import temporary_file_beside

#: Seconds to wait for the scheduler, and then for a worker to be there.
_PATIENCE_S = 30
#: What a worker keeps between tasks, and how many threads it computes in, are the process's own.
_ONE_AT_A_TIME = threading.Lock()

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class DaskMissingError(ImportError):
    """A Dask scheduler was named and its client is not installed."""


class ClusterError(RuntimeError):
    """The cluster cannot be reached, has no workers, or cannot run what it was given."""


class OtherCodeError(RuntimeError):
    """A worker has other code than the process that keeps the results."""


class WorkerLostError(RuntimeError):
    """Worker processes died over a task, as often as it is tried again."""


class _Work(Protocol[T_co]):
    """Tasks, and a call that measures them."""

    @property
    def tasks(self) -> Sequence[Task]: ...

    def __call__(self) -> T_co: ...


class Cluster:
    """A cluster that answers; its workers take whatever they are given at once.

    Parameters
    ----------
    client
        Of ``distributed``.
    scheduler
        Its address.
    """

    def __init__(self, client: Any, scheduler: str) -> None:
        self.client = client
        self.scheduler = scheduler
        self._given = 0
        self._done = import_module("distributed").as_completed(loop=client.loop)

    def workers(self) -> int:
        """Count the worker processes there are now."""
        return len(self.client.ncores())

    def sees(self, directory: Path) -> bool:
        """Say whether every worker sees a directory of this machine: on it, or by a shared disk.

        It is made where it is not there.
        """
        directory.mkdir(parents=True, exist_ok=True)
        with temporary_file_beside(directory / "seen") as path:
            return all(self.client.run(os.path.exists, str(path)).values())

    def is_free(self) -> bool:
        """Say whether there are more workers than things to do; one more each is sent ahead."""
        return self._given < 2 * self.workers()

    def is_busy(self) -> bool:
        """Say whether something is still to come back."""
        return self._given > 0

    def give(self, work: _Work[Any]) -> None:
        """Have tasks measured on a worker."""
        of_it = partial(_measure, code_of(work.tasks), work.tasks, work)
        self._done.add(self.client.submit(of_it, pure=False))
        self._given += 1

    def take(self) -> Any:
        """Wait for the next that is done and return what its worker gives.

        Raises
        ------
        OtherCodeError
            Where a worker's code of a task is not this process's.
        WorkerLostError
            Where the workers that were given a bundle died, one after another.
        ClusterError
            For anything else that a worker could not do; implementations' errors are results.
        """
        distributed = import_module("distributed")
        future = next(self._done)
        try:
            result = future.result()
        except distributed.KilledWorker as error:
            raise WorkerLostError(
                f"workers of {self.scheduler} were killed, or died of what they measured, "
                "one after another; what was measured before is kept"
            ) from error
        except OtherCodeError:
            raise
        except Exception as error:
            raise ClusterError(
                f"a worker of {self.scheduler} could not measure: {type(error).__name__}: {error}"
            ) from error
        future.release()
        self._given -= 1
        return result


@contextmanager
def _garbage_left_alone() -> Iterator[None]:
    """Collect no garbage meanwhile.

    A client that failed to connect waits, when it is collected, for the lock that one being made
    holds: both would wait for good.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@contextmanager
def connect(scheduler: str) -> Iterator[Cluster]:
    """Hold a connection to a cluster; what is under way there is given up at the end.

    Parameters
    ----------
    scheduler
        Address, e.g. ``tcp://127.0.0.1:8786``.

    Raises
    ------
    DaskMissingError
        Without the ``distributed`` package.
    ClusterError
        When nothing answers there, or no worker is there.
    """
    if find_spec("distributed") is None:
        raise DaskMissingError(
            f"measuring on the Dask scheduler {scheduler} needs the package 'distributed'; "
            "install it beside this one (pip install distributed) or leave the scheduler out"
        )
    distributed = import_module("distributed")
    said = ""
    with _garbage_left_alone():
        try:
            client = distributed.Client(scheduler, timeout=_PATIENCE_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            said = str(error) or type(error).__name__
    if said:
        gc.collect()  # the client that did not come to be ends here, and not while another starts
        raise ClusterError(
            f"no Dask scheduler answers at {scheduler} (expected an address such as "
            f"tcp://127.0.0.1:8786): {said}"
        )
    with client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE_S)
        except TimeoutError as error:
            raise ClusterError(
                f"the Dask scheduler {scheduler} has no workers; start some with "
                f"`dask worker {scheduler} --nthreads 1`"
            ) from error
        yield Cluster(client, scheduler)


def code_of(tasks: Sequence[Task]) -> str:
    """Digest of the code that measures these tasks: of all stages, their data and methods."""
    entries = {"benchmark.running.task:measure"}
    for preset in {id(task.preset): task.preset for task in tasks}.values():
        entries.update(entries_of(preset))
    for method in {method for task in tasks for method in (task.extractor, *task.models)}:
        entries.update(method_entries(method))
    return closure_digest(*sorted(entries))


def _measure(code: str, tasks: Sequence[Task], measure: Callable[[], T]) -> T:
    """Measure on a worker, one bundle at a time however many threads it has."""
    if code_of(tasks) != code:
        raise OtherCodeError(
            f"a worker has other code for {tasks[0].preset.name} than this process: its numbers "
            "would be taken for those of the code here; bring both to the same version"
        )
    with _ONE_AT_A_TIME:
        return measure()
