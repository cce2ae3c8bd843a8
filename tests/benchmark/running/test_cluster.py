"""A Dask cluster of two worker processes gives what one process gives, whoever is killed."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dask
import distributed
import fake_cluster
import pytest

from benchmark.plan.combinations import cells
from benchmark.progress import silent
from benchmark.results.store import Store
from benchmark.running import cluster, runner
from benchmark.running.cluster import ClusterError
from benchmark.running.runner import Summary, run

pytestmark = pytest.mark.slow
PLANNED = 10  # one condition of the first data set, two of the others, two extractors on each


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a scheduler with two processes of one thread, which write what they do."""
    patient = {"distributed.comm.timeouts.connect": "300s"}
    once = {"distributed.scheduler.allowed-failures": 1}
    workers: dict[str, Any] = {"n_workers": 2, "threads_per_worker": 1, "processes": True}
    quiet: dict[str, Any] = {"dashboard_address": ":0", "silence_logs": "CRITICAL"}
    with pytest.MonkeyPatch.context() as patch, dask.config.set(patient | once):
        patch.setenv("FAKE_ATLAS_LOG", str(tmp_path_factory.mktemp("log") / "log"))
        with distributed.LocalCluster(**workers, **quiet) as found:
            yield found.scheduler_address


def measured(store: Store, deadly: str = "", **options: Any) -> Summary:
    parts = fake_cluster.parts(deadly=deadly)
    return run(cells(parts=parts), store, progress=silent, parts=parts, **options)


def contents(store: Store) -> dict[Path, bytes]:
    found = [*store.directory.glob("*.*"), *store.scores_directory.glob("*.*")]
    return {p.relative_to(store.directory): p.read_bytes() for p in found if p.is_file()}


def test_two_dask_workers_give_the_bytes_of_a_local_run_and_keep_stages(
    scheduler: str, tmp_path: Path
) -> None:
    log = Path(os.environ["FAKE_ATLAS_LOG"])
    local, store, again = (Store(tmp_path / name) for name in ("local", "store", "again"))
    measured(local)
    log.write_text("")
    done = measured(store, scheduler=scheduler)
    assert (done.planned, done.computed, done.failed) == (PLANNED, PLANNED, ())
    made = {line.split()[1] for line in log.read_text().splitlines() if "process" in line}
    assert made
    assert str(os.getpid()) not in made
    log.write_text("")
    assert measured(again, scheduler=scheduler, others=[store]).computed == PLANNED
    assert "process" not in log.read_text()
    assert contents(again) == contents(store) == contents(local)


def test_a_worker_of_other_code_is_refused(
    scheduler: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(runner, "code_of", lambda tasks: "not what a worker finds")
    with pytest.raises(ClusterError, match="other code for fake-"):
        measured(Store(tmp_path), scheduler=scheduler)


def test_an_address_where_nothing_answers_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cluster, "_PATIENCE_S", 0.2)
    with pytest.raises(ClusterError, match="no Dask scheduler answers at nowhere"):
        measured(Store(tmp_path), scheduler="nowhere")
