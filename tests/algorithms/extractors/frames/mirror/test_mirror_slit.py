"""The light of a slit, registered with its mirror image."""

import numpy as np
from scipy.special import ndtr

from algorithms.design import SensorGeometry
from algorithms.extractors.frames.mirror.extractor import MirrorRegistration

SIZE, DARK, PEAK, READ, RIM = 64, 20.0, 2000.0, 10.0, 0.7


def test_a_slit_is_one_spot_however_long():
    slit = SensorGeometry(aperture_width_mm=0.1, centre_px=(31.5, 31.5))
    y, x = np.mgrid[:SIZE, :SIZE]
    rims = (x - 25.3, 25.3 - x, y - 31.8, 31.8 - y)
    sides = [ndtr((half + off) / RIM) for off, half in zip(rims, (3, 3, 20, 20), strict=True)]
    noise = np.random.default_rng(3).normal(0.0, READ, (SIZE, SIZE))
    frames = (DARK + PEAK * np.prod(sides, axis=0) + noise)[None]
    assert np.isnan(MirrorRegistration().extract(frames)).all()
    found = MirrorRegistration.for_sensor(slit).extract(frames)
    np.testing.assert_allclose(found, [[25.3, 31.8]], atol=0.05)
