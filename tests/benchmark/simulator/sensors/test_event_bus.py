"""The bus of a spiking array: who waits, for how long, and what the stamps say of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmark import datasets
from benchmark.seeds import generator
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.sensors.events import EventSensor, departures

NAMES = ("event-l-slit", "event-single-aperture")


def seen(name: str, count: int, **changes) -> np.ndarray:
    """Events of a dataset's first samples, by a sensor whose pixels or bus are others."""
    preset = datasets.get(name)
    sensor = preset.setups["nominal"].sensor
    assert isinstance(sensor, EventSensor)
    sensor = replace(sensor, detector=replace(sensor.detector, **changes))
    scene = preset.scene("nominal", "test").part(0, count)
    pattern = preset.fixed_pattern("nominal")
    return sensor.observe(scene, pattern, NoiseStreams.named("test", "bus", name))


@given(
    requests=st.lists(st.floats(0.0, 5e3), min_size=1, max_size=60),
    service=st.floats(0.0, 200.0),
)
@settings(deadline=None)
def test_each_event_leaves_when_it_and_the_one_before_it_allow(
    requests: list[float], service: float
) -> None:
    requests = sorted(requests)
    found = departures(np.array([requests]), service)[0]
    left = -math.inf
    for request, departure in zip(requests, found, strict=True):
        left = max(request, left) + service
        # sums of up to 60 services in another order: 60 roundings of numbers below 2e4
        assert departure == pytest.approx(left, abs=60 * 2e4 * 2.3e-16)


def test_the_mean_wait_is_that_of_a_queue_with_random_requests_and_one_service_time() -> None:
    """Pollaczek and Khinchine: ``rho s / (2 (1 - rho))`` for Poisson requests (M/D/1)."""
    service, load, runs, count = 0.5, 0.6, 200, 20_000
    gaps = -np.log1p(-generator("test", "queue").random((runs, count))) * service / load
    requests = np.cumsum(gaps, axis=1)
    waits = (departures(requests, service) - requests - service)[:, 200:]
    means = waits.mean(axis=1)
    error = means.std(ddof=1) / math.sqrt(runs)
    expected = load * service / (2.0 * (1.0 - load))
    assert error < 0.005 * expected
    assert means.mean() == pytest.approx(expected, abs=4.0 * error)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_burst_leaves_no_faster_than_the_bus_and_in_the_order_it_came(name: str) -> None:
    fine = {"clock_us": 1e-6}
    free, loaded = seen(name, 16, service_us=0.0, **fine), seen(name, 16, service_us=0.5, **fine)
    read = ~np.isnan(loaded[:, :, 0])
    assert np.array_equal(free[read][:, :2], loaded[read][:, :2])
    stamps = loaded[:, :, 2]
    steps = np.diff(stamps, axis=1)[read[:, 1:]]
    assert steps.min() > 0.5 - 3e-6
    assert (np.abs(steps - 0.5) < 3e-6).any(), "some wait"
    delays = (stamps - free[:, :, 2])[read]
    assert delays.min() == pytest.approx(0.5, abs=3e-6)
    # an event waits for those before it at most
    order = np.broadcast_to(np.arange(1, stamps.shape[1] + 1), stamps.shape)[read]
    assert (delays <= 0.5 * order + 3e-6).all()


@pytest.mark.slow
def test_an_event_that_still_waits_at_the_timeout_is_lost() -> None:
    events = seen("event-l-slit", 4, service_us=20.0, timeout_us=1_000.0)
    first = seen("event-l-slit", 4, service_us=0.0)[:, 0, 2]
    for sample, begun in zip(events, first, strict=True):
        read = sample[~np.isnan(sample[:, 0]), 2]
        assert len(read) == pytest.approx((1_000.0 - begun) / 20.0, abs=1.0)
        assert read.max() <= 1_000.0 + 0.05


def test_pixels_that_ask_at_once_go_by_their_address() -> None:
    """Times are pulled up to the clock's first step, where thousands of pixels meet."""
    events = seen("event-l-slit", 2, clock_us=1e6, timeout_us=1e9, service_us=0.0)
    address = events[:, :, 1] * 64 + events[:, :, 0]
    assert np.array_equal(address, np.tile(np.arange(address.shape[1]), (2, 1)))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_standard_bus_serves_bursts_late_and_loses_none(name: str) -> None:
    preset = datasets.get(name)
    for condition in preset.conditions:
        sensor = preset.setups[condition].sensor
        assert isinstance(sensor, EventSensor)
        assert sensor.detector.service_us == pytest.approx(1.0 / 12.0)
    free, loaded = seen(name, 24, service_us=0.0), seen(name, 24)
    assert np.array_equal(np.isnan(free), np.isnan(loaded))
    delays = loaded[:, :, 2] - free[:, :, 2]
    longest = {"event-l-slit": 1.0, "event-single-aperture": 0.1}[name]
    assert np.nanmax(delays) > longest
