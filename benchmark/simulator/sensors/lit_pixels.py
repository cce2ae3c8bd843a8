"""The pixels of full frames that tell the Sun's direction: `LitPixels`, for bounds."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.memory import digest_of, memory
from benchmark.simulator.readout.column_noise import CommonNoise, column_noise
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

#: Pixels kept around every spot, for derivatives over direction: a step of 5e-4 rad moves a spot
#: 12 mm below its aperture, at 60 deg, by 1.2 pixels of 20 micrometres.
MARGIN_PX = 3


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
    _pixels: NDArray[np.int64] = field(init=False)
    _nowhere: NDArray[np.bool_] = field(init=False)
    _gain: Floats = field(init=False)
    _dark: Floats = field(init=False)
    _rest: Floats = field(init=False)
    _earth: Floats = field(init=False)
    _beyond: Floats = field(init=False)
    _light: Floats = field(init=False)

    def __post_init__(self) -> None:
        detector = self.sensor.detector
        boxes = self.sensor.boxes(self.scene, self.pattern, MARGIN_PX)
        gain, dark = self.pattern["gain"].ravel(), self.pattern["dark_e"].ravel()
        chosen, rest = [], np.zeros((3, len(self.scene), self._means))
        for n, mine in enumerate(boxes):
            near = np.zeros((detector.rows, detector.columns), dtype=np.bool_)
            for left, right, top, bottom in mine:
                near[top:bottom, left:right] = True
            chosen.append(np.flatnonzero(near))
            far = ~near.ravel()
            count = self._sums(np.ones(far.size), far)
            some = np.maximum(count, 1.0)
            rest[:, n] = count, self._sums(gain, far) / some, self._sums(dark, far) / some
        pixels = np.full((len(chosen), max((len(c) for c in chosen), default=0)), -1)
        for row, mine in zip(pixels, chosen, strict=True):
            row[: len(mine)] = mine
        object.__setattr__(self, "_pixels", pixels)
        object.__setattr__(self, "_nowhere", pixels < 0)
        object.__setattr__(self, "_gain", detector.sunlit_e * gain[pixels])
        object.__setattr__(self, "_dark", dark[pixels])
        object.__setattr__(self, "_rest", rest)
        earth, beyond = self._earthlight(pixels)
        object.__setattr__(self, "_earth", earth)
        object.__setattr__(self, "_beyond", beyond)
        object.__setattr__(self, "_light", self._rendered(self.scene.sun))

    @property
    def _means(self) -> int:
        """How many means of the other pixels there are."""
        detector = self.sensor.detector
        apart = detector.errors.smear or detector.shared_noise_e or detector.errors.column_offset_e
        return detector.columns if apart else 1

    def _sums(self, values: Floats, chosen: NDArray[np.bool_]) -> Floats:
        """(K,) sums of some pixels of a flat frame: of all, or of every column."""
        if self._means == 1:
            return np.array([values[chosen].sum()])
        return np.asarray(np.where(chosen, values, 0.0).reshape(-1, self._means).sum(axis=0))

    def _columns_of(self, pixels: NDArray[np.int64]) -> NDArray[np.int64]:
        return np.asarray(pixels % self.sensor.detector.columns)

    def _earthlight(self, pixels: NDArray[np.int64]) -> tuple[Floats, Floats]:
        """Light of the Earth and uneven stray light, before smear.

        (N, P + K) on the pixels; last the others' means, with their gains. And (N, K) the others'
        sums, without.
        """
        out = np.zeros((len(pixels), pixels.shape[1] + self._means))
        beyond = np.zeros((len(pixels), self._means))
        detector, gain = self.sensor.detector, self.pattern["gain"]
        spilling = replace(detector.errors, smear=0.0)
        for n, mine in enumerate(pixels):
            frame = np.zeros((1, detector.rows, detector.columns))
            if not self.sensor.add_uneven(frame, self.scene.part(n, n + 1)):
                continue
            frame = spilling.gathered(frame)
            listed = mine >= 0
            out[n, : -self._means][listed] = frame.ravel()[mine[listed]]
            others = np.ones(frame.size, dtype=np.bool_)
            others[mine[listed]] = False
            count = np.maximum(self._sums(np.ones(frame.size), others), 1.0)
            beyond[n] = self._sums(frame.ravel(), others)
            frame[0] *= gain
            out[n, -self._means :] = self._sums(frame.ravel(), others) / count
        return out, beyond

    def _rendered(self, sun: Floats) -> Floats:
        """(N, P) light of mean sunlight on the pixels."""
        detector = self.sensor.detector
        mask = digest_of(self.pattern["apertures"], self.pattern["transmission"], self._pixels)
        place = detector.rows, detector.columns, detector.pitch_mm
        moment = self.sensor.moment(self.scene.seen_from(sun))
        key = (*self.sensor.optics(), mask, place, detector.errors.crosstalk, *moment)
        return memory.rendered(key, lambda: self._from(sun))

    def _from(self, sun: Floats) -> Floats:
        detector = self.sensor.detector
        frame = np.zeros((detector.rows, detector.columns))
        out = np.zeros(self._pixels.shape)
        for n, pixels in enumerate(self._pixels):
            one = self.scene.part(n, n + 1).alone().seen_from(sun[n : n + 1])
            boxes = self.sensor.add_light(frame, one, self.pattern)
            listed = pixels >= 0
            out[n, listed] = self._picked(frame, pixels[listed])
            for left, right, top, bottom in boxes:
                frame[top:bottom, left:right] = 0.0
        return out

    def _picked(self, frame: Floats, pixels: NDArray[np.int64]) -> Floats:
        """(P,) light of some pixels of a frame, after crosstalk."""
        flat, share = frame.ravel(), self.sensor.detector.errors.crosstalk
        if not share:
            return np.asarray(flat[pixels])
        rows, columns = frame.shape
        y, x = np.divmod(pixels, columns)
        around = flat[np.maximum(y - 1, 0) * columns + x]
        around += flat[np.minimum(y + 1, rows - 1) * columns + x]
        around += flat[y * columns + np.maximum(x - 1, 0)]
        around += flat[y * columns + np.minimum(x + 1, columns - 1)]
        return np.asarray((1.0 - share) * flat[pixels] + share / 4.0 * around)

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, P + K) mean digital numbers before rounding; 0 where a row has no such pixel."""
        detector = self.sensor.detector
        same = np.array_equal(scene.sun, self.scene.sun)
        light = self._light if same else self._rendered(scene.sun)
        count, gain, dark = self._rest
        numbers = np.empty((len(scene), light.shape[1] + self._means))
        near, rest = numbers[:, : -self._means], numbers[:, -self._means :]
        np.multiply(light, scene.irradiance[:, None], out=near)
        near += scene.stray[:, None]
        near += self._earth[:, : -self._means]
        smeared = self._smear(near, scene)
        near *= self._gain
        near += self._dark
        rest[:] = scene.stray[:, None] * detector.sunlit_e * gain + dark
        rest += detector.sunlit_e * self._earth[:, -self._means :]
        if smeared is not None:
            rest += smeared * detector.sunlit_e * gain
        np.minimum(numbers, detector.full_well_e, out=numbers)
        numbers = detector.errors.read(numbers, detector.full_well_e)
        near, rest = numbers[:, : -self._means], numbers[:, -self._means :]
        if "column_e" in pattern:
            near += pattern["column_e"][self._columns_of(self._pixels)]
            rest += pattern["column_e"]
        numbers /= detector.gain_e_per_dn
        numbers += detector.offset_dn
        near[self._nowhere] = 0.0
        rest[count == 0] = 0.0
        return numbers

    def _smear(self, near: Floats, scene: Scene) -> Floats | None:
        """(N, K) light that every pixel of a column gets of all of it, added to `near` (N, P)."""
        errors = self.sensor.detector.errors
        if not errors.smear:
            return None
        light = np.where(self._nowhere, 0.0, near)
        columns = self._columns_of(self._pixels)
        first = np.arange(len(light))[:, None] * self._means
        total = np.bincount(
            (columns + first).ravel(), light.ravel(), minlength=len(light) * self._means
        ).reshape(len(light), -1)
        total = errors.smear * (total + self._beyond + scene.stray[:, None] * self._rest[0])
        near += np.take_along_axis(total, columns, axis=1)
        return np.asarray(total)

    def variance(self, expected: Floats) -> Floats:
        """Squared digital numbers; 1 where a row has no such pixel."""
        return self._of_mean(self.sensor.variance(expected))

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:
        """Squared digital numbers that the unknown unit adds; 1 where a row has no such pixel."""
        return self._of_mean(self.sensor.unit_variance(expected, scene, references))

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
        near = np.where(self._nowhere, detector.columns, self._columns_of(self._pixels))
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
