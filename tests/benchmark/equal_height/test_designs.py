"""Sensors that differ in their mask alone: rays traced by hand stay on the common array."""

import itertools
import math

import pytest

from benchmark.equal_height.designs import DESIGNS, DETECTOR, Place, UnfitError, preset
from benchmark.simulator.sensors.line_sensor import LineSensor

HALF_ARRAY_MM = 512 * 0.012 / 2.0
NAMES = tuple(DESIGNS)


@pytest.fixture(scope="module")
def built():
    return {name: preset(name, Place()) for name in NAMES}


def test_height_pixels_field_and_poses_are_the_same_for_every_mask(built):
    for one in built.values():
        sensor = one.setups["nominal"].sensor
        assert sensor.camera.focal_length_mm == 0.5
        assert one.geometry.focal_length_mm == 0.5
        assert one.geometry.half_fov_deg == 60.0
        pixels = sensor.detector
        assert (pixels.columns, pixels.pitch_mm) == (512, 0.012)
        alike = ("sunlit_e", "full_well_e", "read_noise_e", "prnu", "bits", "exposure_s", "errors")
        for name in alike:
            assert getattr(pixels, name) == getattr(DETECTOR, name)
        assert one.directions == next(iter(built.values())).directions
        assert one.conditions == ("nominal", "flight")


@pytest.mark.parametrize("name", NAMES)
def test_light_of_every_opening_stays_on_the_array_over_the_field(name, built):
    sensor = built[name].setups["nominal"].sensor
    edge = 0.5 * math.tan(math.radians(60.0))
    for hole in sensor.camera.mask.apertures:
        for x, y in itertools.product((-edge, edge), repeat=2):
            if isinstance(sensor, LineSensor):
                # along the array a slanted slit's light moves by the shift across it as well
                along = hole.x_mm + y + x * math.tan(math.radians(hole.rotation_deg))
                assert abs(along) + hole.width_mm / 2.0 < HALF_ARRAY_MM
                continue
            if name == "encoded":  # of which a part is seen, and tells which
                continue
            assert abs(hole.x_mm + x) + hole.width_mm / 2.0 < HALF_ARRAY_MM
            assert abs(hole.y_mm + y) + hole.height_mm / 2.0 < HALF_ARRAY_MM


@pytest.mark.parametrize("name", ["n-slit", "v-slit"])
def test_spots_of_slanted_slits_never_meet(name, built):
    sensor = built[name].setups["nominal"].sensor
    edge = 0.5 * math.tan(math.radians(60.0))
    for x in (-edge, edge):
        places = [
            hole.x_mm + x * math.tan(math.radians(hole.rotation_deg))
            for hole in sensor.camera.mask.apertures
        ]
        assert all(two - one > 0.1 for one, two in itertools.pairwise(places))


def test_higher_masks_drop_out_one_by_one_with_a_reason():
    def fits(name, height_mm):
        try:
            preset(name, Place(height_mm))
        except UnfitError:
            return False
        return True

    def fitting(height_mm):
        return {name for name in NAMES if fits(name, height_mm)}

    low, middle, high = fitting(0.5), fitting(1.0), fitting(1.6)
    assert low == set(NAMES)
    assert high < middle < low
    assert "single-aperture" in high
    assert "n-slit" not in middle
    with pytest.raises(UnfitError, match="beside the middle"):
        preset("n-slit", Place(1.0))


def test_light_that_leaves_the_array_from_one_hole_is_no_place():
    with pytest.raises(UnfitError, match="leave the array"):
        Place(2.0)
    for height, half in ((0.0, 60.0), (0.5, 90.0), (0.5, 0.0)):
        with pytest.raises(UnfitError, match="expected a height above"):
            Place(height, half)
