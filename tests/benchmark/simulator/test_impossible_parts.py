"""A part of a sensor, its light or its orbit that cannot be is refused, with what is expected."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from benchmark.datasets.calibration import Bench
from benchmark.simulator.flight.attitude import Tumble
from benchmark.simulator.flight.drift import ThermalCycle
from benchmark.simulator.flight.orbit import CircularOrbit
from benchmark.simulator.light.clouds import Clouds
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.plates import Plate
from benchmark.simulator.readout.detectors import Quadrants
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.readout.references import References
from benchmark.simulator.sensors.position_sensitive import LateralEffect
from benchmark.simulator.sensors.slit_pairs import DiodePair
from benchmark.simulator.sensors.solar_cells import SolarCells

SHARES = ("spread", "stray", "stray_spread")
NEGATIVE = "spread, stray and stray_spread must not be negative"
PLACED = "altitude_km and radius_km must be positive"


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (partial(Aperture, "round", 0.1, 0.2), "one diameter"),
        (partial(Aperture, "oval", 0.1, 0.2), "'round' or 'rectangle'"),
        (partial(Aperture, "round", 0.0, 0.0), "positive"),
        (partial(Mask, ()), "at least one aperture"),
        (partial(Mask, (Aperture("round", 1, 1),), -0.1), "thickness_mm"),
        (partial(MaskErrors, position_mm=-1.0), "must not be negative"),
        (partial(MaskErrors, missing=0.7, dirty=0.4), "together at most 1"),
        (partial(MaskErrors, dirty_transmission=(0.8, 0.2)), "two increasing numbers"),
        (partial(Plate, 0.0, 1.5), "thickness_mm"),
        (partial(Plate, 0.1, 0.9), "index"),
        (partial(Quadrants, 1.0, 3.0), "gap_mm"),
        (partial(DiodePair, 1.0, 1.0, 2.0), "gap_mm in"),
        (partial(LateralEffect, 0.0), "length_mm must be positive; got 0"),
        (partial(LateralEffect, 1.0, 0.2), r"nonlinearity.*\[0.*1/6\).*0.2"),
        (partial(SolarCells, in_series=0), "in_series.*1.*0"),
        (partial(SolarCells, loss=1.0), r"loss.*\[0.*1\).*1.0"),
        (partial(SolarCells, mismatch=-0.1), "must not be negative; got -0.1"),
        (partial(PixelErrors, smear=-1.0), "smear.*-1.0"),
        (partial(PixelErrors, crosstalk=0.7), "crosstalk.*0.5.*got 0.7"),
        (partial(PixelErrors, hot=math.nan), "hot.*nan"),
        (partial(References, flats=-1), "-1.*16"),
        (partial(References, darks=-2), "16.*-2"),
        *((partial(References, level=level), f"0 and 1; got {level}") for level in (0.0, 1.0)),
        (partial(Ghost, 1.5), r"detector_reflectance.*\[0.*1\].*1.5"),
        (partial(Ghost, 0.3, -0.1), r"surface_reflectance.*\[0.*1\].*-0.1"),
        (partial(Ghost, surface="lens"), "'mask' or 'glass'; got 'lens'"),
        (partial(Spectrum, (), ()), "one weight a wavelength"),
        (partial(Spectrum, (500.0,), (0.5, 0.5)), "got 1 wavelengths and 2 weights"),
        (partial(Spectrum, (500.0, 600.0), (0.5, 0.4)), "add up to 1; got 0.9"),
        (partial(Spectrum, (-500.0,), (1.0,)), "positive"),
        (partial(SolarDisc, diameter_deg=-1), "diameter_deg"),
        (partial(SolarDisc, rings=(5,)), "multiples of four"),
        (partial(SolarDisc, limb_darkening=1.2), r"limb_darkening must be in \[0, 1\]; got 1.2"),
        *((partial(SolarDisc, spiral=wrong), "spiral.*0") for wrong in (-4, 3, 30)),
        *((partial(Irradiance, **{n: -0.1}), NEGATIVE) for n in SHARES),
        (partial(Earth, reflectance=1.1), r"reflectance must be in \[0, 1\]; got 1.1"),
        (partial(Earth, reflectance=-0.1), r"reflectance must be in \[0, 1\]; got -0.1"),
        (partial(Earth, altitude_km=0.0), PLACED),
        (partial(Earth, radius_km=-1.0), PLACED),
        (partial(Clouds, cover=1.0), r"cover.*\(0.*1\).*1.0"),
        (partial(Clouds, clear=1.5), r"clear.*\[0.*1\].*1.5"),
        (partial(Clouds, waves=0), "waves.*1.*0"),
        (partial(Clouds, shortest_km=9000.0), "longest_km.*9000.0.*6000.0"),
        (partial(Clouds, softness=0.0), "softness must be positive; got 0.0"),
        (partial(CircularOrbit, altitude_km=0.0), PLACED),
        (partial(CircularOrbit, inclination_deg=181.0), r"inclination_deg.*\[0.*180\].*181"),
        (partial(ThermalCycle, time_constant_s=0.0), "must be positive"),
        (partial(Tumble, 70.0, 40.0, 0.5, 2.0), r"inertia_ratio.*\(0.*2\).*2"),
        (partial(Tumble, 0.0, 40.0, 0.5, 1.0), r"momentum_sun_deg.*\(0.*180\).*0"),
        *((partial(Bench, mounting_deg=n), "mounting_deg") for n in (-0.1, math.nan, math.inf)),
    ],
)  # fmt: skip
def test_it_is_refused(make: Callable[..., Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make()
