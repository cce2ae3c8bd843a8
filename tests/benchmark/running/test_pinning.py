"""Every dataset's data are pinned, and do not change in silence."""

from __future__ import annotations

import dataclasses

import fake_plan
import pytest
from fake_atlas import Diodes

from benchmark import datasets
from benchmark.contract import SPLITS, UnknownNameError
from benchmark.datasets.samples import HEAD, head_hash, samples_hash
from benchmark.plan import combinations as plan
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import silent
from benchmark.results.record import open_record
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import condition_data, pinning, runner
from benchmark.running.pinning import UnversionedChangeError, changed_heads

SMALL = ("pd-maskless-cube", "oi-maskless-pyramid")  # a second each


@dataclasses.dataclass(frozen=True)
class Unmeasurable(Diodes):
    """Nothing reads a rolling image of it."""

    name: str = "fake-unmeasurable"
    observation: str = "nothing reads this"


@dataclasses.dataclass(frozen=True)
class Missing(Diodes):
    name: str = "fake-missing"

    def generate(self, condition, split, n=None):
        raise OSError("no data today")


def parts(*presets):
    return fake_plan.parts(presets=presets)


@pytest.fixture
def store(tmp_path):
    condition_data.forget()
    return Store(tmp_path / "store")


def update(store, **options):
    return pinning.update(store, progress=silent, **options)


def contents(store):
    return {
        path: (path.read_bytes(), path.stat().st_mtime_ns)
        for path in store.directory.rglob("*.*")
        if path.is_file() and path.parent != store.work_directory
    }


def test_a_run_pins_what_it_measures_and_the_update_what_remains(store):
    there = parts(Diodes(), Unmeasurable())
    runner.run(plan.cells(parts=there), store, progress=silent, parts=there)
    assert {place[0] for place in store.pins()} == {"fake-diodes"}
    measured = store.pins()
    done = update(store, parts=there)
    assert (done.kept, done.renewed, done.warnings) == (2, 2, ())
    assert set(store.pins()) == pinning.places(there)
    assert store.pins().items() >= measured.items()
    assert len(store.rows()) == 4, "scores stay"
    # and the other way round: a run keeps the pins of what nothing reads
    runner.run(plan.cells(parts=there), store, progress=silent, parts=there)
    assert set(store.pins()) == pinning.places(there)


def test_nothing_is_generated_twice(store, log):
    there = parts(Diodes())
    update(store, parts=there)
    generated = [line for line in log() if line.startswith("generate")]
    assert len(generated) == len(set(generated)) == 6
    before, done = contents(store), log()
    assert update(store, parts=there).renewed == 0
    assert log() == done
    assert contents(store) == before


def test_a_pin_says_what_was_generated(store):
    preset = Diodes(dark=0.125)
    update(store, parts=parts(preset))
    for (_, condition, split), pin in store.pins().items():
        samples = preset.generate(condition, split)
        assert pin.n == len(samples.sun) == (80 if split == "repeat" else 400)
        assert pin.data_hash == samples_hash(samples)
        assert pin.head_hash == head_hash(preset.generate(condition, split, HEAD))
        assert pin.observable == (350 if split == "test" else None)
        assert (pin.bound_deg is not None) is (split == "test")
        assert pin.head_bound_deg is None, "the first samples of the test split are dark"


CHANGES = {
    "every sample": ({"seed": 8}, "calibration: head_hash"),
    "a bound": ({"looseness": 1.01}, "test: head_bound_deg"),
}


@pytest.mark.parametrize(("changed", "said"), CHANGES.values(), ids=CHANGES)
def test_a_change_of_the_first_samples_or_their_bound_is_found_in_the_heads(
    store, log, changed, said
):
    update(store, parts=parts(Diodes(), Diodes(name="fake-second")))
    pins, done = store.pins(), len(log())
    assert changed_heads(pins, [Diodes(), Diodes(name="fake-second")]) == {}
    generated = [line for line in log()[done:] if line.startswith("generate")]
    assert len(generated) == 12
    assert all(line.endswith(f"first {HEAD}") for line in generated)
    found = changed_heads(pins, [Diodes(), Diodes(name="fake-second", **changed)])
    assert list(found) == ["fake-second"]
    assert found["fake-second"][0].startswith(f"quiet {said} ")
    assert {line.split()[0] for line in found["fake-second"]} == {"quiet", "noisy"}


def test_heads_do_not_see_what_comes_later_nor_another_version(store):
    update(store, parts=parts(Diodes()))
    assert changed_heads(store.pins(), [Diodes(late=0.1)]) == {}
    assert changed_heads(store.pins(), [Diodes(seed=8, version=2)]) == {}
    assert changed_heads(store.pins(), [Diodes(name="fake-new")]) == {}
    assert changed_heads({}, [Diodes()]) == {}


GUARDED = {
    **{name: (changed, said.split()[1]) for name, (changed, said) in CHANGES.items()},
    "later samples": ({"late": 0.1}, "data_hash"),
    "what is observable": ({"dark": 0.1}, "observable"),
}
WITHIN = {"every sample": "data_hash", "a bound": "bound_deg"}


