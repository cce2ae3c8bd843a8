"""Where a lens sends the light that does not form the image: aureole, veil, ghosts and streaks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats


@dataclass(frozen=True)
class Aureole:
    """Light scattered by small angles at rough or dusty surfaces, around the image.

    Irradiance ``share / (2 pi a^2) (1 + (r/a)^2)^(-3/2)`` at the distance r with a = `radius_mm`:
    it falls with the cube of the distance, as Harvey-Shack scatter of polished surfaces does
    within a factor; half of the light lies within ``sqrt(3) a``.
    """

    share: float
    radius_mm: float


@dataclass(frozen=True)
class Ghost:
    """A defocused image of the Sun by two reflections: an even disc.

    It lies on the line through the Sun's image and the optical axis, at `magnification` times
    the image's distance from the axis; negative is the far side.
    """

    share: float
    magnification: float
    radius_mm: float


@dataclass(frozen=True)
class Streak:
    """Light scattered by a bundle of parallel scratches or an edge: a line through the image.

    The product of two Lorentz profiles with half widths `length_mm` along and `width_mm` across
    the line, which is turned by `angle_deg` from the detector's x towards its y axis.
    """

    share: float
    angle_deg: float
    length_mm: float
    width_mm: float


@dataclass(frozen=True)
class Flare:
    """Shares of the light gathered that go astray; what is left forms the image.

    `veil` is spread evenly over the detector (veiling glare: light scattered by mount and
    detector so often that it has lost its direction).
    """

    aureole: Aureole | None = None
    veil: float = 0.0
    ghosts: tuple[Ghost, ...] = ()
    streaks: tuple[Streak, ...] = ()

    def __post_init__(self) -> None:
        shares = self._shares()
        if min(shares) < 0 or math.fsum(shares) >= 1:
            raise ValueError(f"shares must be in [0, 1) together; got {shares}")

    def _shares(self) -> list[float]:
        shares = [self.veil, 0.0 if self.aureole is None else self.aureole.share]
        shares += [ghost.share for ghost in self.ghosts]
        return shares + [streak.share for streak in self.streaks]

    @property
    def image_share(self) -> float:
        """Light left to form the image."""
        return 1.0 - math.fsum(self._shares())

    def add(self, shares: Floats, images_px: Floats, axis_px: Floats, pitch_mm: float) -> None:
        """Add the stray light of N images to `shares` (N, H, W): share of the light a pixel.

        Parameters
        ----------
        images_px
            (N, 2) detector coordinates of the image of the Sun's centre.
        axis_px
            (2,) detector coordinate of the optical axis.
        pitch_mm
            Of the pixels.
        """
        from benchmark.simulator.kernels.flare import (  # noqa: PLC0415 - Numba on demand
            add_aureole,
            add_disc,
            add_streak,
        )

        rows, columns = shares.shape[1:]
        shares += self.veil / (rows * columns)
        for frame, (x, y) in zip(shares, images_px, strict=True):
            if self.aureole is not None:
                add_aureole(frame, x, y, self.aureole.radius_mm / pitch_mm, self.aureole.share)
            for ghost in self.ghosts:
                centre = axis_px + ghost.magnification * (np.array([x, y]) - axis_px)
                radius = ghost.radius_mm / pitch_mm
                add_disc(frame, centre[0], centre[1], radius, ghost.share)
            for streak in self.streaks:
                turn = math.radians(streak.angle_deg)
                size = streak.length_mm / pitch_mm, streak.width_mm / pitch_mm
                axis = math.cos(turn), math.sin(turn)
                add_streak(frame, (x, y), axis, size, streak.share)


@dataclass(frozen=True)
class Clouds:
    """Bright patches near the Sun that differ from picture to picture: broken cloud, spray, dust.

    Every picture has `count` of them, each with the irradiance ``level (1 + (r/R)^2)^(-2)`` in
    units of mean sunlight at normal incidence.

    Attributes
    ----------
    count
        Patches a picture.
    distance_mm
        Standard deviation of their distance from the Sun's image, along each axis.
    radius_mm
        Least and largest R, uniform.
    level
        Least and largest irradiance at the middle, uniform.
    """

    count: int
    distance_mm: float
    radius_mm: tuple[float, float]
    level: tuple[float, float]

    def light(
        self,
        shape: tuple[int, int],
        image_px: Floats,
        pitch_mm: float,
        generator: np.random.Generator,
    ) -> Floats:
        """Irradiance (H, W) of one picture; draws the same amount of randomness each time."""
        normal = generator.standard_normal((self.count, 2))
        uniform = generator.random((self.count, 2))
        x, y = np.arange(shape[1]), np.arange(shape[0])
        light = np.zeros(shape)
        for place, (size, strength) in zip(normal, uniform, strict=True):
            centre = image_px + self.distance_mm / pitch_mm * place
            radius = (self.radius_mm[0] + size * (self.radius_mm[1] - self.radius_mm[0])) / pitch_mm
            level = self.level[0] + strength * (self.level[1] - self.level[0])
            square = ((x - centre[0])[None, :] ** 2 + (y - centre[1])[:, None] ** 2) / radius**2
            light += level / ((1.0 + square) * (1.0 + square))
        return light
