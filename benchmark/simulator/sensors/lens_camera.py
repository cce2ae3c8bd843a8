"""The Sun through a lens on a pixel array, before the pixels do anything to it: `LensCamera`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.memory import memory
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.flare import Clouds, Flare
from benchmark.simulator.optics.lens import Lens
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern

#: The blur is rendered this many standard deviations wide; 1e-15 of the light is beyond.
_REACH = 8.0


@dataclass(frozen=True)
class LensCamera:
    """A lens, its faults and its place in front of a pixel array that is read out whole.

    Attributes
    ----------
    lens
        Projection and light gathering.
    detector
        Pixels, whose amplifiers have no errors; `PixelArray.sunlit_e` is what a pixel would
        collect in the bare Sun without the lens (with the camera's filter, if any), which
        concentrates it by pupil over pixel area.
    blur_mm
        Standard deviation of the Gaussian that every point is blurred by.
    flare
        Light that does not form the image.
    sun
        The disc; far smaller than a usual frame's, few points of it are enough.
    assembly
        Misalignment: tilts turn the camera, the offset moves the optical axis on the detector.
    dead_share
        Share of pixels that read no light at all.
    clouds
        Patches of light that differ from sample to sample, or None. They are drawn with the
        noise: the expected signal, and so the bound, is that of the clear sky.
    """

    lens: Lens
    detector: PixelArray
    blur_mm: float
    flare: Flare = field(default_factory=Flare)
    sun: SolarDisc = field(default_factory=lambda: SolarDisc(rings=(8, 12, 16)))
    assembly: Assembly = field(default_factory=Assembly)
    dead_share: float = 0.0
    clouds: Clouds | None = None

    def __post_init__(self) -> None:
        if not self.blur_mm > 0:
            raise ValueError(f"blur_mm must be positive; got {self.blur_mm}")
        if not 0 <= self.dead_share < 1:
            raise ValueError(f"dead_share must be in [0, 1); got {self.dead_share}")
        if self.detector.errors.of_amplifiers or self.detector.tunnel:
            raise ValueError(
                "of cameras with a lens amplifiers without errors are simulated, and pixels "
                f"without tunnels; got {self.detector.errors} and tunnel = {self.detector.tunnel}"
            )

    @property
    def built_focal_length_mm(self) -> float:
        """Design plus assembly error."""
        return self.lens.focal_length_mm + self.assembly.focal_length_error_mm

    @property
    def axis_px(self) -> Floats:
        """(2,) detector coordinate of the optical axis, the principal point."""
        offset = np.array([self.assembly.offset_x_mm, self.assembly.offset_y_mm])
        return np.asarray(np.asarray(self.detector.centre_px) + offset / self.detector.pitch_mm)

    def _pixels(self, head: Floats) -> Floats:
        image = self.lens.image_mm(head, self.built_focal_length_mm)
        return np.asarray(image / self.detector.pitch_mm + self.axis_px)

    def image_px(self, sun: Floats) -> Floats:
        """(N, 2) detector coordinate of the image of the Sun's centre, Sun vectors (N, 3)."""
        return self._pixels(self.assembly.to_head(sun))

    def sun_of(self, image_px: Floats) -> Floats:
        """(N, 3) Sun vectors of image points (N, 2): the inverse of `image_px`."""
        image = (image_px - self.axis_px) * self.detector.pitch_mm
        head = self.lens.directions(image, self.built_focal_length_mm)
        return np.asarray(head @ self.assembly.matrix())

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain``, ``dark_e`` and ``alive`` (0 or 1), (rows, columns).

        A unit with a larger `dead_share` has the dead pixels of the smaller one and more.
        """
        detector = self.detector
        shape = (detector.rows, detector.columns)
        alive = generator(*names, "dead").random(shape) >= self.dead_share
        return {**detector.built(shape, *names), "alive": alive.astype(np.float64)}

    def shares(self, sun: Floats) -> Floats:
        """(N, H, W) share of the light gathered by the lens that falls on each pixel.

        The image is the Sun's disc point by point through the lens, each blurred by a Gaussian
        that is integrated over the pixels exactly; flare is centred on the Sun's centre.
        """
        detector = self.detector
        size = detector.rows, detector.columns, detector.pitch_mm
        optics = self.lens, self.blur_mm, self.flare, self.sun, self.assembly
        key = (type(self).__name__, size, optics, sun.tobytes())
        return memory.render(key, lambda: self._shares(sun))

    def _shares(self, sun: Floats) -> Floats:
        head = self.assembly.to_head(sun)
        points = self._pixels(self.sun.directions(head))
        _, weights = self.sun.quadrature()
        shares = np.zeros((len(sun), self.detector.rows, self.detector.columns))
        for frame, places in zip(shares, points, strict=True):
            self._add_image(frame, places, self.flare.image_share * weights)
        self.flare.add(shares, self._pixels(head), self.axis_px, self.detector.pitch_mm)
        return shares

    def _add_image(self, frame: Floats, places: Floats, weights: Floats) -> None:
        sigma = self.blur_mm / self.detector.pitch_mm
        bounds = []
        for axis, size in ((0, frame.shape[1]), (1, frame.shape[0])):
            low = math.floor(places[:, axis].min() - _REACH * sigma)
            high = math.ceil(places[:, axis].max() + _REACH * sigma) + 1
            bounds.append((min(max(low, 0), size), max(min(high, size), 0)))
        (left, right), (top, bottom) = bounds
        if left >= right or top >= bottom:
            return
        window = frame[top:bottom, left:right]
        for (x, y), weight in zip(places, weights, strict=True):
            window += (weight * _within(y, sigma, top, bottom))[:, None] * _within(
                x, sigma, left, right
            )

    def photo_electrons(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, H, W) mean electrons set free by light within one exposure; clear sky."""
        detector = self.detector
        cosine = self.assembly.to_head(scene.sun)[:, 2]
        gathered = self.lens.pupil_area_mm2 / detector.pitch_mm**2
        light = gathered * np.maximum(cosine, 0.0) * scene.irradiance
        electrons = self.shares(scene.sun)
        electrons *= light[:, None, None]
        electrons += scene.stray[:, None, None]
        electrons = detector.errors.gather(electrons)
        electrons *= detector.sunlit_e
        electrons *= pattern["gain"]
        return electrons

    def cloud_electrons(
        self, sun: Floats, pattern: FixedPattern, generator: np.random.Generator
    ) -> Floats | float:
        """(H, W) electrons of the clouds of one sample, `sun` (1, 3); 0 where it has none."""
        if self.clouds is None:
            return 0.0
        detector = self.detector
        light = self.clouds.light(
            (detector.rows, detector.columns), self.image_px(sun)[0], detector.pitch_mm, generator
        )
        light = detector.errors.gather(light[None])[0]
        return np.asarray(light * detector.sunlit_e * pattern["gain"])


def _within(centre: float, sigma: float, first: int, last: int) -> Floats:
    """Share of a Gaussian in each of the pixels `first` to `last` (exclusive)."""
    scale = 1.0 / (math.sqrt(2.0) * sigma)
    edges = np.array([math.erf((n - 0.5 - centre) * scale) for n in range(first, last + 1)])
    return np.asarray(0.5 * (edges[1:] - edges[:-1]))
