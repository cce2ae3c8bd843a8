"""A tidied store holds what today's cells refer to, and nothing else of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import fake_atlas
import fake_plan
import pytest

from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.results.record import StoreLockedError, open_record
from benchmark.results.store import Store
from benchmark.running.runner import run, stale
from benchmark.suites.tidying import TidyResult, tidy, would_tidy
from files import manifest

NOTHING = (0, 0)


def parts(**changes: Any) -> Parts:
    """Two data sets; one condition of each, eight cells, two of them failing."""
    first = fake_atlas.Diodes(n=40, conditions=("quiet",))
    second = replace(first, name="fake-second", **changes)
    return fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Broken, presets=(first, second))


@pytest.fixture
def store(tmp_path: Path) -> Store:
    there = Store(tmp_path / "store")
    run(cells(parts=parts()), there, progress=silent, parts=parts())
    (there.directory / "notes.txt").write_text("mine")
    return there


def contents(store: Store) -> dict[Path, bytes]:
    return {
        path: path.read_bytes()
        for path in store.directory.rglob("*")
        if path.is_file() and path.name not in ("lock", "holder")
    }


def total(found: dict[Path, bytes]) -> int:
    """Bytes of what is kept; the manifest of it is written anew."""
    return sum(len(text) for path, text in found.items() if path.name != manifest.FILE)


def dropped(found: TidyResult) -> tuple[int, int]:
    return found.scores, found.pins


def test_a_store_of_today_s_code_stays_as_it_is(store: Store) -> None:
    before = contents(store)
    for do in (would_tidy, tidy):
        found = do(store, parts=parts())
        assert (dropped(found), found.kept, found.freed) == (NOTHING, 8, 0)
        assert contents(store) == before


def test_scores_and_pins_of_changed_data_go(store: Store) -> None:
    before = contents(store)
    size = total(before)
    now = parts(seed=8)
    result = would_tidy(store, parts=now)
    assert contents(store) == before, "only reported"
    done = tidy(store, parts=now)
    assert result == done
    assert (dropped(done), done.kept) == ((4, 3), 4)
    assert done.freed == size - total(contents(store)) > 0
    assert (store.directory / "notes.txt").read_text() == "mine"
    assert {cell.dataset for cell in store.scores()} == {"fake-diodes"}
    assert {place[0] for place in store.pins()} == {"fake-diodes"}
    assert set(store.components().datasets) == {"fake-diodes"}
    assert dropped(tidy(store, parts=now)) == NOTHING
    fine = [cell for cell in cells("fake-diodes", parts=now) if cell.model != "fake-broken"]
    assert stale(fine, store, parts=now) == []


def test_a_broken_off_run_s_journal_is_taken_in_before(tmp_path: Path) -> None:
    store = Store(tmp_path)

    def stop(done: int, _total: int, _what: str) -> None:
        if done >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(cells(parts=parts()), store, progress=stop, parts=parts())
    assert not store.scores_directory.exists()
    assert tidy(store, parts=parts()).kept == len(store.scores()) == 2


def test_a_store_that_a_runner_writes_to_is_left_alone(store: Store) -> None:
    with open_record(store), pytest.raises(StoreLockedError):
        tidy(store, parts=parts(seed=8))
