"""The pixels of full frames that tell the Sun's direction: `LitPixels`, for bounds."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.memory import digest_of, memory
from benchmark.simulator.light.stray_slope import UnevenScene
from benchmark.simulator.readout.column_noise import CommonNoise, column_noise
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References, pixel_unit_variance
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

#: Largest step of the differences that bounds are made of, radians.
STEP_RAD = 5e-4


@dataclass(frozen=True, eq=False)
class LitPixels:
    """A `MultiSpotSensor` of which only pixels near light are computed, for one batch of samples.

    Which pixels is settled by the Sun directions it is made with; `expected` takes scenes of the
    same samples in the same order, moved or brighter. All other pixels see stray light alone;
    their mean is one more element with the variance of a mean, so that what they say about stray
    light is kept. Where columns have smear or amplifiers of their own, it is one of every column.
    Elements: (N, P + K), K = 1 or the columns, rows with fewer pixels filled up with zeros.
    """

    sensor: MultiSpotSensor
    scene: Scene
    pattern: FixedPattern
    _pixels: NDArray[np.int32] = field(init=False)
    _place: tuple[Hashable, ...] = field(init=False)
    _unit: tuple[Floats, Floats, Floats] = field(init=False)
    _rest: Floats = field(init=False)
    _earth: tuple[Floats, Floats, Floats] = field(init=False)

    def __post_init__(self) -> None:
        detector, pattern = self.sensor.detector, self.pattern
        pixels, sums = self._list_items()
        gain, dark = pattern["gain"].ravel(), pattern["dark_e"].ravel()
        offsets = pattern.get("column_e", np.zeros(detector.columns))
        name = self.sensor.place(pattern), digest_of(pixels), detector.errors.crosstalk
        count, *totals = sums
        some = np.maximum(count, 1.0)
        object.__setattr__(self, "_pixels", pixels)
        object.__setattr__(self, "_place", name)
        object.__setattr__(self, "_unit", (detector.sunlit_e * gain[pixels], dark[pixels], offsets))
        object.__setattr__(self, "_rest", np.stack([count, *(total / some for total in totals)]))
        object.__setattr__(self, "_earth", self._earthlight())

    def _list_items(self) -> tuple[NDArray[np.int32], Floats]:
        """Places (N, P) of the pixels near light; (3, N, K) the others' number, gains and darks."""
        from benchmark.simulator.sensors.lit_pixels_kernel import list_items  # noqa: PLC0415 - Numba on demand

        detector = self.sensor.detector
        shape = detector.rows, detector.columns
        near, place = np.zeros(shape, dtype=np.bool_), np.empty(shape, dtype=np.int32).reshape(-1)
        light = self.sensor.light(self.scene.alone(), self.pattern)
        unit = self.pattern["gain"], self.pattern["dark_e"]
        sums, chosen = np.empty((3, len(self.scene), detector.columns)), []
        for n, margin in enumerate(self._margins()):
            light.mark(near, n, margin)
            mine = np.empty((3, detector.columns))
            count = list_items(place, near, unit, mine)
            sums[:, n] = mine
            chosen.append(place[:count].copy())
        pixels = np.full((len(chosen), max(map(len, chosen), default=0)), -1, dtype=np.int32)
        for row, found in zip(pixels, chosen, strict=True):
            row[: len(found)] = found
        return pixels, sums if self._means > 1 else sums.sum(axis=2, keepdims=True)

    def _margins(self) -> list[int]:
        """Pixels that a step of the differences moves each sample's spots by, and one more."""
        camera = self.sensor.camera
        cosine = np.maximum(camera.assembly.to_head(self.scene.sun)[:, 2], 0.1)
        moved = STEP_RAD * camera.height_mm / self.sensor.detector.pitch_mm / cosine**3
        return [1 + math.ceil(float(one)) for one in np.minimum(moved, 16.0)]

    @property
    def _means(self) -> int:
        """How many means of the other pixels there are."""
        detector = self.sensor.detector
        apart = detector.errors.smear or detector.shared_noise_e or detector.errors.column_offset_e
        return detector.columns if apart else 1

    @property
    def _nowhere(self) -> NDArray[np.bool_]:
        return self._pixels < 0

    def _earthlight(self) -> tuple[Floats, Floats, Floats]:
        """Light of the Earth and uneven stray light, before smear.

        (N, P) on the pixels, (N, K) the others' means with their gains, (N, K) the others' sums
        without.
        """
        detector, pixels = self.sensor.detector, self._pixels
        out = np.zeros(pixels.shape)
        means = np.zeros((len(pixels), self._means))
        beyond = np.zeros((len(pixels), self._means))
        if self.scene.albedo is None and not isinstance(self.scene, UnevenScene):
            return out, means, beyond
        spilling = replace(detector.errors, smear=0.0)
        ones = np.ones(detector.rows * detector.columns)
        for n, mine in enumerate(pixels):
            frame = np.zeros((1, detector.rows, detector.columns))
            if not self.sensor.add_uneven(frame, self.scene.part(n, n + 1)):
                continue
            frame = spilling.gather(frame)
            listed = mine[mine >= 0]
            out[n, : len(listed)] = frame.ravel()[listed]
            frame.ravel()[listed] = 0.0
            beyond[n] = self._add_up(frame.ravel())
            frame[0] *= self.pattern["gain"]
            ones[listed] = 0.0
            means[n] = self._add_up(frame.ravel()) / np.maximum(self._add_up(ones), 1.0)
            ones[listed] = 1.0
        return out, means, beyond

    def _add_up(self, values: Floats) -> Floats:
        """(K,) sums of a flat frame: of all, or of every column."""
        if self._means == 1:
            return np.array([values.sum()])
        return np.asarray(values.reshape(-1, self._means).sum(axis=0))

    def _render(self, sun: Floats) -> NDArray[np.float32]:
        """(N, P) light of mean sunlight on the pixels; single precision, half the room to keep."""
        key = (*self._place, sun.tobytes())
        return memory.render(key, lambda: self._from(sun))

    def _from(self, sun: Floats) -> NDArray[np.float32]:
        from benchmark.simulator.sensors.lit_pixels_kernel import take  # noqa: PLC0415 - Numba on demand

        detector = self.sensor.detector
        frame = np.zeros((detector.rows, detector.columns))
        out = np.zeros(self._pixels.shape, dtype=np.float32)
        light = self.sensor.light(self.scene.alone().seen_from(sun), self.pattern)
        for n, pixels in enumerate(self._pixels):
            boxes = light.add(frame, n)
            take(out[n], frame, pixels, detector.errors.crosstalk)
            for left, right, top, bottom in boxes:
                frame[top:bottom, left:right] = 0.0
        return out

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, P + K) mean digital numbers before rounding; 0 where a row has no such pixel."""
        from benchmark.simulator.sensors.lit_pixels_kernel import read_out  # noqa: PLC0415 - Numba on demand

        detector, errors = self.sensor.detector, self.sensor.detector.errors
        light = self._render(scene.sun)
        count, gain, dark = self._rest
        near, means, _ = self._earth
        numbers = np.empty((len(scene), light.shape[1] + self._means))
        levels = np.column_stack([scene.irradiance, scene.stray])
        smeared = self._smear(light, levels)
        well = detector.full_well_e
        read_out(
            numbers,
            (light, near, smeared, levels),
            self._pixels,
            self._unit,
            (well, errors.nonlinearity / well, detector.gain_e_per_dn, float(detector.offset_dn)),
        )
        rest = scene.stray[:, None] * detector.sunlit_e * gain + dark
        rest += detector.sunlit_e * means
        if errors.smear:
            rest += smeared * detector.sunlit_e * gain
        rest = errors.read(np.minimum(rest, well), well)
        if "column_e" in pattern:
            rest = rest + pattern["column_e"]
        rest = rest / detector.gain_e_per_dn + detector.offset_dn
        numbers[:, light.shape[1] :] = np.where(count > 0, rest, 0.0)
        return numbers

    def _smear(self, light: NDArray[np.float32], levels: Floats) -> Floats:
        """(N, K) light that every pixel of a column gets of all of it; (N, 0) without smear."""
        from benchmark.simulator.sensors.lit_pixels_kernel import column_light  # noqa: PLC0415 - Numba on demand

        if not self.sensor.detector.errors.smear:
            return np.zeros((len(light), 0))
        near, _, beyond = self._earth
        total = beyond + levels[:, 1:] * self._rest[0]
        column_light(total, light, near, self._pixels, levels)
        return np.asarray(self.sensor.detector.errors.smear * total)

    def variance(self, expected: Floats) -> Floats:
        """Squared digital numbers; 1 where a row has no such pixel."""
        # where there is no pixel, a level whose variance is soon found: it is replaced
        levels = expected.copy()
        detector = self.sensor.detector
        levels[:, : -self._means][self._nowhere] = detector.offset_dn + detector.last_code_dn / 2.0
        return self._of_mean(self.sensor.variance(levels))

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:  # noqa: ARG002 - the protocol's
        """Squared digital numbers that the unknown unit adds; 1 where a row has no such pixel."""
        return self._of_mean(pixel_unit_variance(self.sensor.detector, expected, references))

    def _of_mean(self, variance: Floats) -> Floats:
        """Make pixels' variances those of the elements: the last one is a mean."""
        variance[:, : -self._means][self._nowhere] = 1.0
        count, mean = self._rest[0], variance[:, -self._means :]
        mean[:] = np.where(count > 0, mean / np.maximum(count, 1.0), 1.0)
        return np.asarray(variance)

    def common_noise(
        self,
        shape: tuple[int, ...],  # noqa: ARG002 - the protocol's
        references: References | None,
    ) -> CommonNoise | None:
        """Digital numbers that the pixels of a column, and the mean of its others, share."""
        detector = self.sensor.detector
        if self._means == 1:
            return None
        # elements that are none have a group of their own
        near = np.where(self._nowhere, detector.columns, self._pixels % detector.columns)
        rest = np.where(self._rest[0] > 0, np.arange(self._means), detector.columns)
        return column_noise(detector, np.concatenate([near, rest], axis=1), references)

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """As the sensor's: of all pixels."""
        return self.sensor.reference_readings(pattern, references, streams)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As the sensor's."""
        return self.sensor.fixed_pattern(*names)

    def origins(self, sun: Floats, generator: np.random.Generator) -> NDArray[np.int64]:
        """As the sensor's."""
        return self.sensor.origins(sun, generator)

    def observe(self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams) -> NDArray[Any]:
        """As the sensor's: full frames."""
        return self.sensor.observe(scene, pattern, streams)
