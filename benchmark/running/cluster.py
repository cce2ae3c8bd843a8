"""A Dask cluster, named by the address of its scheduler, as a backend of joblib."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any

import distributed  # an extra
from joblib._dask import DaskDistributedBackend

#: Seconds to wait for the scheduler, and then for a worker to be there.
_PATIENCE_S = 30


class ClusterError(RuntimeError):
    """A cluster cannot be reached, has no workers, or cannot do what it was given."""


class _Backend(DaskDistributedBackend):  # type: ignore[misc]
    """joblib's own (1.6) waits for ever for a task whose workers were killed."""

    def submit(self, func: Any, callback: Callable[[Any], object] | None = None) -> Any:
        future = super().submit(func, callback)
        future.add_done_callback(lambda done: callback and done.exception() and callback(done))
        return future

    def retrieve_result_callback(self, out: Any) -> Any:
        return out.result() if isinstance(out, Future) else super().retrieve_result_callback(out)

    def effective_n_jobs(self, n_jobs: int) -> int:
        return max(int(super().effective_n_jobs(n_jobs)), 2)  # else joblib works in this process


@contextmanager
def on_cluster(scheduler: str) -> Iterator[dict[str, Any]]:
    """Yield what makes joblib use a cluster; at the end what is under way there is given up.

    Raises ClusterError for whatever keeps it from doing so; what implementations raise is a result.
    """
    try:
        client: Any = distributed.Client(  # type: ignore[no-untyped-call]
            scheduler, timeout=_PATIENCE_S, set_as_default=False
        )
    except (OSError, ValueError, TypeError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at {scheduler} (expected an address such as "
            f"tcp://127.0.0.1:8786): {error}"
        ) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE_S)
        except TimeoutError as error:
            raise ClusterError(
                f"the Dask scheduler {scheduler} has no workers; start some with "
                f"`dask worker {scheduler} --nthreads 1`"
            ) from error
        try:
            yield {"backend": _Backend(client=client), "n_jobs": -1}
        except Exception as error:
            raise ClusterError(
                f"a worker of {scheduler} could not measure, what was measured before is kept: "
                f"{type(error).__name__}: {error}"
            ) from error
