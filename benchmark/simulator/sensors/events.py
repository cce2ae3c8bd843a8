"""Pixels that tell when they have gathered enough light: `SpikingArray`, `EventSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.memory import memory
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.earthlight import EarthInView, add_between, on_window
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.diffracted_light import DiffractedLight, Stance, few_points

#: Electrons a microsecond below which no pixel is taken to be: without light and dark current it
#: never fires, but its time stays a number.
_LEAST_RATE = 1e-9


@dataclass(frozen=True)
class SpikingArray:
    """Integrate-and-fire pixels in time-to-first-spike mode (fe:escm, Farian2022).

    After a common reset every pixel integrates its photocurrent; it fires once, when its charge
    reaches its threshold, so that the time is inversely proportional to the current. One bus
    serves all pixels, one event after another in the order in which they ask for it (`departures`);
    an event is stamped when it has left. After the first `events` of them, or after `timeout_us`,
    the array is reset, whatever still waits.

    Attributes
    ----------
    columns, rows, pitch_mm
        Square pixels, fully sensitive.
    sunlit_us
        Time to fire of a fully lit pixel in mean sunlight at normal incidence.
    threshold_e
        Mean threshold in electrons: its shot noise is part of the jitter.
    threshold_mismatch, prnu
        Standard deviation over pixels of the relative threshold and of the relative response.
    dark
        Electrons per second a pixel.
    jitter
        Relative standard deviation of a time by the comparator's noise, over its slope.
    clock_us, latency_us
        Step of the time stamps, and standard deviation of the delay of a pixel's request.
    events, timeout_us
        When the array is reset.
    service_us
        That one event keeps the bus busy.
    """

    columns: int
    rows: int
    pitch_mm: float
    sunlit_us: float
    threshold_e: float
    threshold_mismatch: float
    prnu: float
    dark: DarkCurrent
    jitter: float
    clock_us: float
    latency_us: float
    events: int
    timeout_us: float
    service_us: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.service_us) and self.service_us >= 0):
            raise ValueError(f"service_us must be finite and not negative; got {self.service_us}")
        if not 1 <= self.events <= self.columns * self.rows:
            raise ValueError(
                f"events must be in [1, {self.columns * self.rows}], the pixels; got {self.events}"
            )

    @property
    def centre_px(self) -> tuple[float, float]:
        """Detector coordinate of the array's middle."""
        return (self.columns - 1) / 2.0, (self.rows - 1) / 2.0

    def times_us(self, light: Floats, pattern: FixedPattern) -> Floats:
        """Mean time to fire of pixels in `light` (..., H, W), units of mean normal sunlight.

        Inversely proportional to photo plus dark current, proportional to the threshold.
        """
        per_us = self.threshold_e / self.sunlit_us
        rate = per_us * np.maximum(light, 0.0) * pattern["gain"]
        rate += self.dark.level() * 1e-6
        return np.asarray(self.threshold_e * pattern["threshold"] / np.maximum(rate, _LEAST_RATE))

    def variance_us2(self, times_us: Floats) -> Floats:
        """Squared microseconds: shot noise of the charge and comparator noise, request and clock.

        Of an event that need not wait for the bus.
        """
        relative2 = 1.0 / self.threshold_e + self.jitter**2
        return np.asarray(relative2 * times_us**2 + self.latency_us**2 + self.clock_us**2 / 12.0)


