"""Extractors of single spots beside other libraries, and on frames drawn afresh by SEED.

Errors are multiples of the Cramer-Rao bound of an axis, times are multiples of a Python loop of
OpenCV's threshold and moments. No limit was changed after measuring.
"""

from __future__ import annotations

import os

import cv2
import numpy as np

from algorithms.contract import Extractor, FeatureKind, Observation, SensorGeometry
from algorithms.discovery import discover_extractors
from algorithms.extractors.frames.mirror.extractor import MirrorRegistration
from algorithms.extractors.frames.template import TemplateMatch
from benchmark.synthetic_features.frame_sets import FRAME_SETS
from benchmark.synthetic_features.frames import REFERENCE_SETS
from benchmark.synthetic_features.series import WRONG_PX

from .paired import at_most, ratio
from .peers import OPENCV, PEERS

SEED = int(os.environ.get("SEED") or 1)
_SETS = {one.name: one for one in FRAME_SETS}
#: Frames: of an error, of a time, and of a peer, which may take a tenth of a second each.
_FRAMES, _TIMED, _OF_PEERS = 1000, 100, 100
#: Pitch of the sensor that a spot is the shadow of; any will do.
_PITCH_MM = 0.01
#: Largest time over OpenCV's, by method and set.
_TIME = {
    **{("bctm", name): 0.15 for name in ("disc", "gaussian")},
    ("bctm", "disc-512"): 0.25,
    **{(method, name): 0.3 for method in ("bcm", "pm", "dbcm", "ifm") for name in REFERENCE_SETS},
}
#: Largest error over the bound, by method and set, or by kind of set for the estimator `mirror`.
_ERROR = {("tm binarise=no", "disc"): 1.3}
_ERROR_BY_KIND = {"symmetric": 1.15, "stray": 2.5}
#: Largest share of frames of faults that a method of ours answers wrongly.
_WRONG = 0.001


def single_spot(half_px: float, size_px: int) -> dict[str, Extractor]:
    """Return the extractors of single spots, made for frames of this side, by name.

    `half_px` is half the width of the sensor's round aperture.
    """
    middle = (size_px - 1) / 2.0
    sensor = SensorGeometry(
        focal_length_mm=1.0,
        pixel_pitch_mm=_PITCH_MM,
        centre_px=(middle, middle),
        aperture_width_mm=float(2 * half_px * _PITCH_MM),
        aperture_shape="round",
        half_fov_deg=30.0,
    )
    found: dict[str, Extractor] = {
        "tm binarise=no": TemplateMatch(width_px=float(2 * half_px), binarise=False)
    }
    for name, extractor in discover_extractors().items():
        about = extractor.about
        if about.observation is Observation.FRAMES and about.kind is FeatureKind.SPOT:
            try:
                found[name] = extractor.for_sensor(sensor)
            except ValueError:  # not a method for one spot
                continue
    return found


def _half_px(name: str) -> float:
    chosen = REFERENCE_SETS[name]
    return chosen.scale_px * (np.sqrt(2 * np.log(2)) if chosen.shape == "gaussian" else 1.0)


_METHODS = sorted(single_spot(8.0, 64))
_OURS = [
    name
    for name, extractor in discover_extractors().items()
    if extractor.about.origin == "ours" and name in _METHODS
]


class ReferenceSpots:
    """Discs and Gaussians whose bound is known: our extractors and peers."""

    params = (list(REFERENCE_SETS), [*_METHODS, *PEERS])
    param_names = ("frames", "method")

    def setup(self, name: str, method: str) -> None:
        cv2.setNumThreads(1)
        chosen = REFERENCE_SETS[name]
        self.frames, self.centres = chosen.frames(_OF_PEERS if method in PEERS else _FRAMES)
        self.bound_px = chosen.bound_px(self.centres[:100])
        if method in PEERS:
            self.call = PEERS[method]
        else:
            self.call = single_spot(_half_px(name), chosen.size_px)[method].extract
        try:
            self.call(self.frames[:2])  # compiles
        except ImportError as error:
            raise NotImplementedError(f"make install brings {error.name}") from error

    def track_error_over_bound(self, name: str, method: str) -> float:
        errors = self.call(self.frames) - self.centres
        error = float(np.sqrt(np.nanmean(errors**2)))
        return at_most(_ERROR.get((method, name)), error / self.bound_px)

    def track_time_over_opencv(self, name: str, method: str) -> float:
        few = self.frames[: _OF_PEERS // 10 if method in PEERS else _TIMED]
        found = ratio(lambda: self.call(few), lambda: PEERS[OPENCV](few), repeats=7)
        return at_most(_TIME.get((method, name)), found)


class ReferenceRatios:
    """Errors beside each other."""

    params = tuple(REFERENCE_SETS)
    param_names = ("frames",)

    def track_error_of_bctm_over_opencv(self, name: str) -> float:
        chosen = REFERENCE_SETS[name]
        frames, centres = chosen.frames(_FRAMES)
        bctm = single_spot(_half_px(name), chosen.size_px)["bctm"].extract
        ours, theirs = (((call(frames) - centres) ** 2).mean() for call in (bctm, PEERS[OPENCV]))
        return at_most(1.0, float(np.sqrt(ours / theirs)))


class DrawnFrames:
    """Frames of other shapes and sizes, in stray light, with faults or no Sun: our extractors."""

    params = (list(_SETS), _OURS)
    param_names = ("frames", "method")

    def setup(self, name: str, method: str) -> None:
        cv2.setNumThreads(1)
        chosen = _SETS[name]
        share = (64 / chosen.size_px) ** 2 * (2 if chosen.kind == "fault" else 1)
        self.scenes = chosen.draw(SEED, max(round(share * _FRAMES), 25))
        made: Extractor = MirrorRegistration()  # a shape alone has no sensor
        if method != MirrorRegistration.about.name:
            made = single_spot(chosen.shape.half_px, chosen.size_px)[method]
        found = made.measure(self.scenes.frames)
        self.errors = found.features - self.scenes.centres
        self.answered = np.isfinite(found.features).all(axis=1)
        self.timed = made.extract

    def track_error_over_bound(self, name: str, method: str) -> float:
        limit = _ERROR_BY_KIND.get(_SETS[name].kind) if method == "mirror" else None
        if not np.isfinite(self.errors).any():
            return float("nan")  # nothing to find, or nothing found
        error = float(np.sqrt(np.nanmean(self.errors**2)))
        return at_most(limit, error / self.scenes.bound_px)

    def track_share_wrong(self, name: str, method: str) -> float:
        """Answers more than a pixel off, or where there is nothing to find."""
        wrong = ~(np.hypot(*self.errors[self.answered].T) <= WRONG_PX)
        share = float(wrong.sum() / len(self.errors))
        return at_most(_WRONG if _SETS[name].kind == "fault" else None, share)

    def track_time_over_opencv(self, name: str, method: str) -> float:
        few = self.scenes.frames[:_TIMED]
        chosen = _SETS[name]
        judged = method == "mirror" and chosen.kind == "symmetric" and chosen.size_px == 64
        judged = judged and chosen.shape.longest_px <= 8.0
        found = ratio(lambda: self.timed(few), lambda: PEERS[OPENCV](few), repeats=5)
        return at_most(1.0 if judged else None, found)
