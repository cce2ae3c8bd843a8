"""The second image of a slit that slants over an array of high pixels."""

from dataclasses import replace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.slits import SlitErrors, slit
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene


@pytest.mark.parametrize("slant_deg", [0.0, 30.0, 45.0, -45.0])
def test_at_normal_incidence_it_lies_on_the_first_image(slant_deg):
    """From the glass, at the share of its light: as wide as the slit crosses the pixels' height."""
    nominal = datasets.get("ccd-slit").setups["nominal"].sensor
    mask = Mask((slit(0.1, 4.0, slant_deg=slant_deg),))
    ghost = Ghost(surface="glass")
    sensor = replace(
        nominal,
        camera=Camera(2.5, mask, nominal.camera.sun, CoverGlass((Plate(0.5, 1.5),))),
        pixel_height_mm=0.4,
        fill_factor=1.0,
        errors=SlitErrors(),
        spectrum=None,
        ghost=None,
    )
    scene = Scene(np.array([[0.0, 0.0, 1.0]]), np.ones(1), np.zeros(1))
    first = sensor.lit(scene)[0]
    second = replace(sensor, ghost=ghost).lit(scene)[0] - first
    pixels = np.arange(len(first))

    def moments(light):
        middle = (light * pixels).sum() / light.sum()
        return middle, (light * (pixels - middle) ** 2).sum() / light.sum()

    assert second.sum() == pytest.approx(ghost.share * first.sum(), rel=1e-3)
    assert moments(second)[0] == pytest.approx(moments(first)[0], abs=1e-6)
    # the Sun's penumbra is wider, and lines stand for the height
    assert moments(second)[1] == pytest.approx(moments(first)[1], rel=0.05)
