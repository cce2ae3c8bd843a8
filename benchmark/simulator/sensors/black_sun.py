"""A CMOS pixel array that inverts where the Sun's image is too bright: `BlackSunSensor`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.readout.noise import NoiseStreams, draw_counts
from benchmark.simulator.readout.quantisation import charge_variance
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.lens_camera import LensCamera


@dataclass(frozen=True)
class BlackSunSensor:
    """A lens camera with correlated double sampling that light can fool (fe:bscm, Saleem2019).

    A pixel puts out the difference of two samples: the signal, which saturates at the full well,
    and the reset level before it. Light collected between the release of the reset and its sample
    lowers that level too. Up to `reset_threshold_e` electrons nothing comes of it; all that is
    more is missing from the difference, so that the brightest pixels read low: a dark Sun within
    a saturated halo.

    Attributes
    ----------
    camera
        Lens and pixels.
    reset_s
        From the release of the reset to the sample of its level.
    reset_threshold_e
        Electrons that the reset level takes without a change.
    """

    camera: LensCamera
    reset_s: float
    reset_threshold_e: float

    def __post_init__(self) -> None:
        exposure = self.camera.detector.exposure_s
        if not 0 < self.reset_s <= exposure:
            raise ValueError(f"reset_s must be in (0, {exposure}]; got {self.reset_s}")
        if self.reset_threshold_e * exposure < self.camera.detector.full_well_e * self.reset_s:
            raise ValueError(
                "a pixel must saturate before its reset level moves: reset_threshold_e must be at "
                f"least {self.camera.detector.full_well_e * self.reset_s / exposure:g}; got "
                f"{self.reset_threshold_e:g}"
            )

    @property
    def white_e(self) -> float:
        """Electrons from which on a pixel reads white: full well or top of the converter."""
        detector = self.camera.detector
        top = (detector.full_scale_dn - detector.offset_dn) * detector.gain_e_per_dn
        return min(detector.full_well_e, top)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain``, ``dark_e`` and ``alive`` of the pixels."""
        return self.camera.fixed_pattern(*names)

    def origins(self, sun: Floats, generator: np.random.Generator) -> NDArray[np.int64]:  # noqa: ARG002 - the protocol's
        """(N, 2) zeros: frames are whole."""
        return np.zeros((len(sun), 2), dtype=np.int64)

    def difference(self, signal_e: Floats, reset_e: Floats) -> Floats:
        """Electrons put out for those collected until the signal and until the reset sample."""
        lost = np.maximum(reset_e - self.reset_threshold_e, 0.0)
        held = np.minimum(signal_e, self.camera.detector.full_well_e)
        return np.asarray(np.maximum(held - lost, 0.0))

    def picture(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, H, W) digital numbers of the mean electrons: no noise, no rounding, clear sky."""
        light = self.camera.photo_electrons(scene, pattern)
        share = self.reset_s / self.camera.detector.exposure_s
        electrons = self.difference(light + pattern["dark_e"], light * share) * pattern["alive"]
        detector = self.camera.detector
        return np.minimum(
            detector.offset_dn + electrons / detector.gain_e_per_dn, detector.full_scale_dn
        )

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, H, W) what each pixel tells of the light, unfolded, electrons.

        The signal up to white, then what the reset level loses beyond the loss that white hides,
        up to black. The picture is a function of it plus noise; it grows with the light all the
        way, so that a dark pixel of the black Sun is not mistaken for one far from the Sun.
        Saturated pixels, white or black, do not change with the light and tell nothing.
        """
        detector, white = self.camera.detector, self.white_e
        light = self.camera.photo_electrons(scene, pattern)
        lost = light * (self.reset_s / detector.exposure_s)
        lost -= self.reset_threshold_e + detector.full_well_e - white
        np.clip(lost, 0.0, white, out=lost)
        light += pattern["dark_e"]
        np.minimum(light, white, out=light)
        light += lost
        light *= pattern["alive"]
        return light

    def variance(self, expected: Floats) -> Floats:
        """Squared electrons: shot noise of the sample that varies, read noise, cost of rounding."""
        detector, white = self.camera.detector, self.white_e
        hidden = self.reset_threshold_e + detector.full_well_e - white
        shot = np.where(expected <= white, expected, expected - white + hidden)
        # folded back: beyond white the reading falls again
        return charge_variance(detector, white - np.abs(expected - white), shot)

    def observe(
        self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams
    ) -> NDArray[np.uint16]:
        """(N, H, W) uint16 digital numbers, black Sun and all."""
        detector = self.camera.detector
        shape = (detector.rows, detector.columns)
        out = np.empty((len(scene), *shape), dtype=np.uint16)
        share = self.reset_s / detector.exposure_s
        for n in range(len(scene)):  # one by one: a sample's randomness is drawn in one run
            one = scene.part(n, n + 1)
            light = self.camera.photo_electrons(one, pattern)[0]
            light += self.camera.cloud_electrons(one.sun, pattern, streams.gaussian)
            signal = draw_counts(light + pattern["dark_e"], 0.0, streams)
            # a Gaussian even of few electrons: below the threshold, of thousands, nothing matters
            reset = light * share
            reset += np.sqrt(reset) * streams.gaussian.standard_normal(shape, dtype=np.float32)
            electrons = self.difference(signal, reset) * pattern["alive"]
            electrons += detector.read_noise_e * streams.gaussian.standard_normal(
                shape, dtype=np.float32
            )
            numbers = np.rint(detector.offset_dn + electrons / detector.gain_e_per_dn)
            out[n] = np.clip(numbers, 0, detector.full_scale_dn)
        return out
