"""Every dataset's data are pinned: once, whatever is measured on them, however they are made."""

from __future__ import annotations

import dataclasses

import fake_plan
import pytest
from fake_atlas import Diodes

from benchmark import data_pins, datasets, leaderboard, plan, runner, runner_unit
from benchmark.content_key import samples_hash
from benchmark.plan_parts import SPLITS, Parts, UnknownNameError, installed
from benchmark.runner_progress import silent
from benchmark.store import PUBLISHED, Store
from benchmark.store_journal import Journal, StoreLockedError, locked

SMALL = ("pd-maskless-cube", "oi-maskless-pyramid")  # a second each


@dataclasses.dataclass(frozen=True)
class Unmeasurable(Diodes):
    """Nothing reads a rolling image of it."""

    name: str = "fake-unmeasurable"
    observation: str = "nothing reads this"


@dataclasses.dataclass(frozen=True)
class Missing(Diodes):
    name: str = "fake-missing"

    def generate(self, condition, split):
        raise OSError("no data today")


def parts(*presets):
    return fake_plan.parts(presets=presets)


@pytest.fixture
def store(tmp_path, monkeypatch):
    runner_unit._kept.clear()
    return Store(tmp_path / "store")


def update(store, **options):
    return data_pins.update(store, progress=silent, **options)


def test_a_run_pins_what_it_measures_and_the_update_what_remains(store):
    there = parts(Diodes(), Unmeasurable())
    runner.run(plan.cells(parts=there), store, progress=silent, parts=there)
    assert {place[0] for place in store.pins()} == {"fake-diodes"}
    measured = store.pins()
    assert data_pins.outdated(store, parts=there) == [
        ("fake-unmeasurable", "quiet"),
        ("fake-unmeasurable", "noisy"),
    ]
    done = update(store, parts=there)
    assert (done.kept, done.renewed, done.warnings) == (2, 2, ())
    assert set(store.pins()) == data_pins.places(there)
    assert store.pins().items() >= measured.items()
    assert store.rows(), "scores stay"
    assert data_pins.outdated(store, parts=there) == []
    assert not Journal(store).path.exists()
    # and the other way round: a full run keeps the pins of what nothing reads
    runner.run(plan.cells(parts=there), store, progress=silent, only_these=True, parts=there)
    assert set(store.pins()) == data_pins.places(there)


def test_nothing_is_generated_twice(store, tmp_path, monkeypatch):
    log = tmp_path / "log"
    monkeypatch.setenv("FAKE_ATLAS_LOG", str(log))
    there = parts(Diodes())
    update(store, parts=there)
    assert len(log.read_text().splitlines()) == 4
    before = store.data_path.read_bytes()
    assert update(store, parts=there).renewed == 0
    assert len(log.read_text().splitlines()) == 4
    assert store.data_path.read_bytes() == before
    runner_unit._kept.clear()
    other = parts(dataclasses.replace(Diodes(), seed=8))
    assert update(store, parts=other).renewed == 2
    assert store.data_path.read_bytes() != before


def test_pins_of_what_is_no_longer_there_go(store):
    update(store, parts=parts(Diodes(), Unmeasurable()))
    update(store, parts=parts(Diodes()))
    assert {place[0] for place in store.pins()} == {"fake-diodes"}


def test_generating_again_tells_what_is_not_as_pinned_and_writes_nothing(store):
    there = parts(Diodes())
    update(store, parts=there)

    def told(**changed):
        first, *rest = store.pins().values()
        wrong = Store(store.directory.with_name("wrong"))
        wrong.write([], [], [*rest, dataclasses.replace(first, **changed)])
        before = wrong.data_path.read_bytes()
        found = data_pins.differences(wrong, progress=silent, parts=there)
        assert wrong.data_path.read_bytes() == before
        return found

    assert told() == []
    place = "fake-diodes noisy calibration"
    (line,) = told(data_hash="0" * 32)
    assert line.startswith(f"{place}: data_hash ")
    assert line.endswith(f", pinned {'0' * 32}")
    assert told(n=5) == [f"{place}: n 400, pinned 5"]
    assert told(bound_deg=1.0) == [f"{place}: bound_deg None, pinned 1.0"]
    assert told(specification="x") == [f"{place}: pinned for other code or parameters"]
    assert told(split="else") == [f"{place}: not pinned"]
    gone = data_pins.differences(store, progress=silent, parts=parts(Diodes(), Missing()))
    assert gone == [
        f"fake-missing {condition}: cannot be generated: OSError: no data today"
        for condition in ("noisy", "quiet")
    ]


