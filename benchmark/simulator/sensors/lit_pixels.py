"""The pixels of full frames that tell the Sun's direction: `LitPixels`, for bounds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.memory import digest_of, memory
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
    light is kept. Elements: (N, P + 1), rows with fewer pixels filled up with zeros.
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
    _light: Floats = field(init=False)

    def __post_init__(self) -> None:
        detector = self.sensor.detector
        boxes = self.sensor.boxes(self.scene, self.pattern, MARGIN_PX)
        gain, dark = self.pattern["gain"].ravel(), self.pattern["dark_e"].ravel()
        chosen, rest = [], np.zeros((len(self.scene), 3))
        for n, mine in enumerate(boxes):
            near = np.zeros((detector.rows, detector.columns), dtype=np.bool_)
            for left, right, top, bottom in mine:
                near[top:bottom, left:right] = True
            chosen.append(np.flatnonzero(near))
            far = ~near.ravel()
            count = int(far.sum())
            if count:
                rest[n] = count, gain[far].sum() / count, dark[far].sum() / count
        pixels = np.full((len(chosen), max((len(c) for c in chosen), default=0)), -1)
        for row, mine in zip(pixels, chosen, strict=True):
            row[: len(mine)] = mine
        object.__setattr__(self, "_pixels", pixels)
        object.__setattr__(self, "_nowhere", pixels < 0)
        object.__setattr__(self, "_gain", detector.sunlit_e * gain[pixels])
        object.__setattr__(self, "_dark", dark[pixels])
        object.__setattr__(self, "_rest", rest)
        object.__setattr__(self, "_earth", self._earthlight(pixels))
        object.__setattr__(self, "_light", self._rendered(self.scene.sun))

    def _earthlight(self, pixels: NDArray[np.int64]) -> Floats:
        """(N, P + 1) light of the Earth and uneven stray light on the pixels.

        Last the others' mean, with their gains.
        """
        out = np.zeros((len(pixels), pixels.shape[1] + 1))
        detector, gain = self.sensor.detector, self.pattern["gain"]
        for n, mine in enumerate(pixels):
            frame = np.zeros((1, detector.rows, detector.columns))
            if not self.sensor.add_uneven(frame, self.scene.part(n, n + 1)):
                continue
            listed = mine >= 0
            out[n, :-1][listed] = frame.ravel()[mine[listed]]
            frame[0] *= gain
            others = np.ones(frame.size, dtype=np.bool_)
            others[mine[listed]] = False
            out[n, -1] = frame.ravel()[others].sum() / max(int(others.sum()), 1)
        return out

    def _rendered(self, sun: Floats) -> Floats:
        """(N, P) light of mean sunlight on the pixels."""
        detector = self.sensor.detector
        mask = digest_of(self.pattern["apertures"], self.pattern["transmission"], self._pixels)
        place = detector.rows, detector.columns, detector.pitch_mm
        key = (*self.sensor.optics(), mask, place, sun.tobytes())
        return memory.rendered(key, lambda: self._from(sun))

    def _from(self, sun: Floats) -> Floats:
        detector = self.sensor.detector
        frame = np.zeros((detector.rows, detector.columns))
        out = np.zeros(self._pixels.shape)
        for n, pixels in enumerate(self._pixels):
            one = Scene(sun[n : n + 1], np.ones(1), np.zeros(1))
            boxes = self.sensor.add_light(frame, one, self.pattern)
            listed = pixels >= 0
            out[n, listed] = frame.ravel()[pixels[listed]]
            for left, right, top, bottom in boxes:
                frame[top:bottom, left:right] = 0.0
        return out

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:  # noqa: ARG002 - the one it has
        """(N, P + 1) mean digital numbers before rounding; 0 where a row has no such pixel."""
        detector = self.sensor.detector
        same = np.array_equal(scene.sun, self.scene.sun)
        light = self._light if same else self._rendered(scene.sun)
        numbers = np.empty((len(scene), light.shape[1] + 1))
        near = numbers[:, :-1]
        np.multiply(light, scene.irradiance[:, None], out=near)
        near += scene.stray[:, None]
        near += self._earth[:, :-1]
        near *= self._gain
        near += self._dark
        numbers[:, -1] = scene.stray * detector.sunlit_e * self._rest[:, 1] + self._rest[:, 2]
        numbers[:, -1] += detector.sunlit_e * self._earth[:, -1]
        np.minimum(numbers, detector.full_well_e, out=numbers)
        numbers /= detector.gain_e_per_dn
        numbers += detector.offset_dn
        near[self._nowhere] = 0.0
        numbers[self._rest[:, 0] == 0, -1] = 0.0
        return numbers

    def variance(self, expected: Floats) -> Floats:
        """Squared digital numbers; 1 where a row has no such pixel."""
        return self._of_mean(self.sensor.variance(expected))

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:
        """Squared digital numbers that the unknown unit adds; 1 where a row has no such pixel."""
        return self._of_mean(self.sensor.unit_variance(expected, scene, references))

    def _of_mean(self, variance: Floats) -> Floats:
        """Make pixels' variances those of the elements: the last one is a mean."""
        variance[:, :-1][self._nowhere] = 1.0
        count = self._rest[:, 0]
        variance[:, -1] = np.where(count > 0, variance[:, -1] / np.maximum(count, 1.0), 1.0)
        return np.asarray(variance)

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
