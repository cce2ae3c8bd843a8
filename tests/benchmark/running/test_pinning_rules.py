"""What counts as a change of pinned data, rule by rule, on pins made up."""

from __future__ import annotations

import re
from typing import Any

import fake_plan
import numpy as np
import pytest
from fake_atlas import Diodes, FakeBound
from fake_results import pin

from benchmark.datasets.samples import HEAD
from benchmark.progress import silent
from benchmark.results.components import current
from benchmark.results.record import open_record
from benchmark.results.store import Store
from benchmark.running import pinning
from benchmark.running.condition_data import rms_bound
from benchmark.running.pinning import UnversionedChangeError


def by_place(*pins: Any) -> dict[Any, Any]:
    return {one.place: one for one in pins}


def test_a_change_is_one_of_the_same_place_and_version() -> None:
    known = by_place(pin(), pin("calibration"), pin(dataset="e"))
    same = [pin(), pin("repeat", data_hash="new"), pin(dataset="f")]
    assert pinning.unversioned_changes(known, same) == {}
    pinning.require_versions(known, same)
    newer = [pin(version=2, data_hash="x")]
    assert pinning.unversioned_changes(known, newer) == {}
    changed = [pin(data_hash="x"), pin("calibration", n=4), pin(dataset="e", bound_deg=0.5)]
    assert pinning.unversioned_changes(known, changed) == {
        "d": ["c test: data_hash x, pinned h", "c calibration: n 4, pinned 3"],
        "e": ["c test: bound_deg 0.5, pinned 0.25"],
    }


def test_the_error_names_every_data_set_with_its_first_change_and_keeps_all() -> None:
    known = by_place(pin(), pin("calibration"), pin(dataset="a"))
    changed = [pin("calibration", n=4), pin(data_hash="x"), pin(dataset="a", n=9)]
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


def test_only_what_is_missing_is_generated_and_counted(tmp_path: Any) -> None:
    class Broken(Diodes):
        def generate(self, condition: str, split: str, n: int | None = None) -> Any:
            raise OSError("no data\ntoday")

    parts = fake_plan.parts(presets=(Diodes(n=40), Broken(name="z", conditions=("quiet",))))
    components = current(parts)
    with open_record(Store(tmp_path)) as record:
        seen: list[tuple[int, int, str]] = []
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


def test_a_pinned_bound_is_the_root_mean_square_of_the_observable_first() -> None:
    angle = np.array([3.0, np.inf, 4.0, 5.0, 100.0])
    bound = FakeBound(angle, np.isfinite(angle))
    assert rms_bound(bound, HEAD) == pytest.approx(np.sqrt(50 / 3), rel=1e-4)
    assert rms_bound(bound, 2) == 3.0
    assert rms_bound(bound) == pytest.approx(np.sqrt(10050 / 4), rel=1e-4)
    assert rms_bound(FakeBound(angle, np.zeros(5, bool))) is None
