"""Whether a frame holds exactly one whole light, for methods that cannot tell that themselves.

A centroid or a fit has an answer to two lights, to one that the edge cuts and to a hot pixel. What
`algorithms.extractors.frames.mirror.registration` finds of the same frame tells these from a spot,
and says where the spot is: an answer elsewhere is none.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats, SensorGeometry
from algorithms.extractors.frames.mirror.records import LIGHT
from algorithms.inputs import Frames, as_frames
from algorithms.measurement import QualityFlag, as_batch, without_bad
from algorithms.parameters import require_choice, require_positive

Light = Literal["spot", "any"]
"""What a design's light looks like. ``spot``: compact, symmetric and whole. ``any``: streaks, rings
and stars, as lenses and slits make them; all that is asked is that there is light at all."""

#: An answer further than this, px, and so many standard deviations from the registered centre is
#: of something else.
_APART_PX, _APART = 0.5, 3.0
#: Deviations of its own from which an answer is too far from the registered centre to state them.
_CONTRADICTED = 2.0
#: The middle of silicon's sunlight; the steepest rays' tangent that spots are expected of.
_MIDDLE_MM, _STEEPEST = 6e-4, 2.5
#: Half axes that are allowed over those of the design.
_ROOM = 1.15


def require_light(by: str, light: str, longest_px: float | None) -> None:
    """Raise ValueError unless `light` is one of `Light` and `longest_px` None or positive."""
    require_choice(by, Light, light=light)
    if longest_px is not None:
        require_positive(by, longest_px=longest_px)


def light_of(geometry: SensorGeometry) -> Light:
    """Return what a design's light looks like: a spot behind a hole of known shape, or anything."""
    return "any" if geometry.aperture_shape is None else "spot"


def longest_px_of(geometry: SensorGeometry) -> float | None:
    """Longest half axis of a spot in the field's corner; None where the design does not tell.

    Of the shadow's second moments, or the far pattern's where that is larger, a seventh more.
    """
    width, height, pitch = (
        geometry.aperture_width_mm,
        geometry.focal_length_mm,
        geometry.pixel_pitch_mm,
    )
    field, shape = geometry.half_fov_deg, geometry.aperture_shape
    if width is None or height is None or pitch is None or field is None or shape is None:
        return None
    shadow = width / (2.0 if shape == "round" else math.sqrt(3.0))
    # where a square field's corner lands, and how its spots are drawn out there
    corner = min(math.sqrt(2.0) * math.tan(math.radians(field)), _STEEPEST)
    drawn_out = height * (1.0 + corner**2) ** 1.5
    far = 0.64 * _MIDDLE_MM * drawn_out / width
    return float(_ROOM * (shadow**4 + far**4) ** 0.25 / pitch + 0.5)


def frames_to_measure(observations: ArrayLike, bad: ArrayLike | None, by: str) -> Frames:
    """Frames (N, H, W) of a batch or of one, bad pixels replaced; ValueError on wrong input."""
    frames = as_frames(as_batch(observations, "frames"))
    return frames if bad is None else as_frames(without_bad(frames, bad, by))


class LightCheck(NamedTuple):
    """What the frames say of answers to them.

    Attributes
    ----------
    flags
        (N,) `algorithms.measurement.QualityFlag` flags. Those that `refused_flags` is true of leave
        no answer; NO_SPOT where there is none, or it is of something else than the light.
    noise
        (N, 2) variance of a dark pixel, and what a unit of light adds to it; NaN where unknown.
    centres
        (N, 2) centres that registration finds, px; NaN where it finds none or was not asked.
    """

    flags: NDArray[np.int64]
    noise: Floats
    centres: Floats


