"""Every dataset's data are pinned, and do not change in silence."""

from __future__ import annotations

import dataclasses
import re

import fake_plan
import numpy as np
import pytest
from fake_atlas import Diodes, FakeBound
from fake_results import pin as made_pin

from benchmark.datasets.samples import HEAD, head_hash, samples_hash
from benchmark.plan import combinations as plan
from benchmark.progress import silent
from benchmark.results.components import current
from benchmark.results.record import open_record
from benchmark.results.store import Store
from benchmark.running import condition_data, pinning, runner
from benchmark.running.condition_data import rms_bound
from benchmark.running.pinning import UnversionedChangeError, changed_heads


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


def test_the_error_names_every_data_set_with_its_first_change_and_keeps_all():
    known = {one.place: one for one in (made_pin(), made_pin("calibration"), made_pin(dataset="a"))}
    changed = [made_pin("calibration", n=4), made_pin(data_hash="x"), made_pin(dataset="a", n=9)]
    with pytest.raises(UnversionedChangeError) as caught:
        pinning.require_versions(known, changed)
    said = str(caught.value)
    assert re.findall(r"(\w) \((\w \w+): n (\d), pinned (\d)\)", said) == [
        ("a", "c test", "9", "3"),
        ("d", "c calibration", "4", "3"),
    ]
    assert "`version`" in said
    assert list(caught.value.changes) == ["a", "d"]
    assert len(caught.value.changes["d"]) == 2


def test_only_what_is_missing_is_generated_and_counted(tmp_path):
    class Broken(Diodes):
        def generate(self, condition, split, n=None):
            raise OSError("no data\ntoday")

    parts = fake_plan.parts(presets=(Diodes(n=40), Broken(name="z", conditions=("quiet",))))
    components = current(parts)
    with open_record(Store(tmp_path)) as record:
        seen = []
        first = pinning.pin_missing(
            record, components, parts, workers=1, progress=lambda *said: seen.append(said)
        )
        assert (first.kept, first.renewed) == (0, 2)
        assert 0.0 < first.seconds < 600.0
        (warning,) = first.warnings
        assert warning.startswith("z quiet: ")
        assert warning.endswith(": OSError: no data today")
        assert seen == [
            (0, 3, ""), (1, 3, "fake-diodes quiet"), (2, 3, "fake-diodes noisy"), (3, 3, "z quiet"),
        ]  # fmt: skip
        del record.pins["fake-diodes", "noisy", "repeat"]
        del record._pin_keys["fake-diodes", "noisy", "repeat"]
        again = pinning.pin_missing(
            record, components, parts, workers=1, progress=silent, datasets=["fake-diodes"]
        )
        assert (again.kept, again.renewed, again.warnings) == (1, 1, ())


def test_a_pinned_bound_is_the_root_mean_square_of_the_observable_first():
    angle = np.array([3.0, np.inf, 4.0, 5.0, 100.0])
    bound = FakeBound(angle, np.isfinite(angle))
    assert rms_bound(bound, HEAD) == pytest.approx(np.sqrt(50 / 3), rel=1e-4)
    assert rms_bound(bound, 2) == 3.0
    assert rms_bound(bound) == pytest.approx(np.sqrt(10050 / 4), rel=1e-4)
    assert rms_bound(FakeBound(angle, np.zeros(5, bool))) is None


def test_scores_of_data_that_were_pinned_anew_are_dropped(store):
    there = parts(Diodes(), Diodes(name="fake-second"))
    runner.run(plan.cells(parts=there), store, progress=silent, parts=there)
    update(store, parts=parts(Diodes(version=2, seed=8), Diodes(name="fake-second")))
    assert {row["dataset"] for row in store.rows()} == {"fake-second"}
