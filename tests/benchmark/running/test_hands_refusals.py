"""Workers that cannot be had, see no directory, or fail; and kernels compiled with the fakes."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fake_atlas
import fake_plan
import numpy as np
import pytest

import benchmark.experiments
from algorithms.chain import Chain
from algorithms.contract import FeatureKind
from benchmark.plan.parts import Parts
from benchmark.running import backend, cluster, compiling, experiment, workers
from benchmark.running.cluster import Cluster, ClusterError, OtherCodeError, WorkerLostError
from benchmark.running.task import Task, TaskResult


class Now:
    """A pool that does what it is given at once, in this process."""

    def submit(self, work: Callable[..., Any], *given: Any) -> Any:
        result = work(*given)
        return SimpleNamespace(
            result=lambda: result, add_done_callback=lambda call: call(future_of(result))
        )


def future_of(result: Any) -> Any:
    return SimpleNamespace(result=lambda: result)


def test_items_beyond_two_a_worker_are_given_as_others_are_done(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: list[float] = []

    @contextmanager
    def hands_of(count: int) -> Iterator[workers.LocalHands]:
        yield workers.LocalHands(Now(), count)

    def items() -> Iterator[float]:
        for number in range(9):
            given.append(number)
            yield float(number)

    monkeypatch.setattr(workers, "hands_of", hands_of)
    results = workers.as_completed(math.sqrt, items(), 2)
    assert next(results) == 0.0
    assert len(given) == 5, "two a worker, and one for that which is done"
    assert list(results) == [math.sqrt(number) for number in range(1, 9)]


def test_workers_that_were_begun_before_the_pool_broke_are_killed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    killed: list[str] = []

    def no_pool(*_: Any, **__: Any) -> None:
        raise OSError("no more processes")

    monkeypatch.setattr(workers, "get_reusable_executor", no_pool)
    monkeypatch.setattr(workers, "_kill", lambda: killed.append("all"))
    with pytest.raises(OSError, match="no more processes"), workers.hands_of(2):
        pytest.fail("there are no hands")
    assert killed == ["all"]


class KilledError(Exception):
    """Stands in for Dask's."""


class Finished(list[Any]):
    add = list.append

    def __next__(self) -> Any:
        return self.pop(0)


class Client:
    loop = None

    def submit(self, work: Any, *, pure: bool) -> Any:
        return SimpleNamespace(result=work, release=lambda: None)


