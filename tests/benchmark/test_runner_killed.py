"""Killing the runner (SIGKILL) loses nothing that was stored and changes no byte of the outcome."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchmark.store import Store
from benchmark.store_journal import Journal

ROOT = Path(__file__).parents[2]
PROGRAM = """
import sys
import fake_atlas
import fake_plan
from benchmark import plan, runner
from benchmark.store import Store

second = fake_atlas.Diodes(name="fake-second")
parts = fake_plan.parts(presets=(fake_atlas.Diodes(), second))
summary = runner.run(plan.cells(parts=parts), Store(sys.argv[1]), int(sys.argv[2]), parts=parts)
print(summary.planned, summary.computed)
"""


def start(directory, workers, log, sleep):
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(ROOT), str(Path(__file__).parent / "fakes")]),
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
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    return [int(number) for number in out.split()]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    directory = tmp_path_factory.mktemp("whole")
    assert finish(start(directory, 1, directory / "log", 0)) == [8, 8]
    return Store(directory)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_killed_run_is_finished_by_the_next_with_identical_bytes(
    uninterrupted, tmp_path, workers
):
    store = Store(tmp_path / "store")
    journal = Journal(store)
    process = start(store.directory, workers, tmp_path / "log", 0.15)
    deadline = time.monotonic() + 60
    while not (journal.path.is_file() and journal.path.read_bytes().count(b'"score"') >= 2):
        assert process.poll() is None, "the run ended before it could be killed"
        assert time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert not store.scores_path.exists(), "killed mid-way, not after the end"
    kept = [json.loads(line) for line in journal.path.read_text().splitlines()]
    stored = {record["run"]["key"]: record["run"] for record in kept if "run" in record}
    assert 2 <= len(stored) < 8

    with journal.path.open("a") as file:  # as if killed while writing a line
        file.write('{"score":{"key"')
    assert finish(start(store.directory, workers, tmp_path / "log2", 0)) == [8, 8 - len(stored)]

    assert store.scores_path.read_bytes() == uninterrupted.scores_path.read_bytes()
    assert store.data_path.read_bytes() == uninterrupted.data_path.read_bytes()
    runs = store.runs()
    assert len(runs) == 8
    for key, run in stored.items():
        assert runs[key] == run, "a stored cell keeps its first time: it was not measured again"
    calibrations = [
        line for line in (tmp_path / "log2").read_text().splitlines() if line.startswith("extract")
    ]
    # one model a unit: each missing cell extracts calibration once and test one to three times
    assert 2 * (8 - len(stored)) <= len(calibrations) <= 4 * (8 - len(stored))
    assert not journal.path.exists()
