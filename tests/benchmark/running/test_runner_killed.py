"""Killing the runner (SIGKILL) loses nothing that was stored and changes no byte of the outcome."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchmark.results.record import Record
from benchmark.results.store import Store

ROOT = Path(__file__).parents[3]
PROGRAM = """
import sys
import fake_atlas
import fake_plan
from benchmark.plan import combinations as plan
from benchmark.running import runner
from benchmark.results.store import Store

second = fake_atlas.Diodes(name="fake-second")
parts = fake_plan.parts(presets=(fake_atlas.Diodes(), second))
summary = runner.run(plan.cells(parts=parts), Store(sys.argv[1]), int(sys.argv[2]), parts=parts)
print(summary.planned, summary.computed)
"""


def start(directory, workers, log, sleep):
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(ROOT), str(Path(__file__).parents[1] / "fakes")]),
        "FAKE_ATLAS_LOG": str(log),
        "FAKE_ATLAS_SLEEP": str(sleep),
    }
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(directory), str(workers)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finish(process):
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    return [int(number) for number in out.split()]


def contents(store):
    return {
        path.relative_to(store.directory): path.read_bytes()
        for path in [*store.directory.glob("*.*"), *store.scores_directory.glob("*.*")]
        if path.is_file()
    }


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    directory = tmp_path_factory.mktemp("whole")
    log = tmp_path_factory.mktemp("log") / "log"
    assert finish(start(directory, 1, log, 0)) == [8, 8]
    return Store(directory)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_a_killed_run_is_finished_by_the_next_with_identical_bytes(
    uninterrupted, tmp_path, workers
):
    store = Store(tmp_path / "store")
    journal = Record(store).journal
    process = start(store.directory, workers, tmp_path / "log", 0.4)
    deadline = time.monotonic() + 600
    while not (journal.is_file() and journal.read_bytes().count(b'"score"') >= 2):
        assert process.poll() is None, "the run ended before it could be killed"
        assert time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert not store.components_path.exists(), "killed mid-way, not after the end"
    kept = [json.loads(line) for line in journal.read_text().splitlines()]
    stored = [record for record in kept if "score" in record]
    assert 2 <= len(stored) < 8

    with journal.open("a") as file:  # as if killed while writing a line
        file.write('{"score":{"key"')
    assert finish(start(store.directory, workers, tmp_path / "log2", 0)) == [8, 8 - len(stored)]

    assert contents(store) == contents(uninterrupted)
    assert len(store.rows()) == 8
    extractions = [
        line for line in (tmp_path / "log2").read_text().splitlines() if line.startswith("extract")
    ]
    # one model a task: each missing cell extracts from the three splits once
    assert len(extractions) == 3 * (8 - len(stored))
    assert not journal.exists()