@pytest.mark.parametrize(
    ("error", "told", "message"),
    [
        (KilledError("of it"), WorkerLostError, "workers of tcp://somewhere:1 were killed"),
        (OtherCodeError("of another version"), OtherCodeError, "of another version"),
        (
            MemoryError("no room"),
            ClusterError,
            "a worker of tcp://somewhere:1 could not measure: MemoryError: no room",
        ),
    ],
)
def test_what_a_clusters_worker_dies_of_is_told_by_name(
    error: Exception, told: type[Exception], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    dask = SimpleNamespace(as_completed=lambda loop: Finished(), KilledWorker=KilledError)
    monkeypatch.setattr(cluster, "import_module", lambda name: dask)
    monkeypatch.setattr(cluster, "code_of", lambda tasks: "the same")
    hands = Cluster(Client(), "tcp://somewhere:1")

    def fail(_: Any) -> None:
        raise error

    work: Any = type("Work", (), {"tasks": (), "__call__": fail})()
    hands.give(work)
    with pytest.raises(told, match=message) as raised:
        hands.take()
    assert error in {raised.value, raised.value.__cause__}


@pytest.mark.parametrize("seen", [True, False])
def test_a_cluster_keeps_stages_only_where_all_its_workers_see_them(
    seen: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Hands:
        def sees(self, directory: Path) -> bool:
            return seen

        def workers(self) -> int:
            return 1

    @contextmanager
    def connected(address: str) -> Iterator[Hands]:
        yield Hands()

    kept_by: list[Any] = []

    def shared_out(tasks: Any, *_: Any, kept: Any) -> Iterator[Any]:
        kept_by.append(kept)
        yield from ((task, TaskResult(task, (), ()), 1.0) for task in tasks)

    monkeypatch.setattr(backend, "connect", connected)
    monkeypatch.setattr(backend, "shared_out", shared_out)
    kept: Any = SimpleNamespace(files=SimpleNamespace(directory=Path("stages")))
    preset: Any = fake_atlas.Diodes()
    extractor: Any = fake_atlas.Currents
    task = Task(preset, "quiet", extractor, ())
    (result,) = backend.outcomes([task], 1, "tcp://somewhere:1", kept=kept)
    assert result.task is task
    assert kept_by == [kept if seen else None]


@pytest.mark.parametrize(("text", "count"), [("", 0), ("class A(Report): ...\nB = Report\n", 1)])
def test_a_module_that_defines_no_experiment_is_named(
    text: str, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = "only_here" if count else "nothing_here"
    (tmp_path / f"{name}.py").write_text(f"from benchmark.running.experiment import Report\n{text}")
    monkeypatch.setattr(benchmark.experiments, "__path__", [str(tmp_path)])
    full = f"benchmark.experiments.{name}"
    monkeypatch.delitem(sys.modules, full, raising=False)
    if count:
        monkeypatch.setattr(experiment.Report, "name", "counted", raising=False)
        assert list(experiment.experiments()) == ["counted"]
    else:
        with pytest.raises(ValueError, match=f"{full}: expected one experiment, got 0"):
            experiment.experiments()
    sys.modules.pop(full, None)


def test_an_experiment_passes_and_has_no_pictures_unless_it_says_otherwise(tmp_path: Path) -> None:
    class Squares(experiment.RecordedExperiment[str]):
        name = "squares"

        def keys(self) -> dict[str, str]:
            return {"2": "key", "3": "key"}

        def tasks(self, cells: Any) -> list[Any]:
            return [cells]

        @staticmethod
        def measure(task: Any) -> list[Any]:
            return []

    class Sums(experiment.Report[str]):
        name = "sums"

        def cells(self) -> list[str]:
            return ["1"]

        def tasks(self, cells: Any) -> list[Any]:
            return [cells]

        @staticmethod
        def measure(task: Any) -> list[Any]:
            return []

        def lines(self, rows: Any) -> Iterator[str]:
            yield "1"

    squares = Squares(tmp_path)
    assert squares.cells() == ["2", "3"]
    assert squares.pictures() == {}
    assert Sums(tmp_path).passes({"1": {}})


class Measuring(fake_atlas.Currents):
    """Measures as the contract asks, and tells what."""

    def measure(self, observations: Any, bad: Any = None) -> Any:
        fake_atlas.log(f"measure {np.asarray(observations).dtype} {len(observations)}")
        return SimpleNamespace(features=np.asarray(observations, dtype=float))


def chain_of(model: Any) -> Any:
    compensation: Any = SimpleNamespace(
        about=fake_atlas.LeastSquares.about.__class__(
            name="fake-compensation", taxonomy="OCM", accepts=frozenset({FeatureKind.SIGNALS})
        )
    )
    return Chain((compensation,), model)


def test_every_data_set_is_made_and_every_method_called_on_what_it_fits(
    log: Callable[[], list[str]],
) -> None:
    plain = fake_plan.parts(presets=(fake_atlas.Diodes(n=40),))
    models: Any = (fake_atlas.LeastSquares, fake_atlas.Choosy)
    # one reads frames, of which there are none
    extractors: Any = (Measuring, fake_atlas.Framed)
    chain = chain_of(fake_atlas.LeastSquares)
    known = Parts(
        plain.presets,
        {one.about.name: one for one in extractors},
        {
            **{model.about.name: model for model in models},
            chain.about.name: chain,
        },
    )
    steps: list[tuple[int, int, str]] = []

    def progress(done: int, total: int, what: str, _: float | None = None) -> None:
        steps.append((done, total, what))

    assert compiling.compile_kernels(1, progress, parts=known) == 4
    names = ["fake-diodes", "fake-currents", "fake-choosy", "fake-least-squares"]
    assert steps == [(done, 4, name) for done, name in enumerate(names, start=1)]
    lines = log()
    assert "generate fake-diodes quiet calibration first 1" in lines
    assert lines.count("bound fake-diodes quiet test") == 1, "no condition with kernels of its own"
    # readings that are made, and those that are kept, which nobody may write to
    assert [line for line in lines if line.startswith("measure")] == ["measure float64 2"] * 2
    assert "fit fake-choosy" in lines
