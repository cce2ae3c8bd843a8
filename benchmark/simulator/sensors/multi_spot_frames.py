"""Full frames of a large pixel array behind a mask of many apertures: `MultiSpotSensor`."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, partial
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.memory import Runs, digest_of, memory
from benchmark.simulator.light.stray_slope import slope_nodes
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.earthlight import add_between
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.optics.round_spots import RoundSpots
from benchmark.simulator.readout.column_noise import CommonNoise, window_noise
from benchmark.simulator.readout.detectors import PixelArray, tunnel_response
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.pixels import PixelSensor
from benchmark.simulator.readout.references import (
    References,
)
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.frames import FrameSensor

Integers = NDArray[np.int64]

#: Below this read noise the Gaussian shot noise of dim pixels is not good enough.
LEAST_READ_NOISE_E = 10.0


class Rendering(Protocol):
    """The light of some samples under mean sunlight, one sample at a time."""

    def add(self, frame: Floats, n: int) -> Integers:
        """Add sample n's to a frame; (B, 4) boxes outside of which nothing was added."""

    def mark(self, near: NDArray[np.bool_], n: int, margin_px: int) -> None:
        """Mark the pixels that sample n's lights, and so many around them."""


@dataclass(frozen=True)
class MultiSpotSensor(PixelSensor):
    """A pixel array read out whole; light is rendered where it falls, aperture by aperture.

    Light is diffracted at every hole (`RoundSpots`); without a spectrum it casts shadows.

    Shot noise is drawn as a Gaussian of variance equal to the mean in every pixel. With read
    noise of r electrons the sum's skewness is ``m / (m + r^2)^(3/2)``, at most ``0.385 / r`` at
    any mean m: less than 0.04 from `LEAST_READ_NOISE_E` on, and less is refused.

    Attributes
    ----------
    camera, detector
        Light and pixels. The camera's mask may be larger than the detector.
    errors
        Of the mask's manufacture.
    spectrum
        Wavelengths and weights; None: geometric shadows, of any aperture.
    widest_deg
        Largest incidence for which diffraction is tabulated; beyond, a spot keeps this one's
        Fresnel numbers.
    skirt
        Of diffracted spots: where light has fallen to this share of the peak at normal incidence,
        it is left out.
    ghost
        Light reflected between detector and mask, or None: the spots of the same mask from three
        times its height, each dimmer by what its light finds of openings on the way.
    """

    camera: Camera
    detector: PixelArray
    errors: MaskErrors = field(default_factory=MaskErrors)
    spectrum: Spectrum | None = SUNLIT_SILICON
    widest_deg: float = 70.0
    skirt: float = 1e-4
    sees_slopes: ClassVar[bool] = True

    def __post_init__(self) -> None:
        shapes = {aperture.shape for aperture in self.camera.mask.apertures}
        if self.spectrum is not None and shapes != {"round"}:
            raise ValueError(
                "diffracted full frames are of round holes; got a mask with rectangles "
                "(spectrum=None casts shadows)"
            )
        if not 0 < self.widest_deg < 90:
            raise ValueError(f"widest_deg must be in (0, 90); got {self.widest_deg}")
        if not 0 < self.skirt < 1:
            raise ValueError(f"skirt must be in (0, 1); got {self.skirt}")
        if self.detector.read_noise_e < LEAST_READ_NOISE_E:
            raise ValueError(
                f"full frames need a read noise of at least {LEAST_READ_NOISE_E} electrons; got "
                f"{self.detector.read_noise_e}"
            )

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain``, ``dark_e`` (rows, columns), and the built mask.

        ``apertures`` (A, 7) is `Mask.table` in pixels, ``transmission`` (A,) what they pass.
        """
        table, transmission = self.errors.built(self.camera.mask, *names)
        table[:, 1:5] /= self.detector.pitch_mm
        pixels = self._whole().fixed_pattern(*names)
        return {**pixels, "apertures": table, "transmission": transmission}

    def _whole(self) -> FrameSensor:
        size = (self.detector.columns, self.detector.rows)
        return FrameSensor(self.camera, self.detector, size, 0)

    def origins(self, sun: Floats, generator: np.random.Generator) -> Integers:  # noqa: ARG002 - the protocol's
        """(N, 2) zeros: frames are whole."""
        return np.zeros((len(sun), 2), dtype=np.int64)

    def boxes(self, scene: Scene, pattern: FixedPattern, margin_px: int = 0) -> Integers:
        """(N, A, 4) first and past-last column and row each aperture lights, on the detector.

        Empty (past-last not above first) where its light misses the detector or it is closed.
        """
        if self.spectrum is not None:
            boxes = self._spots.boxes(scene.sun, self._holes(pattern), margin_px)
            boxes[:, pattern["transmission"] == 0.0] = 0
            return boxes
        light = self.camera.project(scene.sun)
        return self._boxes(light.rims_mm / self.detector.pitch_mm, pattern, margin_px)

    @cached_property
    def _spots(self) -> RoundSpots:
        if self.spectrum is None:
            raise TypeError("a sensor without a spectrum has no diffracted spots")
        return RoundSpots(
            camera=self.camera,
            spectrum=self.spectrum,
            pitch_mm=self.detector.pitch_mm,
            size_px=(self.detector.columns, self.detector.rows),
            widest_deg=self.widest_deg,
            size_mm=self.errors.radius_mm,
            skirt=self.skirt,
        )

    def _holes(self, pattern: FixedPattern) -> Floats:
        """Return (A, 3) built holes: x and y from the detector's first corner, and radius, mm."""
        holes = pattern["apertures"][:, 1:4] * self.detector.pitch_mm
        half = np.array([self.detector.columns, self.detector.rows]) / 2.0
        assembly = self.camera.assembly
        holes[:, :2] += half * self.detector.pitch_mm
        holes[:, :2] += np.array([assembly.offset_x_mm, assembly.offset_y_mm])
        return np.asarray(holes)

    def _boxes(self, rims: Floats, pattern: FixedPattern, margin_px: int) -> Integers:
        table = pattern["apertures"]
        box = table[:, 0] > 0.5
        c, s = np.abs(table[:, 5]), np.abs(table[:, 6])
        reach = np.stack(
            [
                np.where(box, table[:, 3] * c + table[:, 4] * s, table[:, 3]),
                np.where(box, table[:, 3] * s + table[:, 4] * c, table[:, 3]),
            ],
            axis=1,
        )
        # pixel n covers [n, n + 1) from the detector's first corner
        half = np.array([self.detector.columns, self.detector.rows]) / 2.0
        place = table[:, 1:3] + half
        low = rims.min(axis=(0, 2))[:, None] + (place - reach)[None] - margin_px
        high = rims.max(axis=(0, 2))[:, None] + (place + reach)[None] + margin_px
        size = np.array([self.detector.columns, self.detector.rows], dtype=np.float64)
        first = np.clip(np.floor(low), 0.0, size).astype(np.int64)
        last = np.clip(np.ceil(high), 0.0, size).astype(np.int64)
        last[:, pattern["transmission"] == 0.0] = 0
        return np.stack([first[..., 0], last[..., 0], first[..., 1], last[..., 1]], axis=-1)

    def lit(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, rows, columns) irradiance averaged over each pixel, in units of mean sunlight.

        The rendering alone: the built mask, but no pixel gains, noise or stray light.
        """
        frames = np.zeros((len(scene), self.detector.rows, self.detector.columns))
        light = self.light(scene, pattern)
        for n, frame in enumerate(frames):
            light.add(frame, n)
        return frames

    def dim(self, scene: Scene) -> Floats:
        """(N,) sunlight that pixels respond to, askew as it comes."""
        if not self.detector.tunnel:
            return scene.irradiance
        cosine = self.camera.assembly.to_head(scene.sun)[:, 2]
        return scene.irradiance * tunnel_response(cosine, self.detector.tunnel)

    def light(self, scene: Scene, pattern: FixedPattern) -> Rendering:
        """Return the light of the samples of a scene, to be added to frames one by one."""
        dimmed = self.dim(scene)
        if self.spectrum is not None:
            passed = dimmed[:, None] * pattern["transmission"]
            return self._spots.light(scene.sun, self._holes(pattern), passed)
        projected = self.camera.project(scene.sun)
        rims = np.ascontiguousarray(projected.rims_mm / self.detector.pitch_mm)
        light = projected.light * dimmed[:, None]
        return _Shadows(pattern, rims, light, self._boxes(rims, pattern, 0))

    def earth_through(
        self,
        earth: Earth,
        nadir: Floats,
        scene: Scene,
        pattern: FixedPattern,  # noqa: ARG002 - the protocol's
    ) -> Floats:
        """(N, R, C) irradiance from the Earth at points over the detector, for nadir (N, 3).

        As of `FrameSensor`, through the mask as drawn.
        """
        whole = replace(scene, origin_px=np.zeros((len(scene), 2), dtype=np.int64))
        return self._whole().earth_through(earth, nadir, whole, {})

    def place(self, pattern: FixedPattern) -> tuple[Hashable, ...]:
        """Return what light on the detector depends on besides the Sun, in brief."""
        return self._design, digest_of(pattern["apertures"], pattern["transmission"])

    @cached_property
    def _design(self) -> bytes:
        """What it depends on but the built mask: the mask is long, and spelt hole by hole."""
        detector = self.detector
        pixels = detector.rows, detector.columns, detector.pitch_mm, detector.tunnel
        # tables are of holes as far apart as built ones are expected to be
        spots = self.widest_deg, self.skirt, self.errors.radius_mm
        said = repr((type(self).__name__, self.camera, self.spectrum, spots, pixels))
        return digest_of(np.frombuffer(said.encode(), dtype=np.uint8))

    def add_uneven(self, frames: Floats, scene: Scene) -> bool:
        """Add light of the Earth and sloping stray light to frames (N, rows, columns), if any."""
        slope = slope_nodes(scene, self.detector.columns, self.detector.rows)
        found = [nodes for nodes in (scene.albedo, slope) if nodes is not None]
        for nodes in found:
            add_between(frames, nodes)
        return bool(found)

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, rows, columns) mean digital numbers before rounding."""
        detector = self.detector
        electrons = self.lit(scene, pattern)
        self.add_uneven(electrons, scene)
        electrons += scene.stray[:, None, None]
        electrons = detector.errors.gather(electrons)
        electrons *= detector.sunlit_e * pattern["gain"]
        electrons += pattern["dark_e"]
        np.minimum(electrons, detector.full_well_e, out=electrons)
        electrons = detector.errors.read(electrons, detector.full_well_e)
        if "column_e" in pattern:
            electrons += pattern["column_e"]
        return np.asarray(detector.offset_dn + electrons / detector.gain_e_per_dn)

    def common_noise(
        self, shape: tuple[int, ...], references: References | None
    ) -> CommonNoise | None:
        """Digital numbers that the pixels of a column share."""
        return window_noise(self.detector, shape, references)

    def observe(
        self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams
    ) -> NDArray[np.uint16]:
        """(N, rows, columns) uint16 digital numbers.

        Each frame takes the same number of words of the Gaussian stream, whatever it shows.
        """
        from benchmark.simulator.kernels.digitising import (  # noqa: PLC0415 - Numba
            digitise,
            gather,
            quantiles,
        )
        from benchmark.simulator.kernels.rasteriser import put_light  # noqa: PLC0415 - Numba

        detector, errors = self.detector, self.detector.errors
        shape = (detector.rows, detector.columns)
        out = np.empty((len(scene), *shape), dtype=np.uint16)
        light = np.zeros(shape)
        numbers = (
            detector.sunlit_e,
            detector.read_noise_e**2,
            detector.full_well_e,
            detector.gain_e_per_dn,
            detector.offset_dn,
            float(detector.full_scale_dn),
            errors.nonlinearity / detector.full_well_e,
        )
        tables = (quantiles(), pattern["gain"], pattern["dark_e"])
        columns = pattern.get("column_e", np.zeros(shape[1] if errors.of_amplifiers else 0))
        gathered = np.empty(shape) if errors.moves_charge else None
        words = (shape[0] * shape[1] + 1) // 2
        flat = light.reshape(-1)
        key = self.place(pattern)
        # made only where some light is not known yet
        rendering = cache(partial(self.light, scene.alone(), pattern))
        for n in range(len(scene)):
            runs, values = memory.runs(
                (*key, scene.sun[n].tobytes()), partial(_runs, light, rendering, n)
            )
            put_light(flat, runs, values, float(scene.irradiance[n]))
            uneven = self.add_uneven(light[None], scene.part(n, n + 1))
            seen, stray = light, float(scene.stray[n])
            if gathered is not None:
                gather(gathered, light, (stray, errors.crosstalk, errors.smear))
                seen, stray = gathered, 0.0
            added = columns
            if errors.column_noise_e:
                added = columns + streams.column_noise(errors.column_noise_e, shape[1:])
            digitise(
                out[n],
                seen,
                streams.gaussian.bit_generator.random_raw(words).view(np.uint32),
                (*tables, added),
                (stray, *numbers),
            )
            if uneven:
                flat[:] = 0.0
            else:
                put_light(flat, runs, values, 0.0)
        return out


