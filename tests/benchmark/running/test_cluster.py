"""A Dask cluster of two worker processes gives what one process gives, whoever is killed."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import dask
import distributed
import fake_cluster
import pytest

from benchmark.contract import Cell
from benchmark.plan.combinations import cells
from benchmark.progress import silent
from benchmark.results.record import Record
from benchmark.results.store import Store
from benchmark.running import cluster as dask_cluster
from benchmark.running.cluster import ClusterError, OtherCodeError, WorkerLostError
from benchmark.running.planned import tasks_of
from benchmark.running.runner import RunInterruptedError, Summary, run

PLANNED = 10  # one condition of the first data set, two of the others, two extractors on each


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where workers write what they do; set before they start."""
    path = tmp_path_factory.mktemp("log") / "log"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FAKE_ATLAS_LOG", str(path))
        yield path


@pytest.fixture(scope="module")
def scheduler(log: Path) -> Iterator[str]:
    """Address of a scheduler with two processes of one thread, which are replaced when killed."""
    with (
        dask.config.set(
            {
                "distributed.scheduler.allowed-failures": 1,
                "distributed.comm.timeouts.connect": "300s",
            }
        ),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            dashboard_address=":0",
            silence_logs="CRITICAL",
        ) as cluster,
    ):
        yield cluster.scheduler_address


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, bytes]:
    """Files of a run in this process."""
    store = Store(tmp_path_factory.mktemp("local"))
    assert measured(store).computed == PLANNED
    return contents(store)


def measured(store: Store, progress: Any = silent, **options: Any) -> Summary:
    paths = {name: options.pop(name, "") for name in ("gate", "deadly")}
    parts = fake_cluster.parts(**paths)
    return run(cells(parts=parts), store, progress=progress, parts=parts, **options)


def contents(store: Store) -> dict[Path, bytes]:
    found = [*store.directory.glob("*.*"), *store.scores_directory.glob("*.*")]
    return {p.relative_to(store.directory): p.read_bytes() for p in found if p.is_file()}


def made(log: Path) -> list[tuple[int, str]]:
    """Process and what it generated, for every split."""
    lines = [line.split(" ", 2) for line in log.read_text().splitlines()]
    return [(int(pid), what) for word, pid, what in lines if word == "process"]


def test_two_dask_workers_give_the_bytes_of_a_local_run(
    scheduler: str, log: Path, expected: dict[Path, bytes], tmp_path: Path
) -> None:
    log.write_text("")
    store = Store(tmp_path)
    done = measured(store, scheduler=scheduler)
    assert (done.planned, done.computed, done.failed) == (PLANNED, PLANNED, ())
    assert contents(store) == expected
    assert len(expected) == 3 + 3  # pins, components, manifest, a table for each data set
    processes = {process for process, _ in made(log)}
    assert os.getpid() not in processes
    assert 1 <= len(processes) <= 2


def test_workers_that_see_the_store_keep_stages_there_and_take_them_from_there(
    scheduler: str, log: Path, expected: dict[Path, bytes], tmp_path: Path
) -> None:
    first, second = Store(tmp_path / "first"), Store(tmp_path / "second")
    measured(first, scheduler=scheduler)
    assert list((first.work_directory / "stages").glob("??/*"))
    log.write_text("")
    done = measured(second, scheduler=scheduler, others=[first])
    assert done.computed == PLANNED
    assert made(log) == []
    assert contents(second) == expected


def test_workers_that_see_another_disk_are_told_from_those_that_see_this_one(
    scheduler: str, tmp_path: Path
) -> None:
    with dask_cluster.connect(scheduler) as cluster:
        assert cluster.sees(tmp_path / "stages")
    answers = SimpleNamespace(run=lambda look, path: {"tcp://a": look(path), "tcp://b": False})
    apart: Any = SimpleNamespace(client=answers)
    assert not dask_cluster.Cluster.sees(apart, tmp_path / "stages")
    assert list((tmp_path / "stages").iterdir()) == []


def test_two_local_workers_do_too(expected: dict[Path, bytes], tmp_path: Path) -> None:
    assert measured(Store(tmp_path), workers=2).computed == PLANNED
    assert contents(Store(tmp_path)) == expected


