"""What speaks against the answers: from the numbers that tell one symmetric spot from others.

After the last stage of `mirror.registration`, which says what the arrays
hold, and writes what that returns.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror.records import Form, Light, State
from algorithms.kernels.records import Records
from algorithms.measurement import QualityFlag

#: Light that departs in clusters of pairs, over the spot's, and the square of what neighbours miss
#: alike, over that of the light: above either, the spot is not symmetric.
_CLUSTERS, _ALIKE = 0.02, 0.0006
#: Mean square of the departures, over what is expected, from which there is a ghost, and from which
#: the spot is not symmetric; more, over the high outline's area, where few pixels tell.
_SCATTER_GHOST, _SCATTER, _GHOST_FEW, _SCATTER_FEW = 1.8, 3.5, 100.0, 150.0
#: The outlines of one spot are alike at all heights: largest ratio of the squared ratios of their
#: extents, more by 1 over the area, by the cube of that, as few pixels have the outline of their
#: grid, and by the noise; px by which the extents may differ.
_UNLIKE, _UNLIKE_FEW, _UNLIKE_GRID, _UNLIKE_NOISE = 1.26, 5.0, 300.0, 1.5
_UNLIKE_PX, _UNLIKE_NOISE_PX = 0.42, 3.0
#: Area of an ellipse with an outline's second moments over its own: 1.05 for a square.
_WAIST, _WAIST_FEW, _WAIST_NOISE = 1.065, 2.0, 0.8
#: Pixels of a sharp high outline that tell its shape; over the low one's, of what is but a top
#: where two lights overlap: 0.24 for a Gaussian.
_SHARP, _TOP = 12.0, 0.15
#: Standard deviation of the centre, px, over which it is not known.
_UNSURE = 0.5
#: From the lit light's centroid, in half extents and px, no registration leads further.
_ASTRAY, _ASTRAY_PX = 0.25, 0.75
#: Bits of converters whose most is looked for.
_FEWEST_BITS, _MOST_BITS = 8, 16
_NO_SPOT, _SEVERAL, _CUT = (
    int(QualityFlag.NO_SPOT),
    int(QualityFlag.SEVERAL_SPOTS),
    int(QualityFlag.CUT),
)
_SATURATED, _NOT_SYMMETRIC, _GHOST = (
    int(QualityFlag.SATURATED),
    int(QualityFlag.NOT_SYMMETRIC),
    int(QualityFlag.GHOST),
)


@compiled
def _is_saturated(frame: NDArray[Any], brightest: float) -> bool:
    """Whether the spot's neighbouring pixels are at ``2**bits - 1``, and no pixel is above."""
    whole = float(round(brightest))
    if not abs(whole - brightest) < 1e-6:
        return False
    most = 2.0**_FEWEST_BITS
    while most - 1.0 < whole:
        most *= 2.0
    if most - 1.0 != whole or most > 2.0**_MOST_BITS:
        return False
    for row in frame:
        for value in row:
            if value > whole:
                return False
    return True


@compiled
def _several(form: Form, noise: float) -> bool:
    """Whether outlines are not those of one spot: they have a waist, or differ with height."""
    area = form.area
    if not area > 0.0:
        return False
    if form.waist > _WAIST + _WAIST_FEW / area + _WAIST_NOISE * noise:
        return True
    most = _UNLIKE + _UNLIKE_FEW / area + _UNLIKE_GRID / area**3 + _UNLIKE_NOISE * noise
    for sharp in (False, True):
        one, other = form.sharp if sharp else form.blurred
        apart = 2.0 * math.sqrt(max(form.minor, 0.0)) * (math.sqrt(one) - math.sqrt(other))
        tells = not sharp or (area >= _SHARP and area < _TOP * form.base)
        if tells and one > most * other and apart > _UNLIKE_PX + _UNLIKE_NOISE_PX * noise:
            return True
    return False


@compiled
def _form_flags(light: Light, state: State, form: Form, centre: Floats, saturated: bool) -> int:
    """Return the flags for departures from symmetry."""
    area, departing = form.area, form.lenient
    flags = 0
    crooked = form.clusters > _CLUSTERS or form.alike > _ALIKE
    for axis in range(2):
        far = abs(centre[axis] - light.middle[axis])
        crooked = crooked or far > _ASTRAY * light.half[axis] + _ASTRAY_PX
    if area > 0.0 and not saturated:
        crooked = crooked or departing > _SCATTER + _SCATTER_FEW / area
        if departing > _SCATTER_GHOST + _GHOST_FEW / area:
            flags |= _GHOST
    if crooked:
        flags |= _NOT_SYMMETRIC
    if max(state.xx, state.yy) * form.scatter > _UNSURE * _UNSURE:
        flags |= _NO_SPOT
    return flags


@compiled
def conclude(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    seen: NDArray[np.int64],
    longest_px: float,
    lights: Records,
    boxes: Records,
    middles: NDArray[np.int64],
    states: Records,
    forms: Records,
    features: Floats,
    covariance: Floats,
    flags: NDArray[np.int64],
    noise: Floats,
) -> None:
    """Write centres, covariances, flags and noise of the frames `seen` to the last four.

    Outlines up to `longest_px` are of one spot, whatever their shape: what is no longer than one
    has fringes, and oblique ones are skew.
    """
    centre = np.empty(2)
    for k in range(len(seen)):
        at, light, state, form = seen[k], lights[k], states[k], forms[k]
        saturated = _is_saturated(frames[at], light.base + light.peak)
        found = _SATURATED if saturated else 0
        for axis in range(2):
            centre[axis] = 0.5 * (middles[k, axis] + state.d[axis])
        if boxes[k].columns == 0:
            found |= _CUT
        if np.isfinite(state.xx):
            found |= _form_flags(light, state, form, centre, saturated)
            if not 2.0 * math.sqrt(max(form.major, 0.0)) <= longest_px:
                found |= _NOT_SYMMETRIC if form.skew and not saturated else 0
                found |= _SEVERAL if _several(form, math.sqrt(state.dark)) else 0
        else:
            found |= _NO_SPOT
        flags[at] = found
        noise[at, 0], noise[at, 1] = state.dark * light.peak**2, state.gain * light.peak
        if found & ~(_SATURATED | _GHOST) == 0:
            features[at] = centre
            scatter = form.scatter
            covariance[at, 0, 0], covariance[at, 1, 1] = state.xx * scatter, state.yy * scatter
            covariance[at, 0, 1] = covariance[at, 1, 0] = state.xy * scatter
