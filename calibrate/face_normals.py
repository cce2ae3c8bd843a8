"""Where the channels of a sensor look, estimated from the light that each takes."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from calibrate.readings import Readings


def face_normals(readings: Readings) -> tuple[Floats, Floats]:
    """Return where each channel looks (K, 3), and how it goes with the light there (K,).

    By least squares of signal over the cosine: on all samples first, then on those that light it.
    """
    sun, signals = readings.sun, readings.features
    normals = np.zeros((signals.shape[1], 3))
    explained = np.zeros(signals.shape[1])
    for at, signal in enumerate(signals.T):
        normal, lit = np.zeros(3), np.ones(len(sun), dtype=np.bool_)
        for _ in range(20):
            if lit.sum() < 6:
                break
            found = np.linalg.lstsq(sun[lit], signal[lit], rcond=None)[0]
            length = np.linalg.norm(found)
            if not length > 0:
                break
            normal = found / length
            lit = sun @ normal > 0.2
        normals[at] = normal
        with np.errstate(invalid="ignore"):
            share = np.corrcoef(signal, np.maximum(sun @ normal, 0.0))[0, 1]
        explained[at] = share if np.isfinite(share) else 0.0
    return normals, explained