def judge(
    frames: Frames,
    centres: Floats,
    light: Light = "spot",
    longest_px: float | None = None,
    bad: ArrayLike | None = None,
) -> LightCheck:
    """Say of each answer why it is not the centre of the one light in its frame.

    Parameters
    ----------
    frames : ndarray, shape (N, H, W)
        As `algorithms.inputs.as_frames` gives them.
    centres : ndarray, shape (N, 2)
        Answers of some method, px; NaN rows are no answers, and are not looked at.
    light : {"spot", "any"}
        What the light looks like.
    longest_px : float, optional
        As for `algorithms.extractors.frames.mirror.registration.register`.
    bad : array_like of bool, shape (H, W), optional
        Pixels to leave out.

    Returns
    -------
    Judged
        Flags, noise and registered centre of each frame.

    Examples
    --------
    >>> y, x = np.mgrid[:40, :40]
    >>> disc = 900 / (1 + np.exp(2 * (np.hypot(x - 21.3, y - 18.8) - 7)))
    >>> frames = np.random.default_rng(1).normal(50 + disc + 1500 * (y < 6), 5.0)[None]
    >>> QualityFlag(judge(frames, np.array([[20.5, 12.1]])).flags[0])
    <QualityFlag.CUT: 4>
    """
    flags = np.full(len(frames), int(QualityFlag.NO_SPOT), dtype=np.int64)
    noise, registered = np.full((2, len(frames), 2), np.nan)
    seen = np.flatnonzero(np.isfinite(centres).all(axis=1))
    if not len(seen):
        return LightCheck(flags, noise, registered)
    some = frames if len(seen) == len(frames) else frames[seen]
    if light == "any":
        flags[seen] = _unlit(some)
    else:
        flags[seen], noise[seen], registered[seen] = _elsewhere(
            some, centres[seen], longest_px, bad
        )
    return LightCheck(flags, noise, registered)


def refused_flags(flags: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return where flags leave no answer; SATURATED and GHOST may stand beside one."""
    return np.asarray((flags & ~int(QualityFlag.SATURATED | QualityFlag.GHOST)) != 0)


def consistent_covariances(covariance: Floats, centres: Floats, judged: LightCheck) -> Floats:
    """Return covariances (N, 2, 2) of centres (N, 2), NaN where registration contradicts them.

    It assumes no shape and no flat background: a centre that is two of its own deviations away is
    off by something that the method's covariance does not know of.
    """
    deviations = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    apart = np.abs(centres - judged.centres) / deviations
    near = apart.max(axis=1) <= _CONTRADICTED
    return np.where(near[:, None, None], covariance, np.nan)


def check_agreement(
    frames: Frames, centres: Floats, light: Light = "spot", longest_px: float | None = None
) -> Floats:
    """Return the answers (N, 2) that nothing speaks against, and NaN for the others."""
    flags = judge(frames, centres, light, longest_px).flags
    return np.where(refused_flags(flags)[:, None], np.nan, centres)


def _elsewhere(
    frames: Frames, centres: Floats, longest_px: float | None, bad: ArrayLike | None
) -> LightCheck:
    from algorithms.extractors.frames.mirror.registration import register_frames  # noqa: PLC0415 - Numba

    found, noise = register_frames(frames, bad, longest_px)
    room = _APART_PX + _APART * found.deviations.max(axis=1)
    # registration's own NaN carries its reason already
    apart = np.abs(centres - found.features).max(axis=1) > room
    flags = found.flags | np.where(apart, int(QualityFlag.NO_SPOT), 0)
    return LightCheck(flags, noise, found.features)


def _unlit(frames: Frames) -> NDArray[np.int64]:
    """NO_SPOT where no 2 x 2 pixels are above the border's noise: nothing, or a hot pixel."""
    from algorithms.extractors.frames.mirror import search_kernel as search  # noqa: PLC0415 - Numba

    if min(frames.shape[1:]) < 5:
        return np.full(len(frames), int(QualityFlag.NO_SPOT), dtype=np.int64)
    lights = np.empty(len(frames), dtype=LIGHT)
    search.find_lights(frames, np.zeros(len(frames), dtype=np.bool_), lights)
    return np.where(lights["refusal"] == search.DARK, int(QualityFlag.NO_SPOT), 0).astype(np.int64)
