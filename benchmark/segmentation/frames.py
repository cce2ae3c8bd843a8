"""Frames of one unit under a fault, with the pixels that the Sun's own image lights."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.learned.frames import Unit
from benchmark.seeds import generator
from benchmark.simulator.optics.earthlight import add_between
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.spoofing.second_light import with_laser

#: Disturbances that each fault puts into a frame. `clean` has none; the last two have not one Sun.
FAULTS: Mapping[str, frozenset[str]] = {
    "clean": frozenset(),
    "glare": frozenset({"glare"}),
    "dirt": frozenset({"dirt"}),
    "laser": frozenset({"laser"}),
    "dim": frozenset({"dim"}),
    "dim-glare": frozenset({"dim", "glare"}),
    "dirt-laser": frozenset({"dirt", "laser"}),
    "no-sun": frozenset({"dark"}),
    "two-suns": frozenset({"sun"}),
}
#: Faults with one Sun, which decide; frames that must not be answered.
ONE_SUN = tuple(FAULTS)[1:-2]
UNANSWERABLE = tuple(FAULTS)[-2:]

#: Share of the clean image's peak from which a pixel belongs to it.
OF_PEAK = 0.2
#: Least and largest, drawn evenly in the logarithm: light of glare's points and of dim Suns, Suns;
#: of a laser evenly.
GLARE, DIM, LASER = (0.03, 0.5), (0.01, 0.1), (0.1, 0.8)
#: Points an axis between which glare is bilinear.
_POINTS = 4
#: Particles on the detector's window: share of it that they cover, radii and opacities.
_COVERED, _RADII_PX, _OPAQUE = 0.1, (2.0, 10.0), (0.3, 1.0)
#: Frames between which dirt is drawn anew.
_TOGETHER = 20
#: Images of two Suns are at least so far apart.
_APART_PX = 16.0


class Drawn(NamedTuple):
    """N frames, corrected by the unit's dark and flat readings.

    Attributes
    ----------
    frames
        (N, H, W) digital numbers.
    truth
        (N, H, W) pixels that the Sun lights; of no Sun none, of two those of both.
    sun, light
        (N, 3) directions, and (N,) light in mean Suns.
    origin
        (N, 2) first pixel (x, y) of each window.
    """

    frames: Floats
    truth: NDArray[np.bool_]
    sun: Floats
    light: Floats
    origin: NDArray[np.int64]


class FaultyUnit(Unit):
    """A unit whose frames something may be wrong with."""

    def calibration(self) -> tuple[Floats, Floats, NDArray[np.int64]]:
        """Return clean frames (N, H, W), true Suns (N, 3) and windows' first pixels (N, 2)."""
        samples = self.preset.generate(self._condition, "calibration")
        origin = np.asarray(samples.origin_px)
        return self.correct(samples.observations, origin), samples.truth, origin

    def drawn(self, fault: str, count: int) -> Drawn:
        """Return frames under a fault, always the same; Suns drawn as the test's are."""
        parts = [
            self._part(fault, start, min(_TOGETHER, count - start))
            for start in range(0, count, _TOGETHER)
        ]
        return Drawn(*(np.concatenate(column) for column in zip(*parts, strict=True)))

    def _part(self, fault: str, start: int, count: int) -> Drawn:
        wrong = FAULTS[fault]
        named = ("segmentation", *self.preset.streams, "unit", self.preset.unit, fault, start)
        sun = self._suns(count, *named, "sun")
        light, stray = self.preset.condition(self._condition).irradiance.draw(
            count, generator(*named, "irradiance")
        )
        if "dim" in wrong:
            light *= _between(generator(*named, "dim"), DIM, count)
        if "dark" in wrong:
            light[:] = 0.0
        origin = self.sensor.origins(sun, generator(*named, "window"))
        scene = Scene(sun, light, stray, origin)
        truth = _lit(self._light(replace(scene, irradiance=np.ones(count))))
        truth &= (light > 0.0)[:, None, None]
        pattern = self._pattern
        more = np.zeros(truth.shape)
        if "laser" in wrong:
            levels = generator(*named, "level").uniform(*LASER, count)
            beam = self._beside(scene, *named, "laser")
            lit = with_laser(self.sensor, scene, pattern, beam, 1.0).albedo
            more += np.asarray(lit) * levels[:, None, None]
        if "sun" in wrong:
            other = self._apart(scene, *named, "other")
            second = self._light(replace(scene, sun=other, irradiance=np.ones(count)))
            more += second
            truth |= _lit(second)
        if wrong & {"glare", "dark"}:
            drawn = generator(*named, "glare")
            level = _between(drawn, GLARE, count)
            if "dark" in wrong:
                level[::2] = 0.0  # half of the frames without a Sun have no glare either
            nodes = level[:, None, None] * drawn.exponential(size=(count, _POINTS, _POINTS))
            add_between(more, nodes)
        if "dirt" in wrong:
            detector = self.sensor.detector
            passed = _particles(generator(*named, "dirt"), (detector.rows, detector.columns))
            pattern = {**pattern, "gain": pattern["gain"] * passed}
        seen = replace(scene, albedo=more)
        observed = self.sensor.observe(seen, pattern, NoiseStreams.named(*named, "noise"))
        return Drawn(self.correct(observed, origin), truth, sun, light, np.asarray(origin))

    def _suns(self, count: int, *named: str | int) -> Floats:
        field: Any = self.preset.directions
        return np.asarray(replace(field, test_samples=count).sun("test", generator(*named)))

    def _light(self, scene: Scene) -> Floats:
        if hasattr(self.sensor, "window_px"):
            return np.array(self.sensor.lit(scene))
        return np.array(self.sensor.lit(scene, self._pattern))

    def _beside(self, scene: Scene, *named: str | int) -> Floats:
        """(N, 3) directions of other lights: their image evenly over a window, else as Suns."""
        if not hasattr(self.sensor, "window_px"):
            return self._suns(len(scene), *named)
        detector, height = self.sensor.detector, self.sensor.camera.focal_length_mm
        drawn = generator(*named).random((len(scene), 2)) * np.array(self.sensor.window_px)
        place = np.asarray(scene.origin_px) - 0.5 + drawn - np.asarray(detector.centre_px)
        ahead = np.column_stack([place * detector.pitch_mm / height, np.ones(len(scene))])
        return np.asarray(ahead / np.linalg.norm(ahead, axis=1, keepdims=True))

    def _apart(self, scene: Scene, *named: str | int) -> Floats:
        """As `_beside`, drawn until the images are `_APART_PX` apart."""
        found = scene.sun.copy()
        for turn in range(100):
            shift = found[:, :2] / found[:, 2:] - scene.sun[:, :2] / scene.sun[:, 2:]
            far = np.hypot(*shift.T) * self.sensor.camera.focal_length_mm
            near = far < _APART_PX * self.sensor.detector.pitch_mm
            if not near.any():
                return found
            found[near] = self._beside(scene, *named, turn)[near]
        raise ValueError("no place for a second Sun was found in a hundred draws")


