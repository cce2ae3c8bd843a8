"""Results on disk: sorted, canonical, whole or not at all, and clear about what is broken."""

import json
import os
import subprocess
import sys

import pytest

from benchmark.content_key import SCHEMA_VERSION
from benchmark.store import Pin, Store, StoreError, UnknownFieldError, replace
from benchmark.store_journal import Journal, StoreLockedError, locked


def row(model="m", dataset="d", **more):
    base = {
        "schema": SCHEMA_VERSION, "key": f"key-{dataset}-{model}", "dataset": dataset,
        "condition": "c", "extractor": "e", "model": model, "status": "ok", "rms_deg": 0.5,
    }  # fmt: skip
    return {**base, **more}


def run_of(score):
    names = ("key", "dataset", "condition", "extractor", "model")
    return {**{name: score[name] for name in names}, "latency_us": 2.0, "time_ratio": 3.0}


def pin(split="test", **more):
    base = {
        "dataset": "d", "condition": "c", "split": split, "version": 1,
        "specification": "s", "data_hash": "h", "n": 3,
    }  # fmt: skip
    return Pin(**{**base, **more})


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "results")


def test_what_is_written_is_read_back_sorted_whatever_the_order(store, tmp_path):
    rows = [row("b"), row("a"), row("a", "c")]
    store.write(rows, map(run_of, rows), [pin(), pin("calibration")])
    assert [(r["dataset"], r["model"]) for r in store.rows()] == [
        ("c", "a"),
        ("d", "a"),
        ("d", "b"),
    ]
    assert set(store.runs()) == {r["key"] for r in rows}
    assert store.pins()["d", "c", "test"] == pin()
    other = Store(tmp_path / "other")
    other.write(rows[::-1], map(run_of, rows[::-1]), [pin("calibration"), pin()])
    for name in ("scores_path", "runs_path", "data_path"):
        assert getattr(other, name).read_bytes() == getattr(store, name).read_bytes()


def test_a_new_store_is_empty(store):
    assert store.rows() == []
    assert store.query(dataset="x") == []
    assert store.frame().empty


def test_queries_filter_and_name_the_nearest_field(store):
    rows = [row("a"), row("b"), row("b", "other", status="failed")]
    store.write(rows, map(run_of, rows[:2]), [])
    assert [r["dataset"] for r in store.query(model=["b", "z"])] == ["d", "other"]
    assert store.query(model="b", status="ok", condition=None) == [rows[1]]
    frame = store.frame(model="b")
    assert list(frame["dataset"]) == ["d", "other"]
    assert frame["time_ratio"][0] == 3.0
    assert frame["time_ratio"].isna()[1]
    with pytest.raises(UnknownFieldError, match="did you mean 'dataset'"):
        store.query(datasett="d")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('{"schema": 1, "key"', "line 2: not JSON"),
        ("[1]", "line 2: expected a JSON object, got list"),
        (json.dumps({"schema": SCHEMA_VERSION}), "line 2: expected text in key, dataset"),
        (json.dumps(row("z", schema=0)), "line 2: written under schema 0"),
        (json.dumps(row("a")), "line 2: d/c/e/a is there twice"),
    ],
)
def test_a_corrupt_line_is_named_by_file_and_number(store, line, message):
    store.write([row("a")], [], [])
    with store.scores_path.open("a") as file:
        file.write(line + "\n")
    with pytest.raises(StoreError, match=message) as caught:
        store.rows()
    assert str(store.scores_path) in str(caught.value)


def test_a_corrupt_pin_or_run_is_named_too(store):
    store.write([], [], [pin()])
    store.data_path.write_text('{"dataset":"d"}\n')
    store.runs_path.write_text("{}\n")
    with pytest.raises(StoreError, match="line 1: not a pin"):
        store.pins()
    with pytest.raises(StoreError, match="line 1: expected a field 'key'"):
        store.runs()


def test_a_failed_write_leaves_the_old_file_and_no_temporary_one(tmp_path, monkeypatch):
    path = tmp_path / "file"
    assert replace(path, "old")
    assert not replace(path, "old"), "unchanged content is not written again"

    def refuse(descriptor):
        raise OSError("disk full")

    monkeypatch.setattr(os, "fsync", refuse)
    with pytest.raises(OSError, match="disk full"):
        replace(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_the_journal_adds_to_the_store_and_loses_only_a_torn_last_line(store):
    store.write([row("a")], [run_of(row("a"))], [])
    journal = Journal(store)
    journal.append([pin()], [(row("b"), run_of(row("b")))])
    journal.append([], [(row("a", key="newer"), run_of(row("a", key="newer")))])
    whole = journal.path.read_bytes()
    journal.path.write_bytes(whole[:-7])
    progress = journal.progress()
    assert {str(cell): r["key"] for cell, r in progress.rows.items()} == {
        "d/c/e/a": "key-d-a", "d/c/e/b": "key-d-b",
    }  # fmt: skip
    assert progress.pins == {pin().place: pin()}
    journal.cut_torn_line()
    journal.append([], [(row("z"), run_of(row("z")))])
    assert {cell.model for cell in journal.progress().rows} == {"a", "b", "z"}


def test_a_journal_line_that_is_not_a_record_is_an_error(store):
    journal = Journal(store)
    journal.append([pin()], [])
    for line, message in [
        ('{"other":1}', "line 2: not a journal record"),
        ("{", "line 2: not JSON"),
    ]:
        text = journal.path.read_text().splitlines()[0]
        journal.path.write_text(f"{text}\n{line}\n")
        with pytest.raises(StoreError, match=message):
            journal.progress()


def test_a_second_runner_is_refused_with_the_first_ones_process(store):
    hold = (
        "import sys, time; from benchmark.store import Store; "
        "from benchmark.store_journal import locked\n"
        "with locked(Store(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", hold, str(store.directory)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as other:
        assert other.stdout.readline() == b"held\n"
        with pytest.raises(StoreLockedError, match=f"process {other.pid}"), locked(store):
            pass
        other.kill()
    with locked(store):
        pass  # the lock went with its process
