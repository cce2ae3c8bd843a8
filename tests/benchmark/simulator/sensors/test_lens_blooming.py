"""Blooming columns: charge is conserved, cut at the full well, and runs along columns only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from benchmark import datasets
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.blooming import BloomingSensor, spill

PRESET = datasets.get("ccd-lens")
CHARGES = arrays(np.float64, (2, 9, 3), elements=st.floats(0, 60))


def sensor_of(condition: str = "nominal") -> BloomingSensor:
    sensor = PRESET.setups[condition].sensor
    assert isinstance(sensor, BloomingSensor)
    return sensor


def scene_of(angles: list[tuple[float, float]]) -> Scene:
    alpha, beta = np.array(angles).T
    count = len(alpha)
    origin = np.zeros((count, 2), dtype=np.int64)
    return Scene(from_angles(alpha, beta), np.ones(count), np.full(count, 0.02), origin)


@settings(deadline=None, derandomize=True, max_examples=200)
@given(CHARGES)
def test_charge_is_conserved_and_no_pixel_holds_more_than_its_well(charge: np.ndarray) -> None:
    held, drained = spill(charge, 10.0)
    assert held.max() <= 10.0 + 1e-12
    assert (held >= np.minimum(charge, 10.0) - 1e-12).all()
    assert held.sum(axis=1) + drained == pytest.approx(charge.sum(axis=1), rel=1e-12, abs=1e-12)
    turned, out = spill(charge[:, ::-1], 10.0)
    assert turned[:, ::-1] == pytest.approx(held, abs=1e-9)
    assert out == pytest.approx(drained, abs=1e-9)


def test_half_of_the_overflow_goes_either_way() -> None:
    charge = np.zeros((1, 11, 3))
    charge[0, 5, 1] = 10 + 2 * 25
    charge[0, 6, 1] = 4.0
    held, drained = spill(charge, 10.0)
    assert held[0, :, 1].tolist() == [0, 0, 5, 10, 10, 10, 10, 10, 9, 0, 0]
    assert not held[0, :, [0, 2]].any()
    assert not drained.any()


def test_competing_overflows_are_shared_evenly() -> None:
    charge = np.zeros((1, 7, 1))
    charge[0, [1, 5], 0] = 10 + 2 * 18
    held, drained = spill(charge, 10.0)
    # 18 from either side into three pixels: all are filled, what is left runs on to the ends
    assert held[0, :, 0].tolist() == [10.0] * 7
    assert drained.tolist() == [[2 * 46.0 - 70.0]]


def one_by_one(column: list[float], full: float) -> tuple[list[float], float]:
    """Overflow of one saturated pixel, packet by packet: the slow way."""
    held = [min(q, full) for q in column]
    source = int(np.argmax(column))
    lost = 0.0
    for way in (1, -1):
        packet, place = (column[source] - full) / 2, source
        while packet > 0:
            place += way
            if not 0 <= place < len(column):
                lost += packet
                break
            moved = min(packet, full - held[place])
            held[place] += moved
            packet -= moved
    return held, lost


def test_a_single_source_spills_as_the_slow_way_says() -> None:
    generator = np.random.default_rng(5)
    charge = generator.uniform(0, 9, (1, 40, 30))
    charge[0, generator.integers(0, 40, 30), np.arange(30)] = generator.uniform(20, 300, 30)
    held, drained = spill(charge, 10.0)
    for column in range(30):
        level, lost = one_by_one(charge[0, :, column].tolist(), 10.0)
        assert held[0, :, column] == pytest.approx(level, abs=1e-9)
        assert drained[0, column] == pytest.approx(lost, abs=1e-9)


@pytest.mark.parametrize("angles", [(0.0, 0.0), (6.1, -14.2), (-11.0, 17.5)])
def test_the_trail_runs_up_and_down_through_the_sun(angles: tuple[float, float]) -> None:
    sensor = sensor_of()
    pattern = PRESET.fixed_pattern("nominal")
    pattern = {**pattern, "alive": np.ones_like(pattern["alive"])}
    scene = scene_of([angles])
    charge = sensor.camera.photo_electrons(scene, pattern)[0] + pattern["dark_e"]
    full = sensor.camera.detector.full_well_e
    picture = sensor.picture(scene, pattern)[0]
    white = sensor.camera.detector.offset_dn + full / sensor.camera.detector.gain_e_per_dn
    saturated = picture > white - 1e-6
    x, y = sensor.camera.image_px(scene.sun)[0]
    lengths = saturated.sum(axis=0)
    assert abs(int(np.argmax(lengths)) - x) <= 0.6
    assert 80 < lengths.max() < 220
    assert 4 <= (lengths > 0).sum() <= 16
    assert saturated.sum(axis=1).max() < 12
    # length of the longest trail: its column's overflow, a full well a pixel, over dim sky
    column = int(np.argmax(lengths))
    own = charge[:, column]
    sky = np.median(own)
    expected = (own >= full).sum() + np.maximum(own - full, 0).sum() / (full - sky)
    ends = np.flatnonzero(saturated[:, column])
    assert ends[-1] - ends[0] + 1 == len(ends)
    if ends[0] > 0 and ends[-1] < len(own) - 1:
        assert lengths[column] == pytest.approx(expected, abs=6)
        assert (ends[0] + ends[-1]) / 2 == pytest.approx(y, abs=1.5)


def test_a_picture_has_the_charge_of_its_light() -> None:
    sensor = sensor_of()
    pattern = PRESET.fixed_pattern("nominal")
    pattern = {**pattern, "alive": np.ones_like(pattern["alive"])}
    detector = sensor.camera.detector
    scene = scene_of([(0.0, 0.0), (3.0, -7.0)])
    charge = sensor.camera.photo_electrons(scene, pattern) + pattern["dark_e"]
    seen = (sensor.picture(scene, pattern) - detector.offset_dn) * detector.gain_e_per_dn
    assert seen.sum(axis=(1, 2)) == pytest.approx(charge.sum(axis=(1, 2)), rel=1e-12)


def test_the_statistics_of_the_bound_have_the_variance_they_state() -> None:
    """Columns' overflows and cut charges of 300 draws of the charges, against `variance`."""
    sensor = sensor_of()
    detector = sensor.camera.detector
    pattern = PRESET.fixed_pattern("nominal")
    scene = scene_of([(6.1, -14.2)])
    mean = sensor.camera.photo_electrons(scene, pattern)[0] + pattern["dark_e"]
    expected = sensor.expected(scene, pattern)
    strong = expected[0, -1] > 1e5
    draws = np.random.default_rng(2).poisson(mean[:, strong], (400, len(mean), strong.sum()))
    over = np.maximum(draws - detector.full_well_e, 0).sum(axis=1)
    single = detector.read_noise_e**2 + detector.gain_e_per_dn**2 / 12
    stated = sensor.variance(expected)[0, -1, strong] - 2 * single
    assert strong.sum() >= 4
    assert over.mean(axis=0) == pytest.approx(expected[0, -1, strong], rel=1e-3)
    assert np.mean(over.var(axis=0, ddof=1) / stated) == pytest.approx(1.0, abs=0.1)


def test_every_pixel_has_read_noise_of_its_own() -> None:
    """A mean over 64 rows is 8 times as steady as one pixel."""
    sensor = sensor_of()
    detector = sensor.camera.detector
    loud = replace(detector, read_noise_e=3.0 * detector.gain_e_per_dn)
    sensor = replace(sensor, camera=replace(sensor.camera, detector=loud))
    pattern, scene = sensor.fixed_pattern("one"), scene_of([(15.0, 15.0)])
    one, other = (
        sensor.observe(scene, pattern, NoiseStreams.named("noise", n))[0, :64, :64].astype(float)
        for n in range(2)
    )
    noise = one - other
    assert np.std(noise) > 3.0
    assert 8.0 * np.std(noise.mean(axis=0)) == pytest.approx(np.std(noise), rel=0.3)
