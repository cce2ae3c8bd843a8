"""The standard datasets: found by walking, seeded by name, the same whenever they are made."""

from __future__ import annotations

import functools
import json
import math
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from algorithms.contract import Observation
from benchmark import datasets
from benchmark.canonical import canonical_json
from benchmark.datasets import Samples, UnknownDatasetError, samples_hash
from benchmark.datasets.card import differences, merge
from benchmark.datasets.parameters import describe
from benchmark.simulator.sensors.frames import FrameSensor

ROOT = Path(__file__).parents[3]
NAMES = datasets.names()
#: The first and the last condition of each; that all are as pinned, and differ, pins check.
ENDS = [(name, datasets.get(name).conditions[k]) for name in NAMES for k in (0, -1)]
SPLITS = ("calibration", "test")
#: Samples of a split that stand for all of them; that all are as pinned, runs and pins check.
FEW = 3


@functools.cache
def first(name: str, condition: str, split: str) -> Samples:
    return datasets.get(name).generate(condition, split, FEW)


@functools.cache
def card_of(name: str) -> dict[str, Any]:
    return datasets.get(name).card()  # a second for masks of a thousand holes


def test_unknown_names_are_answered_with_the_nearest() -> None:
    with pytest.raises(UnknownDatasetError, match="did you mean 'cmos-single-aperture'") as caught:
        datasets.get("cmos-single-apertures")
    assert caught.value.nearest == "cmos-single-aperture"
    assert isinstance(caught.value, LookupError)
    assert isinstance(caught.value, ValueError)
    preset = datasets.get("pd-maskless-cube")
    with pytest.raises(ValueError, match="no condition 'warm'; it has nominal"):
        preset.generate("warm", "test")
    with pytest.raises(ValueError, match="'train'"):
        preset.generate("nominal", "train")


#: Type, dimensions and whether there are windows, by what is observed.
ARRAYS = {
    Observation.FRAMES: (np.uint16, 3, True),
    Observation.PROFILES: (np.uint16, 2, False),
    Observation.CURRENTS: (np.float64, 2, False),
    Observation.EVENTS: (np.float64, 3, False),
}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "condition"), ENDS)
def test_samples_are_what_the_card_says(name: str, condition: str) -> None:
    preset = datasets.get(name)
    kind, dimensions, windows = ARRAYS[preset.observation]
    for split in SPLITS:
        samples = first(name, condition, split)
        assert samples.sun.shape == (FEW, 3)
        assert np.linalg.norm(samples.sun, axis=1) == pytest.approx(1.0, abs=1e-14)
        assert len(samples.observations) == FEW
        assert samples.observations.dtype == kind
        assert samples.observations.ndim == dimensions
        if windows:
            assert samples.origin_px is not None
            assert samples.origin_px.shape == (FEW, 2)
        else:
            assert samples.origin_px is None
        context = samples.context or {}
        assert set(context) == set(card_of(name).get("context", ()))
        assert all(len(column) == FEW for column in context.values())
        if preset.observation is Observation.EVENTS:
            missing = np.isnan(samples.observations)
            assert (missing.all(axis=2) == missing.any(axis=2)).all()
            assert (np.diff(missing[..., 0].astype(int), axis=1) >= 0).all(), "at the end"
            assert not missing[:, 0].any()
        else:
            assert np.isfinite(samples.observations).all()


def test_differences_of_objects_are_taken_back_by_merging() -> None:
    base = {"a": 1, "b": {"type": "X", "c": 2, "d": [1, 2]}, "e": None, "f": {"g": 1, "h": 2}}
    for other in (
        base,
        {**base, "a": None},
        {**base, "b": None, "e": {"type": "Z", "y": 1}},
        {**base, "b": {"type": "X", "c": 2, "d": [1]}},
        {**base, "b": {"type": "Y", "x": 0}, "f": {"g": None, "h": 2}},
        {**base, "i": None},
        {**base, "i": {"j": 1}, "k": {"type": "X", "c": 2}},
    ):
        assert merge(base, differences(base, other)) == other
    assert differences(base, {**base, "b": {"type": "X", "c": 3, "d": [1, 2]}}) == {"b": {"c": 3}}
    with pytest.raises(ValueError, match=r"\['a', 'b', 'e', 'f'\].*\['a'\]"):
        differences(base, {"a": 1})


@pytest.mark.parametrize("name", NAMES)
def test_cards_and_parameters_are_plain_json(name: str) -> None:
    preset = datasets.get(name)
    card = card_of(name)
    assert json.loads(json.dumps(card, allow_nan=False)) == card
    assert list(card["conditions"]) == list(preset.conditions)
    for condition in preset.conditions:
        assert datasets.parameters_of(card, condition) == preset.parameters(condition)
    texts = {json.dumps(preset.parameters(c), sort_keys=True) for c in preset.conditions}
    assert len(texts) == len(preset.conditions)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_conditions_share_the_sun_and_calibration_is_apart_from_test(name: str) -> None:
    preset = datasets.get(name)
    card = card_of(name)
    nominal = {}
    for split in SPLITS:
        suns = [preset.scene(condition, split).sun for condition in preset.conditions]
        assert suns[0].shape == (card["splits"][split]["samples"], 3)
        assert all(np.array_equal(sun, suns[0]) for sun in suns)
        samples = first(name, "nominal", split)  # of a calibration, `sun` is what the bench says
        true = samples.sun if samples.true_sun is None else samples.true_sun
        assert np.array_equal(true, suns[0][:FEW])
        nominal[split] = suns[0]
    assert (nominal["test"] @ nominal["calibration"].T).max() < 1.0


