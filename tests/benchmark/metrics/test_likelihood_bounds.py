"""Maximum-likelihood estimates reach both bounds: the unit known, and known by flats and darks.

Estimates are of `most_likely`, by the chances of whole codes. A direction's error has two axes, of
which one may be all of it: of n trials the root mean square is known to 1 / sqrt(2 n) at worst.
Counts of pulses are estimated in `test_likelihood_counts`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from most_likely import errors_deg

from benchmark import datasets
from benchmark.datasets import Condition
from benchmark.metrics.bounds import Bound, cramer_rao
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene

OFFERED = References()
NONE = References(flats=0, darks=0)
#: Data set, alpha and beta (deg), trials: one standard error is at most 3.5 %. One of each readout
#: and each kind of element: masks enter bound and estimate alike, by the mean signal they share.
ARCHITECTURES = [
    ("cmos-single-aperture", 3.3, -2.2, 400),
    ("ccd-slit", 33.3, -17.2, 400),
    ("pda-slit", 21.3, -9.7, 400),
    ("qpd-single-aperture", 21.0, -9.0, 1000),
    ("psd-single-aperture", -13.0, 18.0, 1000),
    ("pd-maskless-cube", 25.0, 40.0, 1000),
    ("pd-code-dial", 21.0, -9.0, 1000),
    ("pd-slit", 11.0, -9.0, 1000),
    ("oi-maskless-pyramid", -18.0, 27.0, 1000),
    ("pva-maskless-sphere", 35.0, 50.0, 1000),
]
QUICK = [("pd-maskless-pyramid", 22.0, -31.0, 500), ("qpd-maskless-pyramid", 12.0, -7.0, 500)]


@cache
def setup_of(name: str) -> Condition:
    """The nominal condition; of pixel arrays no more than a window around the spot.

    Without errors of pixels and amplifiers: `test_common_noise` has what columns share.
    """
    setup = datasets.get(name).setups["nominal"]
    sensor: Any = setup.sensor
    if isinstance(getattr(sensor, "detector", None), PixelArray):
        sensor = replace(sensor, detector=replace(sensor.detector, errors=PixelErrors()))
    if hasattr(sensor, "window_px"):
        # a spot is 20 px wide, a slit's image longer
        window = (44, 44) if "aperture" in name else sensor.window_px
        small = replace(sensor.detector, columns=window[0] + 24, rows=window[1] + 24)
        sensor = replace(sensor, detector=small, window_px=window, window_jitter_px=0)
    return replace(setup, sensor=sensor)


def seen_at(setup: Condition, alpha: float, beta: float) -> Scene:
    sun = from_angles(np.array([alpha]), np.array([beta]))
    origin = setup.sensor.origins(sun, generator("test"))
    return Scene(sun, np.ones(1), np.full(1, setup.irradiance.stray), origin)


def unit_of(setup: Condition, name: str, unit: int) -> dict[str, Any]:
    """The first unit with another one's elements, as `most_likely.drawn` has them."""
    first, own = (setup.sensor.fixed_pattern("test", name, number) for number in (0, unit))
    return {**first, **{key: own[key] for key in ("gain", "cells", "dark_e") if key in own}}


def bound_at(setup: Condition, one: Scene, name: str, references: References) -> Bound:
    pattern = setup.sensor.fixed_pattern("test", name, 0)
    return cramer_rao(setup.sensor, one, pattern, setup.irradiance, references=references)


def rms(errors: np.ndarray) -> float:
    return math.sqrt(2 * np.mean(errors**2))


@pytest.mark.parametrize(
    ("name", "alpha", "beta", "trials"),
    [*QUICK, *(pytest.param(*case, marks=pytest.mark.slow) for case in ARCHITECTURES)],
)
def test_a_known_unit_is_estimated_as_well_as_its_bound_says(
    name: str, alpha: float, beta: float, trials: int
) -> None:
    setup = setup_of(name)
    one = seen_at(setup, alpha, beta)
    bound = bound_at(setup, one, name, OFFERED)
    assert rms(errors_deg(setup, one, (name,), trials)) == pytest.approx(
        bound.angle_deg[0], rel=0.1
    )


