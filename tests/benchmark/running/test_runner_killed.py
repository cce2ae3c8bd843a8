"""A runner that is killed or asked to end loses nothing stored and records nothing but results."""

import json
import os
import random
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import fake_plan
import pytest
from fake_atlas import Diodes

from benchmark.plan import combinations as plan
from benchmark.progress import silent
from benchmark.results.record import Record
from benchmark.results.store import Store
from benchmark.running import runner

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
#: The same as a command that ends as it should on a signal.
COMMAND = f"""
def main():
{textwrap.indent(PROGRAM, "    ")}
    return 0

from benchmark.processes import call_to_end
call_to_end(main)
"""
#: Before it: a library's callback, which ignores what is raised in it, as the compiler's does.
SWALLOWING = """
import ctypes, time
sleep, callback = time.sleep, ctypes.CFUNCTYPE(None)
time.sleep = lambda seconds: callback(lambda: sleep(seconds))()
"""


def start(directory, workers, log, sleep, program=PROGRAM):
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(ROOT), str(Path(__file__).parents[1] / "fakes")]),
        "FAKE_ATLAS_LOG": str(log),
        "FAKE_ATLAS_SLEEP": str(sleep),
    }
    return subprocess.Popen(
        [sys.executable, "-c", program, str(directory), str(workers)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # else a run in a shell's background, where Ctrl-C is ignored, hands that on
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
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


def run_here(store):
    """Measure what is missing in this process; return how many cells there are and were missing."""
    parts = fake_plan.parts(presets=(Diodes(), Diodes(name="fake-second")))
    summary = runner.run(plan.cells(parts=parts), store, progress=silent, parts=parts)
    return [summary.planned, summary.computed]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    store = Store(tmp_path_factory.mktemp("whole"))
    assert run_here(store) == [8, 8]
    return store


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
    # one model a task: each missing cell extracts from the three splits once, or has been read from
    # what a worker had kept of it
    assert 0 < len(extractions) <= 3 * (8 - len(stored))
    assert not journal.exists()


@pytest.mark.parametrize(
    ("number", "workers", "before"),
    [
        (signal.SIGINT, 1, SWALLOWING),
        pytest.param(signal.SIGTERM, 1, "", marks=pytest.mark.slow),
        pytest.param(signal.SIGTERM, 1, SWALLOWING, marks=pytest.mark.slow),
        pytest.param(signal.SIGTERM, 2, "", marks=pytest.mark.slow),
    ],
)
def test_what_is_told_to_end_at_any_moment_ends_and_is_no_result(
    uninterrupted, tmp_path, number, workers, before
):
    store = Store(tmp_path / "store")
    journal = Record(store).journal
    process = start(store.directory, workers, tmp_path / "log", 0.25, before + COMMAND)
    deadline = time.monotonic() + 600
    while not (journal.is_file() and b'"score"' in journal.read_bytes()):
        assert process.poll() is None, "the run ended before it could be asked to"
        assert time.monotonic() < deadline
        time.sleep(0.01)
    time.sleep(random.Random(f"{number} {workers} {before}").uniform(0.0, 0.7))
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert "interrupted" in said
    assert said.count("\n") == 1
    lines = [line for line in journal.read_text().splitlines() if '"score"' in line]
    kept = [json.loads(line)["score"] for line in lines]
    assert 1 <= len(kept) < 8
    assert "failed" not in journal.read_text()
    assert run_here(store) == [8, 8 - len(kept)]
    assert contents(store) == contents(uninterrupted)
