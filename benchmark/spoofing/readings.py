"""Readings of one unit under Sun and laser, and what a calibrated pipeline makes of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.pattern_residual import PatternResidual
from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, Observation
from algorithms.pipeline import Pipeline, extract_features, in_detector_coordinates
from benchmark.datasets.corrected import correction
from benchmark.datasets.preset import Preset
from benchmark.metrics.separation import separation_deg
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.spoofing.second_light import with_laser

#: Readings that are simulated together, and pixels that a frame is averaged over, for its residual.
_TOGETHER, _LARGEST_PX = 64, 256
#: Steps of a fit, and of its derivatives, radians and Suns.
_STEPS, _SMALL = 40, 1e-5


class Read(NamedTuple):
    """What N readings say: answers (N, 3), flags, and the two statistics of their patterns."""

    answers: Floats
    flags: NDArray[np.int64]
    pattern: Floats
    brightness: Floats

    def errors_deg(self, sun: Floats) -> Floats:
        """Angles (N,) between answers and Suns, NaN without an answer."""
        return separation_deg(self.answers, sun)


@dataclass(frozen=True)
class Calibrated:
    """The standard unit of a data set, read by one pipeline."""

    preset: Preset
    extractor: type[Extractor]
    model: Scored

    @property
    def condition(self) -> str:
        """The first one."""
        return self.preset.conditions[0]

    @cached_property
    def sensor(self) -> Any:
        """As it is tested."""
        return self.preset.sensor_for(self.condition, "test")

    @cached_property
    def _unit(self) -> Any:
        return self.preset.fixed_pattern(self.condition)

    @cached_property
    def _correction(self) -> Any:
        return correction(self.preset, self.condition)

    @cached_property
    def _reader(self) -> Extractor:
        return self.extractor.for_sensor(self.preset.geometry_for(self.condition))

    @cached_property
    def _fitted(self) -> tuple[Pipeline, PatternResidual]:
        """The pipeline, and the patterns of the same calibration; true directions, as own error."""
        samples = self.preset.generate(self.condition, "calibration")
        reader, geometry = self._reader, self.preset.geometry_for(self.condition)
        pipeline = Pipeline(reader, self.model.for_sensor(geometry, reader.about.kind))
        corrected = self._corrected(samples.observations, samples.origin_px)
        pipeline.fit_features(
            extract_features(reader, corrected, samples.origin_px), samples.truth, None
        )
        focal = None
        if geometry.focal_length_mm is not None and geometry.pixel_pitch_mm is not None:
            focal = geometry.focal_length_mm / geometry.pixel_pitch_mm / self._block
        patterns, origin = self._patterns(corrected, samples.origin_px)
        return pipeline, PatternResidual(focal).fit(patterns, samples.truth, origin)

    def drawn(self, count: int, *names: str | int) -> Scene:
        """Return a scene of Suns and lights drawn as the test's are; windows around the Suns."""
        return self.seeing(self.directions(count, *names), *names)

    def directions(self, count: int, *names: str | int) -> Floats:
        """(count, 3) Suns drawn as the test's are."""
        field: Any = self.preset.directions
        return np.asarray(
            replace(field, test_samples=count).sun("test", generator(*self._named(*names), "sun"))
        )

    def seeing(self, sun: Floats, *names: str | int) -> Scene:
        """Return a scene of these Suns (N, 3), all else drawn; windows around them."""
        named = self._named(*names)
        light = self.preset.condition(self.condition).irradiance
        irradiance, stray = light.draw(len(sun), generator(*named, "irradiance"))
        origin = self.sensor.origins(sun, generator(*named, "window"))
        return Scene(sun, irradiance, stray, origin)

    def alone(self, scene: Scene, laser: Floats, *names: str | int) -> Scene:
        """Return a scene without the Sun; windows are around the laser."""
        dark = self.seeing(laser, *names)
        return replace(dark, irradiance=np.zeros(len(scene)))

    def lasers(self, scene: Scene, *names: str | int) -> Floats:
        """(N, 3) lasers: as the Suns are drawn, or with their image evenly over a window."""
        size = np.array(getattr(self.sensor, "window_px", (0, 0)), dtype=np.float64)
        if scene.origin_px is None or not size.any():
            return self.directions(len(scene), *names, "laser")
        drawn = generator(*self._named(*names), "laser").random((len(scene), 2))
        detector = self.sensor.detector
        place = scene.origin_px - 0.5 + drawn * size - np.asarray(detector.centre_px)
        tangents = place * detector.pitch_mm / self.sensor.camera.focal_length_mm
        ahead = np.column_stack([tangents, np.ones(len(scene))])
        return _unit(ahead)

    def _named(self, *names: str | int) -> tuple[str | int, ...]:
        return ("spoofing", *self.preset.streams, *names)

    def read(
        self, scene: Scene, *names: str | int, laser: Floats | None = None, suns: float = 0.0
    ) -> Read:
        """Simulate a scene, with a laser from (N, 3) or without one, and read it."""
        streams = NoiseStreams.named(*self._named(*names, "noise", f"{suns:g}"))
        parts = [self._one(*part, streams) for part in self._parts(scene, laser, suns)]
        return Read(*(np.concatenate(column) for column in zip(*parts, strict=True)))

    def expected(self, scene: Scene, laser: Floats, suns: float) -> tuple[Floats, Floats]:
        """Mean and variance (N, K) of readings under Sun and laser."""
        both = with_laser(self.sensor, scene, self._unit, laser, suns)
        mean = self.sensor.expected(both, self._unit)
        return mean, self.sensor.variance(mean)

    def fit_one_light(self, scene: Scene, start: Floats, mean: Floats, variance: Floats) -> Floats:
        """(N,) chi-square that the best light leaves of means; damped steps from (N, 3)."""
        sun, bright = start.copy(), np.ones(len(start))
        weight, damping = 1.0 / np.sqrt(variance), np.full(len(start), 1e-3)

        def left(at: Floats, light: Floats) -> Floats:
            seen = replace(scene, sun=at, irradiance=light)
            return np.asarray((mean - self.sensor.expected(seen, self._unit)) * weight)

        best = left(sun, bright)
        for _ in range(_STEPS):
            axes = tangent_axes(sun)
            moved = [_unit(sun + _SMALL * axis) for axis in axes]
            slopes = [left(at, bright) - best for at in moved]
            slopes.append(left(sun, bright + _SMALL) - best)
            jacobian = np.stack(slopes, axis=2) / _SMALL
            normal = np.einsum("nki,nkj->nij", jacobian, jacobian)
            ridge = damping[:, None] * (np.einsum("nii->ni", normal) + 1e-12)
            normal[:, range(3), range(3)] += ridge
            right = -np.einsum("nki,nk->ni", jacobian, best)
            step = np.linalg.solve(normal, right[..., None])[..., 0]
            tried = _unit(sun + step[:, :1] * axes[0] + step[:, 1:2] * axes[1])
            brighter = np.maximum(bright + step[:, 2], 1e-3)
            now = left(tried, brighter)
            better = (now**2).sum(axis=1) < (best**2).sum(axis=1)
            sun[better], bright[better], best[better] = tried[better], brighter[better], now[better]
            damping = np.where(better, damping / 5.0, damping * 5.0)
        return np.asarray((best**2).sum(axis=1))

    def _parts(
        self, scene: Scene, laser: Floats | None, suns: float
    ) -> Iterator[tuple[Scene, Any]]:
        for start in range(0, len(scene), _TOGETHER):
            part = scene.part(start, start + _TOGETHER)
            if laser is not None:
                beam = laser[start : start + _TOGETHER]
                part = with_laser(self.sensor, part, self._unit, beam, suns)
            yield part, part.origin_px

    def _one(self, scene: Scene, origin: Any, streams: NoiseStreams) -> Read:
        pipeline, residual = self._fitted
        corrected = self._corrected(self.sensor.observe(scene, self._unit, streams), origin)
        found = self._reader.measure(corrected)
        features = in_detector_coordinates(found.features, self._reader.about.kind, origin)
        answers = pipeline.predict_features(features)
        patterns, first = self._patterns(corrected, origin)
        left = residual.measure(patterns, answers, first)
        return Read(answers, found.flags, left.pattern, left.brightness)

    def _corrected(self, observations: NDArray[Any], origin: Any) -> Any:
        by = self._correction
        if by is None:
            return observations
        return by.correct(observations, origin if by.dark.ndim == 2 else None)

    @property
    def _block(self) -> int:
        """Pixels an axis that the patterns of large frames are averaged over."""
        window = getattr(self.sensor, "window_px", None)
        rows = getattr(getattr(self.sensor, "detector", None), "rows", 1)
        return 1 if window is not None else max(1, rows // _LARGEST_PX)

    def _patterns(self, corrected: Any, origin: Any) -> tuple[Floats, Any]:
        """Return currents or images as `PatternResidual` takes them, of events 1 / time."""
        values = np.asarray(corrected, dtype=np.float64)
        if self.preset.observation is Observation.EVENTS:
            detector = self.sensor.detector
            images = np.zeros((len(values), detector.rows, detector.columns))
            at, event = np.nonzero(np.isfinite(values).all(axis=2))
            x, y, time_us = values[at, event].T
            images[at, y.astype(int), x.astype(int)] = 1.0 / time_us
            return images, None
        block = self._block
        if values.ndim == 3 and block > 1:
            count, rows, columns = values.shape
            shape = count, rows // block, block, columns // block, block
            return values.reshape(shape).mean(axis=(2, 4)), None
        return values, origin if values.ndim == 3 else None


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))
