"""The standard datasets: found by walking, seeded by name, the same whenever they are made."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from algorithms.contract import Observation
from benchmark import datasets
from benchmark.datasets import Samples, UnknownDatasetError, data_digest
from benchmark.simulator.frames import FrameSensor

ROOT = Path(__file__).parents[2]
CASES = [(name, c) for name in datasets.names() for c in datasets.get(name).conditions]


@pytest.fixture(scope="module")
def made() -> dict[tuple[str, str, str], Samples]:
    return {
        (name, condition, split): datasets.get(name).generate(condition, split)
        for name, condition in CASES
        for split in ("calibration", "test")
    }


def test_every_module_of_the_package_is_a_dataset() -> None:
    files = sorted((ROOT / "benchmark" / "datasets").glob("[!_]*.py"))
    assert [f.stem.replace("_", "-") for f in files] == list(datasets.names())
    assert set(datasets.names()) >= {
        "cmos-single-aperture",
        "qpd-single-aperture",
        "pd-maskless-cube",
    }


def test_unknown_names_are_answered_with_the_nearest() -> None:
    with pytest.raises(UnknownDatasetError, match="did you mean 'cmos-single-aperture'") as caught:
        datasets.get("cmos-single-apertures")
    assert caught.value.nearest == "cmos-single-aperture"
    assert isinstance(caught.value, LookupError)
    assert isinstance(caught.value, ValueError)
    preset = datasets.get("pd-maskless-cube")
    with pytest.raises(ValueError, match="no condition 'warm'; it has nominal"):
        preset.generate("warm", "test")
    with pytest.raises(ValueError, match="no split 'train'; there are calibration, test"):
        preset.generate("nominal", "train")


@pytest.mark.parametrize(("name", "condition"), CASES)
def test_samples_are_what_the_card_says(made, name: str, condition: str) -> None:
    preset = datasets.get(name)
    card = preset.card()
    for split in ("calibration", "test"):
        samples = made[name, condition, split]
        count = card["splits"][split]["samples"]
        assert samples.sun.shape == (count, 3)
        assert np.linalg.norm(samples.sun, axis=1) == pytest.approx(1.0, abs=1e-14)
        assert len(samples.observations) == count
        if preset.observation is Observation.FRAMES:
            assert samples.observations.dtype == np.uint16
            assert samples.observations.ndim == 3
            assert samples.origin_px is not None
            assert samples.origin_px.shape == (count, 2)
        elif preset.observation is Observation.EVENTS:
            assert samples.observations.dtype == np.float64
            assert samples.observations.shape[2] == 3
            assert samples.origin_px is None
            assert np.isfinite(samples.observations[:, 0]).all()
            continue  # rows after a sample's last event are NaN
        else:
            digital = preset.observation is Observation.PROFILES
            assert samples.observations.dtype == (np.uint16 if digital else np.float64)
            assert samples.observations.ndim == 2
            assert samples.origin_px is None
        assert np.isfinite(samples.observations).all()


@pytest.mark.parametrize("name", datasets.names())
def test_cards_and_parameters_are_plain_json(name: str) -> None:
    preset = datasets.get(name)
    card = preset.card()
    assert json.loads(json.dumps(card, allow_nan=False)) == card
    assert list(card["conditions"]) == list(preset.conditions)
    for condition in preset.conditions:
        assert card["conditions"][condition]["parameters"] == preset.parameters(condition)
    texts = {json.dumps(preset.parameters(c), sort_keys=True) for c in preset.conditions}
    assert len(texts) == len(preset.conditions)


def test_all_samples_differ_from_one_condition_and_split_to_another(made) -> None:
    digests = {data_digest(samples) for samples in made.values()}
    assert len(digests) == len(made)


@pytest.mark.parametrize("name", datasets.names())
def test_conditions_share_the_sun_and_calibration_is_apart_from_test(made, name: str) -> None:
    preset = datasets.get(name)
    for split in ("calibration", "test"):
        suns = [made[name, c, split].sun for c in preset.conditions]
        assert all(np.array_equal(sun, suns[0]) for sun in suns)
    calibration, test = (made[name, "nominal", s].sun for s in ("calibration", "test"))
    assert (test @ calibration.T).max() < 1.0


def test_generation_depends_on_neither_order_nor_process_nor_import(made) -> None:
    """A fresh process, conditions backwards, must give the same bytes; and import nothing heavy."""
    code = """
import sys
from benchmark import datasets
heavy = [m for m in ("numba", "scipy", "cv2", "pandas") if m in sys.modules]
assert not heavy, heavy
for name in datasets.names():
    datasets.get(name).card()
    datasets.get(name).parameters("nominal")
assert "numba" not in sys.modules
for name in reversed(datasets.names()):
    for condition in datasets.get(name).conditions[:-3:-1]:  # two are as good as all
        for split in ("test", "calibration"):
            samples = datasets.get(name).generate(condition, split)
            print(name, condition, split, datasets.data_digest(samples))