@pytest.mark.parametrize(
    ("name", "alpha", "beta", "trials"),
    [*QUICK, *(pytest.param(*case, marks=pytest.mark.slow) for case in ARCHITECTURES)],
)
def test_units_known_by_flats_and_darks_are_estimated_as_well_as_their_bound_says(
    name: str, alpha: float, beta: float, trials: int
) -> None:
    """Another unit in every trial; of sensors with few elements the bound is that of many units."""
    setup = setup_of(name)
    one = seen_at(setup, alpha, beta)
    squares = []
    for unit in range(40 if setup.sensor.expected(one, unit_of(setup, name, 0)).size < 100 else 1):
        pattern = unit_of(setup, name, unit)
        bound = cramer_rao(setup.sensor, one, pattern, setup.irradiance, references=OFFERED)
        assert bound.unit_angle_deg is not None
        assert bound.unit_angle_deg[0] > bound.angle_deg[0]
        squares.append(bound.unit_angle_deg[0] ** 2)
    errors = errors_deg(setup, one, (name,), trials, OFFERED)
    assert rms(errors) == pytest.approx(math.sqrt(np.mean(squares)), rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ccd-slit", "pda-slit"])
def test_without_flats_and_darks_units_are_known_by_their_spread_alone(name: str) -> None:
    """Where the spread costs a third of the bound, and where it is five times the bound."""
    setup = setup_of(name)
    one = seen_at(setup, 21.3, -9.7)
    bound = bound_at(setup, one, name, NONE)
    assert bound.unit_angle_deg is not None
    assert bound.unit_angle_deg[0] > 1.2 * bound.angle_deg[0]
    errors = errors_deg(setup, one, (name,), 400, NONE)
    assert rms(errors) == pytest.approx(bound.unit_angle_deg[0], rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "per_dn", "read_noise_e"),
    [("ccd-slit", 300.0, 20.0), ("ccd-slit", 300.0, 45.0), ("pda-multi-slit", 3000.0, 200.0)],
)
def test_below_a_count_the_bound_is_still_reached(
    name: str, per_dn: float, read_noise_e: float
) -> None:
    """Dark pixels at 0.07 to 0.15 of a count, over directions that dither what codes edges cut."""
    setup = setup_of(name)
    detector = setup.sensor.detector  # type: ignore[attr-defined]
    coarse = replace(detector, gain_e_per_dn=per_dn, read_noise_e=read_noise_e)
    setup = replace(setup, sensor=replace(setup.sensor, detector=coarse))  # type: ignore[type-var]
    squares = []
    for step in range(10):
        one = seen_at(setup, 21.3 + 0.37 * step, -9.7 + 0.23 * step)
        bound = bound_at(setup, one, name, OFFERED).angle_deg[0]
        squares.append((np.mean(errors_deg(setup, one, (name, step), 60) ** 2) * 2, bound**2))
    reached, promised = np.mean(squares, axis=0)
    assert math.sqrt(reached / promised) == pytest.approx(1.0, rel=0.1)


@pytest.mark.slow
def test_sensors_whose_elements_do_not_differ_each_by_itself_have_no_second_bound() -> None:
    """Absent, never equal to the first one."""
    setup = datasets.get("event-l-slit").setups["nominal"]
    pattern = setup.sensor.fixed_pattern("test")
    found = cramer_rao(
        setup.sensor, seen_at(setup, 5.0, 3.0), pattern, setup.irradiance, references=OFFERED
    )
    assert found.unit_angle_deg is None
    assert math.isnan(found.unit_rms_deg)


def test_more_flats_bring_the_second_bound_to_the_first() -> None:
    setup = setup_of("pd-maskless-pyramid")
    one = seen_at(setup, 22.0, -31.0)
    known, by_flats = [], []
    for flats in (0, 1, 16, 10_000):
        found = bound_at(setup, one, "flats", References(flats=flats))
        assert found.unit_angle_deg is not None
        known.append(found.angle_deg[0])
        by_flats.append(found.unit_angle_deg[0])
    assert len(set(known)) == 1
    assert by_flats == sorted(by_flats, reverse=True)
    assert by_flats[-1] == pytest.approx(known[0], rel=1e-3)
    assert by_flats[-1] > known[0]
