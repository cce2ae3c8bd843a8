"""A store open for writing: what is measured survives a kill, and one process writes at a time."""

import itertools
import subprocess
import sys
from contextlib import suppress

import numpy as np
import pytest
from fake_results import cell, components, numbers, pin

from benchmark.results import record_manifest, samples
from benchmark.results.csv_tables import StoreError
from benchmark.results.record import Record, StoreLockedError, open_record
from benchmark.results.samples import CellErrors, Directions
from benchmark.results.store import Store
from files import manifest


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "results")


def keep_all(record, known=None):
    record.keep(
        known or components(),
        pins=[pin()],
        scores={cell("a"): numbers(), cell("b"): numbers()},
    )


def test_what_is_kept_is_known_to_the_next_before_anything_is_written(store):
    keep_all(Record(store))
    assert not store.components_path.exists()
    record = Record(store)
    assert record.scores == {cell("a"): numbers(), cell("b"): numbers()}
    assert record.pins == {pin().place: pin()}
    assert record.is_scored(cell("a"), components())
    assert record.is_pinned(pin().place, components())


def test_errors_sample_by_sample_survive_a_kill_and_follow_their_scores(store):
    one, other = cell("a", condition="nominal"), cell("b", condition="nominal")
    errors = CellErrors.of([0.1, 0.2], [True, True])
    record = Record(store)
    record.keep(
        components(),
        pins=[pin()],
        scores={one: numbers(), other: numbers(None, status="refused", reason="x")},
        errors={one: errors},
        directions={one.dataset: Directions(np.eye(3)[:2], np.ones(2, bool), np.full(2, 0.01))},
    )
    Record(store).write(components())
    assert samples.read_samples(one.dataset, store.directory)["error_deg"].tolist() == [
        *errors.error_deg.tolist()
    ]
    assert not record_manifest.changes(store.directory, required=True)
    again = Record(store)
    again.drop(scores=lambda cell: cell != one)
    again.write(components())
    assert samples.datasets(store.directory) == ()


def test_a_failure_is_never_what_need_not_be_measured_again_and_a_refusal_is(store):
    record = Record(store)
    record.keep(
        components(),
        scores={
            cell("a"): numbers(None, status="failed", reason="x"),
            cell("b"): numbers(None, status="refused", reason="x"),
        },
    )
    for one in (record, Record(store)):
        assert not one.is_scored(cell("a"), components())
        assert one.is_scored(cell("b"), components())


def test_what_other_code_measured_is_left_out_where_the_new_one_says_anything_of_it(store):
    """One model's code changed and one of its cells was measured again: the other is of neither."""
    with open_record(store) as record:
        record.keep(
            components(),
            scores={cell("a"): numbers(), cell("a", "other"): numbers(), cell("b"): numbers()},
            pins=[pin()],
        )
        record.write(components())
    newer = components(a="newer")
    with open_record(store) as record:
        record.keep(newer, scores={cell("a"): numbers(0.1)})
        record.write(newer.only([cell("a")]))
    assert {one: row["rms_deg"] for one, row in store.scores().items()} == {
        cell("a"): 0.1,
        cell("b"): 0.5,
    }
    assert store.pins() == {pin().place: pin()}


def test_numbers_that_change_are_written_though_what_they_are_of_does_not(store):
    """A failure tried again, and a row no longer wanted: the components are those of before."""
    with open_record(store) as record:
        record.keep(
            components(),
            scores={
                cell("a"): numbers(None, status="failed", reason="x"),
                cell("a", condition="other"): numbers(),
            },
        )
        record.write(components())
    with open_record(store) as record:
        record.keep(components(), scores={cell("a"): numbers(0.25)})
        record.write(components())
    assert store.scores()[cell("a")]["rms_deg"] == 0.25
    with open_record(store) as record:
        record.drop(scores=lambda one: one.condition == "c")
        record.write(components())
    assert set(store.scores()) == {cell("a")}