"""
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    lines = dict(line.rsplit(" ", 1) for line in run.stdout.splitlines())
    assert len(lines) == 4 * len(datasets.names())
    assert lines.items() <= {" ".join(k): data_digest(v) for k, v in made.items()}.items()


@pytest.mark.parametrize("name", datasets.names())
def test_generation_does_not_depend_on_the_batch(
    made, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("benchmark.datasets._preset.BATCH", 17)
    condition = datasets.get(name).conditions[-1]
    again = datasets.get(name).generate(condition, "calibration")
    assert data_digest(again) == data_digest(made[name, condition, "calibration"])


def test_digest_sees_values_shapes_and_types() -> None:
    base = np.arange(6.0)
    sun = np.ones((2, 3))
    digests = {
        data_digest(Samples(array, sun, origin))
        for array in (base, base.reshape(2, 3), base.astype(np.float32), base + 1)
        for origin in (None, np.zeros((2, 2), dtype=np.int64))
    }
    assert len(digests) == 8
    assert data_digest(Samples(base[::1], sun, None)) == data_digest(
        Samples(np.repeat(base, 2)[::2], sun.copy(), None)
    )


def test_the_window_says_little_about_the_spot(made) -> None:
    preset = datasets.get("cmos-single-aperture")
    sensor = preset.setups["nominal"].sensor
    assert isinstance(sensor, FrameSensor)
    samples = made["cmos-single-aperture", "nominal", "test"]
    assert samples.origin_px is not None
    miss = samples.origin_px + 32 - sensor.spot_px(samples.sun)
    assert np.abs(miss).max() <= 8.5
    # uniform over 17 whole pixels, independent between axes and of the truth's fraction
    assert miss.std(axis=0) == pytest.approx(math.sqrt((17**2) / 12), rel=0.05)
    assert abs(np.corrcoef(miss.T)[0, 1]) < 0.1


def test_spots_lie_whole_inside_their_windows(made) -> None:
    for condition in datasets.get("cmos-single-aperture").conditions:
        frames = made["cmos-single-aperture", condition, "test"].observations.astype(float)
        border = np.concatenate(
            [
                frames[:, [0, -1]].reshape(len(frames), -1),
                frames[:, :, [0, -1]].reshape(len(frames), -1),
            ],
            axis=1,
        )
        inside = frames.max(axis=(1, 2))
        assert (border.max(axis=1) < 0.5 * inside).all(), condition


def test_frames_are_neither_dark_nor_saturated(made) -> None:
    for condition in datasets.get("cmos-single-aperture").conditions:
        frames = made["cmos-single-aperture", condition, "test"].observations
        bits = datasets.get("cmos-single-aperture").setups[condition].sensor.detector.bits
        assert frames.max() < 2**bits - 1, condition
        assert np.mean(frames == 0) < 1e-3, condition


def test_low_noise_is_the_nominal_unit_with_less_noise() -> None:
    preset = datasets.get("cmos-single-aperture")
    low, nominal = preset.fixed_pattern("low-noise"), preset.fixed_pattern("nominal")
    assert np.array_equal(low["gain"], nominal["gain"])
    assert preset.setups["low-noise"].sensor.camera == preset.setups["nominal"].sensor.camera


@pytest.mark.parametrize("name", datasets.names())
def test_bounds_order_with_the_noise(name: str) -> None:
    preset = datasets.get(name)
    low, nominal, high = (
        preset.bound(c, "calibration").angle_deg for c in ("low-noise", "nominal", "high-noise")
    )
    seen = np.isfinite(low) & np.isfinite(nominal) & np.isfinite(high)
    assert seen.mean() > 0.8
    assert (low[seen] <= nominal[seen]).all()
    assert (nominal[seen] <= high[seen]).all()


def test_round_aperture_condition_has_its_own_geometry() -> None:
    preset = datasets.get("qpd-single-aperture")
    assert preset.geometry_for("round-aperture").aperture_shape == "round"
    assert preset.geometry_for("nominal") == preset.geometry
    assert preset.geometry.aperture_shape == "square"


def test_propagation_is_geometric_where_it_is_claimed() -> None:
    for name in datasets.names():
        regime = datasets.get(name).card()["regime"]
        if regime["propagation"] != "geometric":
            assert regime["reason"]
            continue
        assert regime.get("fresnel_number", math.inf) > 10


def test_earth_shines_on_test_samples_only_and_turns_the_estimate_by_degrees(made) -> None:
    preset = datasets.get("pd-maskless-cube")
    assert preset.scene("albedo", "calibration").albedo is None
    albedo = preset.scene("albedo", "test").albedo
    assert albedo is not None
    assert albedo.min() >= 0
    assert 0.1 < albedo.max() < 0.4
    # maximum currents (eq:albedo1): the larger of each pair, signed
    error = {}
    for condition in ("nominal", "albedo"):
        samples = made["pd-maskless-cube", condition, "test"]
        plus, minus = samples.observations[:, ::2], samples.observations[:, 1::2]
        found = np.where(plus >= minus, plus, -minus)
        found /= np.linalg.norm(found, axis=1)[:, None]
        apart = np.clip(np.sum(found * samples.sun, axis=1), -1, 1)
        error[condition] = np.degrees(np.arccos(apart))
    assert error["nominal"].max() < 10
    assert 10 < error["albedo"].max() < 60
