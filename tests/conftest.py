"""No test judges how long something took: the machine may be busy with other things."""

from __future__ import annotations

import gc
import hashlib
import os
from collections.abc import Iterator

# A worker of xdist has a core of its own; threads of BLAS beside it would wait for each other.
# Said before NumPy is loaded, and to the processes that tests start.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import pytest  # noqa: E402
from hypothesis import HealthCheck, settings  # noqa: E402

settings.register_profile(
    "any-machine", deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("any-machine")


def pytest_collection_finish() -> None:
    """What is loaded by now stays, and what tests share too: a quarter of the suite's time would
    go into the collector's walks over it, were they as frequent as in a small process.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 50)


@pytest.fixture(scope="session", autouse=True)
def _same_cells_are_checked_once() -> Iterator[None]:
    """Many tests begin with tables as they are shipped, half a second of frictionless each."""
    import survey_data.validation.validate as validation

    check, known = validation._check_schema, {}

    def checked(sound):
        key = repr({table: (records.header, records.rows) for table, records in sound.items()})
        if key not in known:
            known[key] = check(sound)
        return list(known[key])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(validation, "_check_schema", checked)
        yield


@pytest.fixture(scope="session", autouse=True)
def _same_scores_are_read_once() -> Iterator[None]:
    """Every command opens the record anew, as if it were the first: a second for the same bytes.

    What is told of a file goes by its bytes and by what its columns hold; a file that is refused
    is read each time. Who asked gets rows of their own.
    """
    from benchmark.results import store

    read, known = store.read, {}

    def kept(path, columns):
        if not path.is_file():
            return read(path, columns)
        digest = hashlib.blake2b(path.read_bytes()).digest()
        key = (path.name, digest, tuple(columns.items()))
        if key not in known:
            known[key] = read(path, columns)
        return [(line, dict(row)) for line, row in known[key]]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "read", kept)
        yield