@pytest.mark.parametrize("name", GUARDED)
def test_data_or_bounds_that_change_while_the_version_does_not_are_an_error(store, name):
    """It names the data set and nothing is written; with a new version the pins are renewed."""
    others = [Diodes(name="fake-first"), Diodes(name="fake-third")]
    changed = Diodes(name="fake-second", **GUARDED[name][0])
    update(store, parts=parts(*others, Diodes(name="fake-second")))
    before, pins = contents(store), store.pins()
    for _ in range(2):  # the journal of the first does not let the second through
        with pytest.raises(UnversionedChangeError, match="1 data sets") as caught:
            update(store, parts=parts(*others, changed))
        assert list(caught.value.changes) == ["fake-second"]
        assert f": {WITHIN.get(name, GUARDED[name][1])} " in str(caught.value)
        assert contents(store) == before
    update(store, parts=parts(*others, dataclasses.replace(changed, version=2)))
    moved = {place for place, pin in store.pins().items() if pin != pins[place]}
    assert {place[0] for place in moved} == {"fake-second"}
    assert {store.pins()[place].version for place in moved} == {2}


def test_generating_again_tells_what_is_not_as_pinned_and_writes_nothing(store):
    there = parts(Diodes())
    update(store, parts=there)

    def differences(**changed):
        pins = store.pins()
        first = pins.pop(("fake-diodes", "noisy", "test"))
        wrong = Store(store.directory.with_name("wrong"))
        altered = [*pins.values(), dataclasses.replace(first, **changed)]
        wrong.write({}, altered, store.components())
        before = contents(wrong)
        found = pinning.differences(wrong, progress=silent, parts=there)
        assert contents(wrong) == before
        return found

    assert differences() == []
    place = "fake-diodes noisy test"
    (line,) = differences(data_hash="0" * 32)
    assert line.startswith(f"{place}: data_hash ")
    assert line.endswith(f", pinned {'0' * 32}")
    assert differences(n=500) == [f"{place}: n 400, pinned 500"]
    bound = store.pins()["fake-diodes", "noisy", "test"].bound_deg
    assert differences(bound_deg=1.0) == [f"{place}: bound_deg {bound}, pinned 1.0"]
    assert differences(version=3) == [f"{place}: version 1, pinned 3"]
    assert differences(dataset="else") == [f"{place}: not pinned"]
    gone = pinning.differences(store, progress=silent, parts=parts(Diodes(), Missing()))
    assert [line.partition(": ")[0] for line in gone] == [
        "fake-missing noisy",
        "fake-missing quiet",
    ]
    assert all(line.endswith("OSError: no data today") for line in gone)


def test_scores_of_data_that_were_pinned_anew_are_dropped(store):
    there = parts(Diodes(), Diodes(name="fake-second"))
    runner.run(plan.cells(parts=there), store, progress=silent, parts=there)
    update(store, parts=parts(Diodes(version=2, seed=8), Diodes(name="fake-second")))
    assert {row["dataset"] for row in store.rows()} == {"fake-second"}


def test_wrong_calls_are_refused(store):
    with pytest.raises(ValueError, match=r"workers.*1.*0"):
        update(store, workers=0)
    with pytest.raises(UnknownNameError, match="did you mean 'fake-diodes'"):
        update(store, datasets=["fake-diode"], parts=parts(Diodes()))
    with open_record(store), pytest.raises(RuntimeError, match="another runner"):
        update(store, parts=parts(Diodes()))


def _some(*names):
    return Parts({name: datasets.get(name) for name in names}, {}, {})


@pytest.mark.slow
def test_hashes_depend_on_neither_workers_nor_order_nor_company(tmp_path):
    """The published pins, from one process and two, in any order, alone and together."""
    published = {
        place: pin.data_hash for place, pin in Store(PUBLISHED).pins().items() if place[0] in SMALL
    }
    assert set(published) == pinning.places(_some(*SMALL))

    def made(name, *wanted, workers):
        store = Store(tmp_path / name)
        condition_data.forget()
        update(store, workers=workers, parts=_some(*wanted))
        return {place: pin.data_hash for place, pin in store.pins().items()}

    assert made("together", *SMALL, workers=2) == published
    alone = made("alone", SMALL[1], workers=1)
    assert alone == {place: one for place, one in published.items() if place[0] == SMALL[1]}
    backwards = {
        (name, condition, split): samples_hash(datasets.get(name).generate(condition, split))
        for name in reversed(SMALL)
        for condition in reversed(datasets.get(name).conditions)
        for split in reversed(SPLITS)
    }
    assert backwards == published


@pytest.mark.slow
def test_everything_there_is_is_pinned():
    pins = Store(PUBLISHED).pins()
    assert set(pins) == pinning.places(), "run `sunatlas dataset pin`"
    assert len({pin.data_hash for pin in pins.values()}) == len(pins)
    presets = installed_parts().presets
    splits = {name: preset.card()["splits"] for name, preset in presets.items()}
    for (name, _, split), pin in pins.items():
        assert pin.n == splits[name][split]["samples"]
        assert pin.version == presets[name].version
