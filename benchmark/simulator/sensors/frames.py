"""Frames of a pixel array behind a mask: `FrameSensor`."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.memory import memory
from benchmark.simulator.optics.earthlight import EarthInView, add_between, on_window
from benchmark.simulator.optics.ghosts import Ghost, add_ghost
from benchmark.simulator.optics.projection import Camera, ProjectedLight
from benchmark.simulator.readout.column_noise import CommonNoise, window_noise
from benchmark.simulator.readout.detectors import PixelArray, tunnel_response
from benchmark.simulator.readout.noise import NoiseStreams, draw_counts
from benchmark.simulator.readout.pixels import PixelSensor
from benchmark.simulator.readout.references import (
    References,
)
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern


@dataclass(frozen=True)
class FrameSensor(PixelSensor):
    """A pixel array read out in windows around the expected spot.

    Attributes
    ----------
    camera, detector
        Light and pixels.
    window_px
        Columns and rows read out.
    window_jitter_px
        The window's middle misses the true spot by up to this many whole pixels an axis, as if
        placed from a previous frame; uniform, so the origin alone tells the spot no better than
        ``(2 j + 1) / sqrt(12)`` px.
    ghost
        Light reflected between detector and mask, or None.
    """

    camera: Camera
    detector: PixelArray
    window_px: tuple[int, int] = (64, 64)
    window_jitter_px: int = 8
    ghost: Ghost | None = field(default=None, kw_only=True)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` and ``dark_e``, (rows, columns): the pixels' relative gain and dark signal.

        With ``column_e`` (columns,) where the columns' amplifiers have offsets.
        """
        return self.detector.built((self.detector.rows, self.detector.columns), *names)

    def spot_px(self, sun: Floats) -> Floats:
        """(N, 2) true detector coordinate of the spot of a point Sun and a thin mask."""
        return self.camera.spot_mm(sun) / self.detector.pitch_mm + self.detector.centre_px

    def origins(self, sun: Floats, generator: np.random.Generator) -> NDArray[np.int64]:
        """(N, 2) window origins: the rounded spot plus a uniform whole offset an axis.

        A window that would leave the detector stops at its edge.
        """
        jitter = self.window_jitter_px
        offset = generator.integers(-jitter, jitter + 1, size=(len(sun), 2))
        half = np.array([size // 2 for size in self.window_px])
        last = np.array([self.detector.columns, self.detector.rows]) - self.window_px
        wanted = np.rint(self.spot_px(sun)).astype(np.int64) + offset - half
        return np.asarray(np.clip(wanted, 0, last), dtype=np.int64)

    def project(self, scene: Scene) -> ProjectedLight:
        """Where the mask's rims fall, and with how much light, before sunlight's own variation."""
        return self.camera.project(scene.sun)

    def lit(self, scene: Scene) -> Floats:
        """(N, H, W) irradiance averaged over each pixel, in units of mean normal sunlight.

        This is the rendering itself: no fixed pattern, no noise, no stray light.

        Raises
        ------
        ValueError
            When the scene has no window origins.
        """
        if scene.origin_px is None:
            raise ValueError("frames need the windows' origins; the scene's origin_px is None")
        seen = scene.sun.tobytes(), scene.origin_px.tobytes()
        key = (*self._optics(), *self._moment(scene), *seen)
        flux = memory.render(key, lambda: self._render(scene, np.asarray(scene.origin_px)))
        flux *= self._dim(scene)[:, None, None]
        return flux

    def _dim(self, scene: Scene) -> Floats:
        """(N,) sunlight that pixels respond to, askew as it comes."""
        if not self.detector.tunnel:
            return scene.irradiance
        cosine = self.camera.assembly.to_head(scene.sun)[:, 2]
        return scene.irradiance * tunnel_response(cosine, self.detector.tunnel)

    def _optics(self) -> tuple[Hashable, ...]:
        """Everything `_render` depends on but its arguments."""
        detector = self.detector
        size = detector.rows, detector.columns, detector.pitch_mm
        return type(self).__name__, self.camera, self.window_px, size

    def _moment(self, scene: Scene) -> tuple[Hashable, ...]:  # noqa: ARG002 - for sensors that drift
        """Everything of a scene `_render` depends on but its Suns and windows."""
        return ()

    def _render(self, scene: Scene, origin_px: NDArray[np.int64]) -> Floats:
        """(N, H, W) light of the mean sunlight in windows at (N, 2)."""
        from benchmark.simulator.kernels.rasteriser import render  # noqa: PLC0415 - Numba on demand

        pitch = self.detector.pitch_mm
        light = self.project(scene)
        columns, rows = self.window_px
        flux = np.empty((len(scene), rows, columns))
        render(
            flux,
            self.camera.mask.table(pitch),
            light.rims_mm / pitch,
            light.light,
            origin_px - 0.5 - np.asarray(self.detector.centre_px),
        )
        return flux

    def earth_through(
        self,
        earth: Earth,
        nadir: Floats,
        scene: Scene,
        pattern: FixedPattern,  # noqa: ARG002 - the protocol's
    ) -> Floats:
        """(N, R, C) irradiance from the Earth at points over each window, for nadir (N, 3).

        The first is the first pixel, the last the last one; frames get what lies between.
        """
        detector = self.detector
        origin = np.zeros((len(scene), 2)) if scene.origin_px is None else scene.origin_px
        first = (origin - np.asarray(detector.centre_px)) * detector.pitch_mm
        columns, rows = ((size - 1) * detector.pitch_mm for size in self.window_px)
        return on_window(self.camera, first, (columns, rows), EarthInView(earth, nadir, scene.sun))

    def _electrons(self, scene: Scene, pattern: FixedPattern) -> Floats:
        electrons = self.lit(scene)
        if self.ghost is not None:
            middle = np.asarray(self.detector.centre_px)
            corner = np.asarray(scene.origin_px) - 0.5 - middle
            moved = replace(scene, origin_px=corner, irradiance=self._dim(scene))
            add_ghost(electrons, self.camera, self.ghost, moved, self.detector.pitch_mm)
        if scene.albedo is not None:
            add_between(electrons, scene.albedo)
        electrons += scene.stray[:, None, None]
        electrons = self.detector.errors.gather(electrons)
        electrons *= self.detector.sunlit_e
        columns, rows = self.window_px
        for n, (x, y) in enumerate(np.asarray(scene.origin_px)):
            if not (
                0 <= x <= self.detector.columns - columns and 0 <= y <= self.detector.rows - rows
            ):
                raise ValueError(
                    f"window of {columns} x {rows} px at ({x}, {y}) leaves the detector of "
                    f"{self.detector.columns} x {self.detector.rows} px"
                )
            window = slice(y, y + rows), slice(x, x + columns)
            electrons[n] *= pattern["gain"][window]
            electrons[n] += pattern["dark_e"][window]
        return electrons

    def _amplify(self, electrons: Floats, scene: Scene, pattern: FixedPattern) -> Floats:
        """Electrons (N, H, W) as the columns' amplifiers show them, without their noise."""
        electrons = self.detector.errors.read(electrons, self.detector.full_well_e)
        if "column_e" in pattern:
            first = np.asarray(scene.origin_px)[:, :1]
            electrons += pattern["column_e"][first + np.arange(self.window_px[0])][:, None, :]
        return electrons

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, H, W) mean digital numbers before rounding."""
        detector = self.detector
        numbers = self._electrons(scene, pattern)
        np.minimum(numbers, detector.full_well_e, out=numbers)
        numbers = self._amplify(numbers, scene, pattern)
        numbers /= detector.gain_e_per_dn
        numbers += detector.offset_dn
        return numbers

    def common_noise(
        self, shape: tuple[int, ...], references: References | None
    ) -> CommonNoise | None:
        """Digital numbers that the pixels of a column share."""
        return window_noise(self.detector, shape, references)

    def observe(
        self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams
    ) -> NDArray[np.uint16]:
        """(N, H, W) uint16 digital numbers."""
        detector = self.detector
        electrons = draw_counts(self._electrons(scene, pattern), detector.read_noise_e, streams)
        np.minimum(electrons, detector.full_well_e, out=electrons)
        electrons = self._amplify(electrons, scene, pattern)
        if detector.errors.column_noise_e:
            size = len(electrons), 1, self.window_px[0]
            electrons += streams.column_noise(detector.errors.column_noise_e, size)
        electrons /= detector.gain_e_per_dn
        electrons += detector.offset_dn
        np.rint(electrons, out=electrons)
        return np.clip(electrons, 0, detector.full_scale_dn, out=electrons).astype(np.uint16)