@pytest.mark.slow
def test_a_worker_killed_after_its_first_result_loses_nothing(
    scheduler: str, log: Path, expected: dict[Path, bytes], tmp_path: Path
) -> None:
    """All but the first bundle wait at a gate that opens when its worker has been killed."""
    log.write_text("")
    gate, store = tmp_path / "gate", Store(tmp_path / "store")
    os.mkfifo(gate)
    killed: list[int] = []
    held: list[int] = []

    messages: list[tuple[int, str]] = []

    def kill(done: int, total: int, what: str, share: float | None = None) -> None:
        messages.append((done, what))
        if done and not killed:
            assert (done, total) == (1, PLANNED)
            assert what.startswith("fake-a quiet")
            (process,) = {process for process, _ in made(log)}
            os.kill(process, signal.SIGKILL)
            killed.append(process)
            held.append(os.open(gate, os.O_RDWR))  # from now on there is who writes

    try:
        done = measured(store, kill, scheduler=scheduler, gate=str(gate))
    finally:
        for descriptor in held:
            os.close(descriptor)
    assert (done.computed, done.failed) == (PLANNED, ())
    after = contents(store)
    assert after == expected
    there = made(log)
    assert {what for process, what in there if process in killed} == {
        f"fake-a quiet {split}" for split in ("calibration", "test", "repeat")
    }
    assert [done for done, _ in messages] == list(range(PLANNED + 1))
    assert sum(what.startswith("fake-a") for _, what in messages) == 2, "each result is taken once"
    others = {process for process, _ in there} - set(killed)
    assert len(others) in (1, 2)
    assert os.getpid() not in others


@pytest.mark.slow
def test_a_task_that_kills_every_worker_ends_the_run_and_the_next_does_what_is_missing(
    scheduler: str, log: Path, expected: dict[Path, bytes], tmp_path: Path
) -> None:
    log.write_text("")
    deadly, store = tmp_path / "deadly", Store(tmp_path / "store")
    deadly.touch()
    with pytest.raises(WorkerLostError, match="what was measured before is kept"):
        measured(store, scheduler=scheduler, deadly=str(deadly))
    kept = kept_cells(store)
    assert all(cell.dataset != "fake-c" for cell in kept)
    assert not store.components_path.exists()

    deadly.unlink()
    log.write_text("")
    done = measured(store, scheduler=scheduler, deadly=str(deadly))
    assert (done.already_stored, done.computed) == (len(kept), PLANNED - len(kept))
    again = {tuple(what.split()[:2]) for _, what in made(log)}
    assert again.isdisjoint({(cell.dataset, cell.condition) for cell in kept})
    assert contents(store) == expected


def test_a_run_broken_off_is_finished_on_the_cluster_by_what_is_missing(
    scheduler: str, expected: dict[Path, bytes], tmp_path: Path
) -> None:
    store = Store(tmp_path)

    def stop(done: int, _total: int, _what: str, _share: float | None = None) -> None:
        if done >= 3:
            raise KeyboardInterrupt

    with pytest.raises(RunInterruptedError, match=f"of {PLANNED} cells measured"):
        measured(store, stop, scheduler=scheduler)
    kept = kept_cells(store)
    assert 3 <= len(kept) < PLANNED
    assert measured(store, scheduler=scheduler).computed == PLANNED - len(kept)
    assert contents(store) == expected


def kept_cells(store: Store) -> set[Cell]:
    """What the journal holds of scores."""
    journal = Record(store).journal
    lines = journal.read_text().splitlines() if journal.is_file() else []
    return {Cell(**record["cell"]) for line in lines if "cell" in (record := json.loads(line))}


def test_a_worker_of_other_code_is_refused(
    scheduler: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(dask_cluster, "code_of", lambda tasks: "not what a worker finds")
    with pytest.raises(OtherCodeError, match="other code for fake-"):
        measured(Store(tmp_path), scheduler=scheduler)
    assert kept_cells(Store(tmp_path)) == set()


def test_what_measures_a_task_is_of_its_data_and_methods_alone() -> None:
    parts = fake_cluster.parts()
    of_a, *_ = tasks_of(cells("fake-a", parts=parts), parts, {})
    again = replace(of_a, condition="other")
    assert dask_cluster.code_of([of_a]) == dask_cluster.code_of([of_a, again])
    from benchmark.plan.parts import installed_parts

    real = tasks_of(cells("pd-maskless-cube", "nominal"), installed_parts(), {})
    assert dask_cluster.code_of(real) != dask_cluster.code_of([of_a])


@pytest.mark.parametrize(
    "address",
    [
        "nowhere",
        *[pytest.param(a, marks=pytest.mark.slow) for a in ("tcp://127.0.0.1:1", "tcp://")],
    ],
)
def test_an_address_where_nothing_answers_is_named(
    address: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(dask_cluster, "_PATIENCE_S", 0.2)
    with pytest.raises(ClusterError, match=f"no Dask scheduler answers at {address}"):
        measured(Store(tmp_path), scheduler=address)
