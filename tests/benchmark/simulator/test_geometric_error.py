"""How far shadows are from diffracted light, and the regime that may be claimed from it."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.conditions.propagation import measured
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.geometric_error import geometric_error

SUN = from_angles(np.array([0.0, 20.0]), np.array([0.0, -30.0]))


def bent() -> DiffractiveFrameSensor:
    sensor = datasets.get("ccd-single-aperture").setups["nominal"].sensor
    assert isinstance(sensor, DiffractiveFrameSensor)
    return sensor


def shadow_of(sensor: DiffractiveFrameSensor) -> FrameSensor:
    return FrameSensor(**{f.name: getattr(sensor, f.name) for f in fields(FrameSensor)})


def test_shadows_of_apertures_are_tens_of_percent_off() -> None:
    sensor = bent()
    assert (geometric_error(shadow_of(sensor), sensor, SUN) > 0.2).all()
    assert (geometric_error(sensor, sensor, SUN) == 0).all()


def test_shorter_waves_come_nearer_to_the_shadow() -> None:
    """An edge is as soft as the root of the wavelength: of 5.5 pm a hundredth of a pixel."""
    thin = replace(bent().camera.mask, thickness_mm=0.0)
    sensor = replace(bent(), camera=replace(bent().camera, mask=thin))
    found = [
        geometric_error(shadow_of(sensor), replace(sensor, spectrum=Spectrum((nm,), (1.0,))), SUN)
        for nm in (55.0, 5.5e-3)
    ]
    assert (found[1] < found[0]).all()
    assert (found[1] < 0.03).all()


def test_arrays_of_other_shapes_cannot_be_compared() -> None:
    sensor = bent()
    smaller = replace(shadow_of(sensor), window_px=(32, 32))
    with pytest.raises(ValueError, match="got 1024 and 4096 elements"):
        geometric_error(smaller, sensor, SUN)


def test_a_regime_of_shadows_is_claimed_below_one_percent_only() -> None:
    assert measured(0.4, 60.0)["error_percent"] == 0.4
    with pytest.raises(ValueError, match=r"within 1 % of the peak; got 1\.0 %"):
        measured(1.0, 60.0)