#: One of each kind of sensor. That all sets are the same bytes in another process, pins check.
KINDS = (
    *("cmos-lens", "cmos-single-aperture", "event-l-slit", "ltf-maskless-cube", "pd-code-dial"),
    *("pd-orbit", "pda-slit", "psd-single-aperture", "pva-maskless-sphere", "qpd-single-aperture"),
)
#: Those of them that are simulated in moments: the classes that make samples are the same for all.
QUICK_KINDS = set(KINDS) - {"cmos-single-aperture", "event-l-slit"}


@pytest.mark.slow
def test_generation_depends_on_neither_order_nor_process_nor_import() -> None:
    """A fresh process, conditions backwards, must give the same bytes; and import nothing heavy."""
    code = f"""
import sys
from benchmark import datasets
heavy = [m for m in ("numba", "scipy", "cv2", "pandas") if m in sys.modules]
assert not heavy, heavy
for name in datasets.names():
    datasets.get(name).card()
    datasets.get(name).parameters("nominal")
assert "numba" not in sys.modules
for name in reversed({KINDS}):
    for condition in datasets.get(name).conditions[:-2:-1]:  # one is as good as all
        for split in ("test", "calibration"):
            samples = datasets.get(name).generate(condition, split, {FEW})
            print(name, condition, split, datasets.samples_hash(samples))
"""
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    lines = dict(line.rsplit(" ", 1) for line in run.stdout.splitlines())
    assert len(lines) == 2 * len(KINDS)
    for place, digest in lines.items():
        assert digest == samples_hash(first(*place.split())), place


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.slow] if n not in QUICK_KINDS else []) for n in NAMES],
)
def test_generation_depends_on_neither_the_batch_nor_how_much_is_wanted(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    preset = datasets.get(name)
    condition = preset.conditions[-1]
    monkeypatch.setattr("benchmark.datasets.preset.BATCH", 2)
    more = preset.generate(condition, "calibration", FEW + 2)
    for key, array in first(name, condition, "calibration").arrays().items():
        there = more.arrays()[key]
        assert array is there is None or np.array_equal(array, there[:FEW], equal_nan=True), key


def test_the_window_says_little_about_the_spot() -> None:
    preset = datasets.get("cmos-single-aperture")
    sensor = preset.setups["nominal"].sensor
    assert isinstance(sensor, FrameSensor)
    scene = preset.scene("nominal", "test")
    assert scene.origin_px is not None
    miss = scene.origin_px + 32 - sensor.spot_px(scene.sun)
    assert np.abs(miss).max() <= 8.5
    # uniform over 17 whole pixels, independent between axes and of the truth's fraction
    assert miss.std(axis=0) == pytest.approx(math.sqrt((17**2) / 12), rel=0.05)
    assert abs(np.corrcoef(miss.T)[0, 1]) < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("condition", datasets.get("cmos-single-aperture").conditions)
def test_spots_lie_whole_inside_their_windows_neither_dark_nor_saturated(condition: str) -> None:
    """Of the light itself: hot pixels of an aged detector stand anywhere, and are full."""
    preset = datasets.get("cmos-single-aperture")
    sensor: Any = preset.setups[condition].sensor
    scene = preset.scene(condition, "test")
    light = sensor.lit(scene)
    border = np.concatenate([light[:, [0, -1]], light[:, :, [0, -1]].swapaxes(1, 2)], axis=1)
    assert (border.max(axis=(1, 2)) < 0.1 * light.max(axis=(1, 2))).all()
    frames = preset.generate(condition, "test").observations
    lit = frames[light > 0.5 * light.max(axis=(1, 2))[:, None, None]]
    # one pixel in a hundred is hot at the end of life
    assert np.mean(lit == 2**sensor.detector.bits - 1) < (0.02 if condition == "aged" else 1e-9)
    assert np.mean(frames == 0) < 1e-3


@dataclass(frozen=True)
class Part:
    size: float = 0.1 + 0.2
    names: tuple[str, ...] = ("a",)
    derived: int = field(init=False, default=7)


def test_a_dataclass_names_its_type_and_tells_every_field() -> None:
    assert describe(Part()) == {"type": "Part", "size": 0.1 + 0.2, "names": ["a"], "derived": 7}
    assert describe({"part": Part(), 3: None}) == {"part": describe(Part()), "3": None}


def test_parameters_are_exact_where_digests_forgive_the_last_bits() -> None:
    nearly = Part(size=0.3)
    assert describe(Part()) != describe(nearly)
    assert canonical_json(Part()) == canonical_json(nearly) == '{"names":["a"],"size":0.3}'


@pytest.mark.parametrize("value", [float("nan"), float("inf"), np.float64("-inf")])
def test_a_number_that_json_has_no_word_for_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r"parameters must be finite; got (nan|inf|-inf)"):
        describe(Part(size=value))


AREAS = ["cmos-single-aperture", "ccd-single-aperture", "cmos-slit", "cmos-encoded"]


@pytest.mark.parametrize("name", AREAS)
def test_an_aged_detector_is_darker_in_the_dark_by_what_its_condition_says(name: str) -> None:
    """The same unit: pixels' own shares of the dark current stay, one in a hundred is hot."""
    data = datasets.get(name)
    new, old = (data.fixed_pattern(condition)["dark_e"] for condition in ("nominal", "aged"))
    some = new > 0
    growth = old[some] / new[some]
    assert growth.min() == pytest.approx(20.0)
    hot = growth > 20.0 * (1 + 1e-9)
    count = growth.size
    assert hot.mean() == pytest.approx(0.01, abs=4 * math.sqrt(0.01 / count))
    # an exponential's mean, of n values within 4 / sqrt(n) of it
    mean = np.mean(growth[hot] / 20.0 - 1.0)
    assert mean == pytest.approx(20.0, rel=4 / math.sqrt(0.01 * count))
    assert "20 times" in data.setups["aged"].description
