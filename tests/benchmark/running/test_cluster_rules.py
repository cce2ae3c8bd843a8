"""What is sent to a cluster, and with which code: no cluster is started."""

from __future__ import annotations

from dataclasses import replace

import fake_atlas
import fake_cluster
import pytest

from benchmark.running import cluster
from benchmark.running.task import Task


def test_a_preset_s_code_is_part_of_a_task_s(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "closure_digest", lambda *entries: "\n".join(entries))
    task = Task(fake_atlas.Diodes(), "quiet", fake_atlas.Currents, (), 0)
    other = replace(task, preset=fake_cluster.Watched())
    assert cluster.code_of([task]) != cluster.code_of([other])
