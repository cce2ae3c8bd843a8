"""No test judges how long something took: the machine may be busy with other things."""

from __future__ import annotations

import atexit
import gc
import hashlib
import os
import sys
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

# A worker of xdist has a core of its own; threads of BLAS beside it would wait for each other.
# Said before NumPy is loaded, and to the processes that tests start.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import pytest  # noqa: E402
from hypothesis import HealthCheck, settings  # noqa: E402
from threadpoolctl import ThreadpoolController  # noqa: E402

settings.register_profile(
    "any-machine", deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("any-machine")

#: What tests share stays. Were the collector's walks over it as frequent as in a small process,
#: they would be a quarter of the time of collecting, and of the suite.
gc.set_threshold(100_000, 20, 50)

#: What waits for servers and processes comes first, while the other worker, which begins in the
#: middle, computes. What compiles kernels comes last: extractors and models, then the simulator.
FIRST, LAST = ("tests/api/http/", "tests/test_"), ("tests/algorithms/", "tests/benchmark/")


def pytest_configure(config: pytest.Config) -> None:
    """Leave a worker's million objects to the system at its end: Python would free them for 2 s.

    Where coverage is measured, it has yet to write what it saw.
    """
    if hasattr(config, "workerinput") and "coverage" not in sys.modules:
        atexit.register(os._exit, 0)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Do not even import a module whose every test is slow where slow tests are left out."""
    if "not slow" not in config.option.markexpr or collection_path.suffix != ".py":
        return None
    return "\npytestmark = pytest.mark.slow\n" in collection_path.read_text("utf-8") or None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put side by side what shares readings or kernels, and try fewer examples.

    Each of two workers begins with its half of the tests, and they seldom compile the same kernel
    at once. Where the slow tests are left out too, properties are tried on an eighth of their
    examples, the same ones in every run.
    """
    items.sort(key=_place)
    if "not slow" not in config.option.markexpr:
        return
    done = set()
    for item in items:
        test = getattr(item, "obj", None)
        own = getattr(test, "_hypothesis_internal_use_settings", None)  # no public way to change it
        if own is not None and test not in done:
            done.add(test)
            fewer = min(own.max_examples, max(10, own.max_examples // 8))
            test._hypothesis_internal_use_settings = settings(
                own, max_examples=fewer, derandomize=True, database=None
            )


def _place(item: pytest.Item) -> int:
    """Return the place of a test in `LAST`, from 1; -1 for those of `FIRST`, 0 for all others."""
    places = [(-1, FIRST), *enumerate(LAST, start=1)]
    return next((n for n, begun in places if item.nodeid.startswith(begun)), 0)


def pytest_collection_finish() -> None:
    """What is loaded by now is walked over no more."""
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def _same_cells_are_read_and_checked_once() -> Iterator[None]:
    """Many tests begin with the shipped tables and change a cell: what else there is, is known.

    A file is read again where its bytes differ, a table typed where its cells do, and checked by
    frictionless where its cells or those of a table that its keys refer to do.
    """
    from survey_data import table_records, tables
    from survey_data.descriptor import descriptor, file_name
    from survey_data.validation import validate as validation

    schemas = {each["name"]: each["schema"] for each in descriptor()["resources"]}
    referred = {
        table: {key["reference"]["resource"] for key in schema.get("foreignKeys", ())}
        for table, schema in schemas.items()
    }
    read, typed, check = (
        table_records.read_records,
        tables.typed_frame,
        validation._check_schema,
    )
    files, frames, found = {}, {}, {}

    def kept_records(path, columns):
        if not path.is_file():
            return read(path, columns)
        key = (path.name, path.read_bytes(), tuple(columns))
        if key not in files:
            files[key] = read(path, columns)
        kept = files[key]
        rows = [(row, list(cells)) for row, cells in kept.rows]
        return type(kept)(list(kept.header), rows, list(kept.problems))

    def kept_frame(table, records):
        key = (table, repr(records.rows))
        if key not in frames:
            frames[key] = typed(table, records)
        frame, flaws = frames[key]
        return frame.copy(deep=False), list(flaws)  # pandas copies what is written to

    def kept_problems(sound):
        cells = {table: (records.header, records.rows) for table, records in sound.items()}
        said = {table: repr(of) for table, of in cells.items()}
        problems = []
        for table in sound:
            those = {table: sound[table]}
            those |= {name: sound[name] for name in referred[table] if name in sound}
            key = (table, *(said[name] for name in those))
            if key not in found:
                elsewhere = {file_name(name) for name in those if name != table}
                found[key] = [each for each in check(those) if each.file not in elsewhere]
            problems += found[key]
        return problems

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(table_records, "read_records", kept_records)
        patch.setattr(tables, "typed_frame", kept_frame)
        patch.setattr(validation, "typed_frame", kept_frame)
        patch.setattr(validation, "_check_schema", kept_problems)
        yield


@pytest.fixture(scope="session", autouse=True)
def _same_scores_are_read_once() -> Iterator[None]:
    """Every command opens the record anew, as if it were the first: a second for the same bytes.

    A file is described by its bytes and by what its columns hold; a file that is refused
    is read each time. Who asked gets rows of their own.
    """
    from benchmark.results import store

    read, known = store.read_csv, {}

    def kept(path, columns):
        if not path.is_file():
            return read(path, columns)
        digest = hashlib.blake2b(path.read_bytes()).digest()
        key = (path.name, digest, tuple(columns.items()))
        if key not in known:
            known[key] = read(path, columns)
        return [(line, dict(row)) for line, row in known[key]]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "read_csv", kept)
        yield


@pytest.fixture(scope="session", autouse=True)
def _libraries_with_threads_are_looked_for_once() -> Iterator[None]:
    """Every measurement looks for them anew, among all that any test has loaded by then.

    They are looked for again where more modules are loaded than before.
    """
    from algorithms import threads

    found = lru_cache(maxsize=1)(lambda modules: ThreadpoolController())

    def limits(**asked):
        return found(len(sys.modules)).limit(**asked)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(threads, "threadpool_limits", limits)
        yield
