"""Reference pictures of the Sun through a lens: a CCD that blooms, a CMOS array that inverts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from algorithms.contract import Floats, Observation, SensorGeometry
from benchmark.seeds import generator
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.black_sun import BlackSunSensor
from benchmark.simulator.sensors.blooming import BloomingSensor
from benchmark.simulator.sensors.lens_camera import LensCamera
from benchmark.synthetic_features.light import position_bound
from benchmark.synthetic_features.series import (
    SNRS,
    Sample,
    SeriesPoint,
    locations,
    missing_features,
    number,
    phases,
)

_BOUND_SAMPLES = 3

Camera = BloomingSensor | BlackSunSensor


@dataclass(frozen=True)
class CameraSeries:
    """A camera that is handed in, without its distortion and misalignment.

    The SNR is that of a pixel at the full well: the read noise is what is left of the full well
    over it.

    Attributes
    ----------
    camera, design
        The camera, and what its builder knows of it.
    """

    name: str
    camera: Camera
    design: SensorGeometry
    description: str
    observation: Observation = Observation.FRAMES
    unit: str = "px"
    frames: int = 24

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point; the noise sweep ends where the light's own noise is all there is."""
        base = SeriesPoint("reference", self.name, None, self.frames, range_px=40.0)
        snrs = (snr for snr in SNRS if snr <= self._highest_snr())
        return (
            base,
            *(number("noise", snr, base, snr=snr) for snr in snrs),
            *phases(base)[::2],
            *locations(base, anywhere_px=100.0),
            *missing_features(base),
        )

    def _sensor(self) -> Camera:
        optics = self.camera.camera
        straight = replace(optics.lens, k1=0.0, k2=0.0)
        return replace(self.camera, camera=replace(optics, lens=straight, assembly=Assembly()))

    def _highest_snr(self) -> float:
        return float(self._sensor().camera.detector.full_well_e ** 0.5)

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:  # noqa: ARG002 - the protocol's
        """Return the design of the camera, without distortion."""
        return replace(self.design, lens_distortion=(0.0, 0.0))

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return pictures, where the Sun's centre falls (N, 2) and its bound."""
        sensor = self._sensor()
        camera: LensCamera = sensor.camera
        well = camera.detector.full_well_e
        noise_e = max((well / setting.snr) ** 2 - well, 1.0) ** 0.5
        # the converter's offset holds the noise, so that it is not clipped
        offset = camera.detector.offset_dn + 4.0 * noise_e / camera.detector.gain_e_per_dn
        bits = 16
        detector = replace(
            camera.detector, read_noise_e=noise_e, offset_dn=float(round(offset)), bits=bits
        )
        share = setting.missing or camera.dead_share
        camera = replace(camera, detector=detector, dead_share=share)
        sensor = replace(sensor, camera=camera)
        pattern = sensor.fixed_pattern("sweep", self.name)
        places = np.asarray(camera.axis_px) + setting.places(self.name)
        if setting.phase_px is not None:
            places = np.floor(camera.axis_px) + setting.places(self.name)

        def scene(at: Floats) -> Scene:
            count = len(at)
            return Scene(camera.sun_of(at), np.ones(count), np.full(count, 2e-4))

        def mean(at: Floats) -> Floats:
            return sensor.expected(scene(at), pattern)

        few = places[:_BOUND_SAMPLES]
        bound = position_bound(
            mean,
            few,
            lambda here: [
                sensor.expected(replace(scene(few), irradiance=np.full(len(few), 1.02)), pattern)
                - here
            ],
            sensor.variance,
            5e-2,
        )
        stream = NoiseStreams(
            setting.noise(self.name),
            generator("sweep", self.name, setting.sweep, setting.point, "counts"),
        )
        return Sample(sensor.observe(scene(places), pattern, stream), places, bound)

    def estimates(self, features: Floats) -> Floats:
        """Return the positions themselves."""
        return features