@dataclass(frozen=True, eq=False)
class _Shadows:
    """Shadows of a mask: `Rendering` without diffraction."""

    pattern: FixedPattern
    rims: Floats
    light: Floats
    boxes: Integers

    def add(self, frame: Floats, n: int) -> Integers:
        from benchmark.simulator.kernels.rasteriser import add_apertures  # noqa: PLC0415 - Numba on demand

        light, boxes = self.light[n : n + 1], self.boxes[n]
        if not light.any():
            return np.zeros((0, 4), dtype=np.int64)
        table = self.pattern["apertures"], self.pattern["transmission"]
        add_apertures(frame, table, np.ascontiguousarray(self.rims[:, n : n + 1]), light, boxes)
        lit = (boxes[:, 1] > boxes[:, 0]) & (boxes[:, 3] > boxes[:, 2])
        return np.asarray(boxes[lit])

    def mark(self, near: NDArray[np.bool_], n: int, margin_px: int) -> None:
        from benchmark.simulator.sensors.lit_pixels_kernel import mark_boxes  # noqa: PLC0415 - Numba on demand

        mark_boxes(near, self.boxes[n], margin_px)


def _runs(frame: Floats, rendering: Callable[[], Rendering], n: int) -> Runs:
    """Light of one sample, rendered in a dark frame that is dark again afterwards."""
    from benchmark.simulator.kernels.rasteriser import take_light  # noqa: PLC0415 - Numba on demand

    boxes = rendering().add(frame, n)
    room = int(((boxes[:, 1] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 2])).sum())
    room = min(room, frame.size)
    runs, values = np.empty((room, 2), dtype=np.int32), np.empty(room, dtype=np.float32)
    found, count = take_light(frame, boxes, runs, values)
    return runs[:found].copy(), values[:count].copy()