def test_data_that_cannot_be_made_are_told_and_the_rest_is_pinned(store):
    done = update(store, parts=parts(Missing(), Diodes()))
    assert done.warnings == tuple(
        f"fake-missing {condition}: cannot be generated: OSError: no data today"
        for condition in ("quiet", "noisy")
    )
    assert len(store.pins()) == 4


@pytest.mark.usefixtures("readings_only")
def test_the_leaderboard_names_what_is_not_pinned(store):
    there = parts(Diodes(), Unmeasurable())
    leaderboard.update(store.directory, progress=silent, parts=there)
    assert leaderboard.check(store.directory, parts=there, stored_only=True) == []
    pins = store.pins()
    gone = ("fake-unmeasurable", "noisy", "test")
    store.write(store.rows(), store.runs().values(), [p for p in pins.values() if p.place != gone])
    found = leaderboard.check(store.directory, parts=there, stored_only=True)
    assert [(d.file, d.cell, d.committed) for d in found] == [
        ("data.jsonl", "fake-unmeasurable/noisy/pin", "absent")
    ]
    stale = [dataclasses.replace(p, specification="x") for p in pins.values() if p.place == gone]
    kept = [p for p in pins.values() if p.place != gone]
    store.write(store.rows(), store.runs().values(), [*kept, *stale])
    found = leaderboard.check(store.directory, parts=there, stored_only=True)
    assert [d.cell for d in found] == ["fake-unmeasurable/noisy/specification"]


def test_wrong_calls_are_refused(store):
    with pytest.raises(ValueError, match="workers must be at least 1; got 0"):
        update(store, workers=0)
    with pytest.raises(UnknownNameError, match="did you mean 'fake-diodes'"):
        update(store, datasets=["fake-diode"], parts=parts(Diodes()))
    with locked(store), pytest.raises(StoreLockedError):
        update(store, parts=parts(Diodes()))


def test_a_pin_carries_the_bound_of_the_test_split(store):
    preset = datasets.get("oi-maskless-pyramid")
    update(store, parts=_some("oi-maskless-pyramid"))
    for condition in preset.conditions:
        pin = store.pins()[preset.name, condition, "test"]
        assert pin.bound_deg == pytest.approx(preset.bound(condition).rms_deg, rel=1e-5)
        assert store.pins()[preset.name, condition, "calibration"].bound_deg is None


def _some(*names):
    return Parts({name: datasets.get(name) for name in names}, {}, {})


def test_hashes_depend_on_neither_workers_nor_order_nor_company(tmp_path):
    """The published pins, from one process and two, in any order, alone and together."""
    published = {
        place: pin.data_hash for place, pin in Store(PUBLISHED).pins().items() if place[0] in SMALL
    }
    assert set(published) == data_pins.places(_some(*SMALL))

    def made(name, *wanted, workers):
        store = Store(tmp_path / name)
        runner_unit._kept.clear()
        update(store, workers=workers, parts=_some(*wanted))
        return {place: pin.data_hash for place, pin in store.pins().items()}

    assert made("together", *SMALL, workers=2) == published
    alone = {**made("a", SMALL[1], workers=1), **made("b", SMALL[0], workers=1)}
    assert alone == published
    backwards = {
        (name, condition, split): samples_hash(datasets.get(name).generate(condition, split))
        for name in reversed(SMALL)
        for condition in reversed(datasets.get(name).conditions)
        for split in reversed(SPLITS)
    }
    assert backwards == published


def test_everything_there_is_is_pinned():
    pins = Store(PUBLISHED).pins()
    assert set(pins) == data_pins.places(), "run `sunatlas dataset pin`"
    assert len({pin.data_hash for pin in pins.values()}) == len(pins)
    presets = installed().presets
    for (name, _, split), pin in pins.items():
        assert pin.n == presets[name].card()["splits"][split]["samples"]
        assert pin.version == presets[name].version
