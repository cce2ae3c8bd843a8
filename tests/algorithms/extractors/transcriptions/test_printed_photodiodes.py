"""alg:VB transcribed: the balance of four quadrants."""

from __future__ import annotations

import numpy as np

from algorithms.extractors.currents.photodiode import VoltageBalance


def vb_as_printed(q1, q2, q3, q4):
    """alg:VB: ``S_A`` along the sensor's x, ``S_B`` along its y."""
    total = q1 + q2 + q3 + q4
    s_a = (q2 + q3 - q1 - q4) / total
    s_b = (q1 + q2 - q3 - q4) / total
    return s_a, s_b


def test_vb():
    readings = np.random.default_rng(1).uniform(0.1, 3.0, (40, 4))
    expected = [vb_as_printed(*row) for row in readings]
    np.testing.assert_allclose(VoltageBalance().extract(readings), expected, rtol=0, atol=1e-15)


def test_the_balance_is_the_ratio_of_tangents():
    """ERRATA: ``tan(alpha_MAX) = d / 2 h``, the printed arc is its first term. Exact for a square.

    The square's shadow is as wide as the aperture; its light on a quadrant is the area there.
    """
    width, height = 0.8, 1.5
    for alpha, beta in ((4.0, -9.0), (-12.0, 0.5), (0.0, 14.0)):
        x, y = height * np.tan(np.radians(beta)), height * np.tan(np.radians(alpha))
        right, left = width / 2 + x, width / 2 - x
        above, below = width / 2 + y, width / 2 - y
        quadrants = [left * above, right * above, right * below, left * below]
        tangents = np.tan(np.radians([beta, alpha])) / (width / (2 * height))
        np.testing.assert_allclose(VoltageBalance().extract([quadrants])[0], tangents, atol=1e-12)
