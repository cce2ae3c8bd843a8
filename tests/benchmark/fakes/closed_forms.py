"""Light in closed form, to hold the simulator to."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import fresnel


def slit_intensity(position: np.ndarray, number: float) -> np.ndarray:
    """Intensity behind an endless slit, in units of the open light.

    Parameters
    ----------
    position
        Distance from the middle of the shadow in units of the slit's half width.
    number
        Fresnel number ``a^2 / (lambda J)`` of the half width a, of any size.
    """
    root = math.sqrt(2.0 * number)
    near, far = fresnel(root * (position + 1.0)), fresnel(root * (position - 1.0))
    return sum((one - other) ** 2 for one, other in zip(near, far, strict=True)) / 2.0