def test_the_journal_adds_to_the_store_and_loses_only_a_torn_last_line(store):
    with open_record(store) as record:
        record.keep(components(), scores={cell("a"): numbers()})
        record.write(components())
    record = Record(store)
    record.keep(components(), pins=[pin()], scores={cell("b"): numbers()})
    record.keep(components(), scores={cell("a"): numbers(0.1)})
    whole = record.journal.read_bytes()
    record.journal.write_bytes(whole[:-7])
    torn = Record(store)
    assert {one: row["rms_deg"] for one, row in torn.scores.items()} == {
        cell("a"): 0.5,
        cell("b"): 0.5,
    }
    assert torn.pins == {pin().place: pin()}
    with open_record(store) as record:
        record.keep(components(), scores={cell("z"): numbers()})
    assert {one.model for one in Record(store).scores} == {"a", "b", "z"}


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("{", "line 2: not JSON"),
        ('{"key": "k", "other": 1}', r"line 2.*\['key'"),
        ("[1]", "line 2"),
        ('{"pin": {"dataset": "d"}, "key": "k"}', "line 2"),
        ('{"cell": {"datset": "d"}, "score": {}, "key": "k"}', "line 2: not a record"),
    ],
)
def test_a_journal_line_that_is_not_a_record_is_an_error(store, line, message):
    record = Record(store)
    record.keep(components(), pins=[pin()])
    first = record.journal.read_text()
    record.journal.write_text(f"{first}{line}\n")
    with pytest.raises(StoreError, match=message):
        Record(store)


def test_a_second_runner_is_refused_with_the_first_ones_process(store):
    hold = (
        "import sys; from benchmark.results.store import Store; "
        "from benchmark.results.record import open_record\n"
        "with open_record(Store(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", hold, str(store.directory)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as other:
        assert other.stdout.readline() == b"held\n"
        with pytest.raises(StoreLockedError, match=f"process {other.pid}"), open_record(store):
            pass
        other.kill()
    with open_record(store) as record:
        assert record.scores == {}, "the lock went with its process"


class KilledError(BaseException):
    """As by SIGKILL: nothing catches it, and nothing is done after it."""


def fill(store):
    """Keep two scores with their errors, as a run does."""
    one, other = cell("a", condition="nominal"), cell("b", condition="nominal")
    errors = CellErrors.of([0.1, 0.2], [True, True])
    directions = Directions(np.eye(3)[:2], np.ones(2, bool), np.full(2, 0.01))
    with open_record(store) as record:
        record.keep(
            components(),
            pins=[pin()],
            scores={one: numbers(), other: numbers()},
            errors={one: errors, other: errors},
            directions={one.dataset: directions},
        )
        record.write(components())


def drop_one(store):
    with open_record(store) as record:
        record.drop(scores=lambda found: found == cell("b", condition="nominal"))
        record.write(components())


def files(store):
    found = (path for path in store.directory.rglob("*") if path.is_file())
    return {
        path.relative_to(store.directory): path.read_bytes()
        for path in found
        if path.suffix != ".lock"
    }


@pytest.mark.parametrize(("before", "act", "steps"), [(None, fill, 6), (fill, drop_one, 7)])
def test_a_write_killed_after_any_of_its_steps_is_finished_by_the_next(
    tmp_path, monkeypatch, before, act, steps
):
    """As when all went well, though the next may have nothing to write of its own."""
    undisturbed = Store(tmp_path / "undisturbed")
    if before:
        before(undisturbed)
    act(undisturbed)
    kills = 0
    for at in itertools.count():
        store = Store(tmp_path / f"killed-{at}")
        if before:
            before(store)
        with monkeypatch.context() as patch, suppress(KilledError):
            kill_after(at, patch)
            act(store)
            break
        kills += 1
        act(store)
        assert files(store) == files(undisturbed), at
    assert kills >= steps


def kill_after(steps, patch):
    """Kill the first write that comes after some of them."""
    left = iter(range(steps))
    for name in ("replace_file", "finish_interrupted_write"):
        act = getattr(manifest, name)

        def stepped(*given, act=act):
            if next(left, None) is None:
                raise KilledError
            return act(*given)

        patch.setattr(manifest, name, stepped)