def _lit(light: Floats) -> NDArray[np.bool_]:
    """Pixels (N, H, W) of a clean image that are lit."""
    return np.asarray(light > OF_PEAK * light.max(axis=(1, 2), keepdims=True))


def _between(drawn: np.random.Generator, span: tuple[float, float], count: int) -> Floats:
    least, largest = np.log(span)
    return np.exp(drawn.uniform(float(least), float(largest), count))


def _particles(drawn: np.random.Generator, shape: tuple[int, int]) -> Floats:
    """Light that passes discs of dirt over pixels of `shape`; discs may overlap."""
    passed = np.ones(shape)
    least, largest = _RADII_PX
    disc = np.pi * (least**2 + least * largest + largest**2) / 3.0
    for _ in range(round(_COVERED * passed.size / disc)):
        x, y = drawn.random(2) * np.array(shape[::-1])
        radius, opaque = drawn.uniform(*_RADII_PX), drawn.uniform(*_OPAQUE)
        rows = slice(max(int(y - radius) - 1, 0), int(y + radius) + 2)
        columns = slice(max(int(x - radius) - 1, 0), int(x + radius) + 2)
        near = passed[rows, columns]
        i = np.arange(near.shape[0])[:, None] + rows.start - y
        j = np.arange(near.shape[1]) + columns.start - x
        near *= 1.0 - opaque * np.clip(radius - np.hypot(i, j) + 0.5, 0.0, 1.0)
    return passed