@dataclass(frozen=True)
class EventSensor:
    """A spiking array behind a mask that bends light (`DiffractedLight`).

    Attributes
    ----------
    camera, detector
        Light and pixels.
    spectrum
        Wavelengths and weights.
    widest_deg
        Largest incidence tabulated; beyond, the pattern keeps this one's Fresnel numbers.
    """

    camera: Camera
    detector: SpikingArray
    spectrum: Spectrum = SUNLIT_SILICON
    widest_deg: float = 70.0

    def __post_init__(self) -> None:
        # wrong parameters are refused when the sensor is made, not when it sees something
        self._light()

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` and ``threshold``, (rows, columns): relative response and threshold."""
        detector = self.detector
        shape = (detector.rows, detector.columns)
        gain = 1.0 + detector.prnu * generator(*names, "prnu").standard_normal(shape)
        threshold = 1.0 + detector.threshold_mismatch * generator(
            *names, "threshold"
        ).standard_normal(shape)
        return {"gain": np.maximum(gain, 0.01), "threshold": np.maximum(threshold, 0.01)}

    def origins(self, sun: Floats, generator: np.random.Generator) -> None:
        """Nothing is windowed (the arguments are the protocol's)."""

    def lit(self, scene: Scene) -> Floats:
        """(N, H, W) irradiance averaged over each pixel, in units of mean normal sunlight.

        The rendering alone: no stray light, no fixed pattern.
        """
        detector = self.detector
        size = detector.rows, detector.columns, detector.pitch_mm
        optics = self.camera, size, self.spectrum, self.widest_deg
        key = type(self).__name__, *optics, scene.sun.tobytes()
        flux = memory.render(key, lambda: self._render(scene.sun))
        flux *= scene.irradiance[:, None, None]
        return flux

    def _render(self, sun: Floats) -> Floats:
        """(N, H, W) light of the mean sunlight from (N, 3)."""
        detector = self.detector
        head = self.camera.assembly.to_head(sun)
        height = np.full(len(sun), self.camera.height_mm)
        corner = (-0.5 - np.asarray(detector.centre_px)) * detector.pitch_mm
        return self._light().render(
            Stance(head, height, few_points(self.camera).project(sun)),
            np.broadcast_to(corner, (len(sun), 2)),
        )

    def _light(self) -> DiffractedLight:
        detector = self.detector
        return DiffractedLight(
            camera=self.camera,
            spectrum=self.spectrum,
            pitch_mm=detector.pitch_mm,
            size_px=(detector.columns, detector.rows),
            # a spot in one corner lights the opposite one
            reach_mm=math.sqrt(2.0) * max(detector.columns, detector.rows) * detector.pitch_mm,
            widest_deg=self.widest_deg,
        )

    def earth_through(
        self,
        earth: Earth,
        nadir: Floats,
        scene: Scene,
        pattern: FixedPattern,  # noqa: ARG002 - the protocol's
    ) -> Floats:
        """(N, R, C) irradiance from the Earth at points over the array, for nadir (N, 3).

        As of `FrameSensor`.
        """
        detector = self.detector
        first = np.tile(-np.asarray(detector.centre_px) * detector.pitch_mm, (len(scene), 1))
        reach = (detector.columns - 1) * detector.pitch_mm, (detector.rows - 1) * detector.pitch_mm
        return on_window(self.camera, first, reach, EarthInView(earth, nadir, scene.sun))

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, H W) mean time to fire of every pixel, microseconds, also of those not read out.

        The events are a function of the pixels' actual times.
        """
        light = self.lit(scene)
        if scene.albedo is not None:
            add_between(light, scene.albedo)
        light += scene.stray[:, None, None]
        return self.detector.times_us(light, pattern).reshape(len(scene), -1)

    def variance(self, expected: Floats) -> Floats:
        """Squared microseconds, what a pixel's time is worth when only the first are read.

        On a bus without load: which pixels leave it, in which order and when, all follow from
        when they ask for it, so that no estimator that sees the stamps does better than one that
        is given those times. Where pixels queue, who sees the stamps alone has to do with less.

        That a pixel has not fired when the array is reset at the time c tells something, too: a
        Gaussian time with mean m and deviation s that is only known where it is below c has the
        share ``F(z) - z f(z) + f(z)^2 / (1 - F(z))``, ``z = (c - m) / s``, of its information on
        m, f and F the normal density and distribution. The variance is that of the time over
        this share. c is taken at the time at which the mean number of spikes is `events`, or the
        timeout: right for many events, of which none matters by itself.
        """
        variance = self.detector.variance_us2(expected)
        deviation = np.sqrt(variance)
        reset = np.minimum(
            np.sort(expected, axis=1)[:, self.detector.events - 1], self.detector.timeout_us
        )
        share = _censored_share((reset[:, None] - expected) / deviation)
        # 1e-12: a pixel that will not fire in time; its share may underflow to nothing
        return np.asarray(variance / np.maximum(share, 1e-12))

    def observe(self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams) -> Floats:
        """(N, M, 3) events ``[x_px, y_px, t_us]`` by time; rows of NaN after the last one."""
        detector = self.detector
        mean = self.expected(scene, pattern)
        times = mean + np.sqrt(detector.variance_us2(mean) - detector.clock_us**2 / 12.0) * (
            streams.gaussian.standard_normal(mean.shape)
        )
        # a time before the reset cannot be; only noise far above the stated ones gets there
        np.maximum(times, detector.clock_us, out=times)
        # of those that ask at once the lower address comes first
        first = np.argsort(times, axis=1, kind="stable")[:, : detector.events]
        stamps = departures(np.take_along_axis(times, first, axis=1), detector.service_us)
        late = stamps > detector.timeout_us
        events = np.stack(
            [
                (first % detector.columns).astype(np.float64),
                (first // detector.columns).astype(np.float64),
                np.rint(stamps / detector.clock_us) * detector.clock_us,
            ],
            axis=2,
        )
        events[late] = np.nan
        return events


def departures(requests_us: Floats, service_us: float) -> Floats:
    """When events leave a bus that serves them one by one, in the order of their requests.

    ``d_k = max(r_k, d_(k-1)) + service``; solved for all at once, ``d_k`` is
    ``(k + 1) service + max(r_j - j service)`` over all j up to k.

    Parameters
    ----------
    requests_us
        (..., K) times of the requests, rising.
    service_us
        That one event keeps the bus busy; 0 returns the requests.
    """
    earlier = service_us * np.arange(requests_us.shape[-1])
    waited = np.maximum.accumulate(requests_us - earlier, axis=-1)
    return np.asarray(waited + (earlier + service_us))


def _censored_share(z: Floats) -> Floats:
    """Share (...) of the information on the mean of a normal value known only below z sigma.

    Beyond 6 standard deviations it is 1 (or 0) to 1e-7.
    """
    inside = np.abs(z) < 6.0
    share = np.where(z > 0, 1.0, 0.0)
    near = z[inside]
    density = np.array([math.exp(-0.5 * v * v) for v in near]) / math.sqrt(2.0 * math.pi)
    above = np.array([0.5 * math.erfc(v / math.sqrt(2.0)) for v in near])
    share[inside] = 1.0 - above - near * density + density**2 / above
    return share
