"""What is sent to a cluster, and with which code: no cluster is started."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import fake_atlas
import fake_cluster
import pytest

from benchmark.running import cluster
from benchmark.running.cluster import Cluster, ClusterError
from benchmark.running.task import Task


class Finished(list[Any]):
    """Stands in for what Dask gives back, in order."""

    add = list.append

    def __next__(self) -> Any:
        return self.pop(0)


class Client:
    """Two workers that are done at once."""

    loop = None

    def ncores(self) -> dict[str, int]:
        return {"first": 1, "second": 1}

    def submit(self, work: Any, *, pure: bool) -> Any:
        assert not pure, "what was measured before is measured again"
        return SimpleNamespace(result=work, release=lambda: None)


@pytest.fixture
def hands(monkeypatch: pytest.MonkeyPatch) -> Cluster:
    dask = SimpleNamespace(as_completed=lambda loop: Finished(), KilledWorker=KeyError)
    monkeypatch.setattr(cluster, "import_module", lambda name: dask)
    monkeypatch.setattr(cluster, "code_of", lambda tasks: "the same")
    return Cluster(Client(), "tcp://somewhere:1")


def test_each_worker_has_one_thing_in_hand_and_one_sent_ahead(hands: Cluster) -> None:
    work: Any = type("Work", (), {"tasks": (), "__call__": lambda self: 7})()
    given = 0
    while hands.is_free() and given < 9:
        hands.give(work)
        given += 1
    assert given == 4
    assert hands.take() == 7
    assert hands.is_free()


def test_a_preset_s_code_is_part_of_a_task_s(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "closure_digest", lambda *entries: "\n".join(entries))
    task = Task(fake_atlas.Diodes(), "quiet", fake_atlas.Currents, (), 0)
    other = replace(task, preset=fake_cluster.Watched())
    assert cluster.code_of([task]) != cluster.code_of([other])


@pytest.fixture(params=[True, False])
def collecting(request: pytest.FixtureRequest) -> Iterator[bool]:
    """Whether garbage is collected before; it is afterwards."""
    wanted: bool = request.param
    if not wanted:
        gc.disable()
    yield wanted
    gc.enable()


def test_garbage_is_collected_as_before_once_a_connection_failed(
    collecting: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    during: list[bool] = []

    def client(*_: Any, **__: Any) -> Any:
        during.append(gc.isenabled())
        raise OSError("nobody there")

    monkeypatch.setattr(gc, "collect", lambda: 0)  # takes long where much is loaded
    monkeypatch.setattr(cluster, "import_module", lambda name: SimpleNamespace(Client=client))
    with pytest.raises(ClusterError, match="nobody there"), cluster.connect("tcp://nowhere:1"):
        pass
    assert during == [False]
    assert gc.isenabled() is collecting
