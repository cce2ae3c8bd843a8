"""Beyond the survey: the place of a slit's diffracted image, by a fit of the image itself."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.extractors.profiles.linear_phase import LinearPhase
from algorithms.extractors.profiles.slit_lines import NEEDS, SlitLines
from algorithms.parameters import require_positive

#: Sunlight on silicon: wavelengths mm and their shares of the photons of a black body of 5772 K
#: that a front-illuminated pixel detects.
_WAVES = np.array(
    [(4.5e-4, 0.19), (5.5e-4, 0.28), (6.5e-4, 0.25), (7.5e-4, 0.16), (8.5e-4, 0.09), (9.5e-4, 0.03)]
)
#: Radius of the Sun's disc at its mean distance, rad, and how much less its rim sends.
_SUN_RAD = 0.00465
_LIMB_DARKENING = 0.6
_CHORDS = 12
#: Dark pixels beside the widest spot that are fitted as well.
_DARK_PX = 2
#: Fresnel integrals are tabled up to this argument; asymptotic forms are exact to 1e-7 beyond.
_TABLED = 24
#: Of the tangents of light that glass bends: contractions by a third at least.
_BENT = 40


@documented
@dataclass(frozen=True)
class SlitImage(SlitLines):
    """Position of each slit's image by least squares on a diffraction model of the image.

    The image is computed from the design and the approximate direction: Fresnel diffraction of
    sunlight at both edges, blurred by the solar disc and integrated over pixels. Light,
    background, width and position are fitted together.

    Parameters
    ----------
    slits : tuple of (float, float, float)
        Offset from the line's middle, px, tangent of the slant and width along the line, px, of
        each slit; all lines lie behind the same. At most two different slants, slits of one slant
        equally wide.
    height_px : float
        From the middle of the mask to the lines, px, positive.
    pixel_mm : float
        A pixel's pitch, positive: sets how many pixels a wavelength is.
    mask_px : float
        Thickness of the mask, px: slanted light passes a narrower slit.
    glass : tuple of (float, float)
        Thickness, px, and index of each plate of the height.

    Notes
    -----
    Implements: nothing printed in the survey. With ``J = J_r rr' + J_t tt'``, by which a landing
    point moves when the direction cosines do (``h / cos^3`` and ``h / cos`` without glass), light
    of wavelength l falls as ``|F(u_+) - F(u_-)|^2 / 2``, ``u_+- = sqrt(2 / (l n'Jn)) (w +- a)``, F
    the Fresnel integrals, a half of the slit's width and w the distance along its normal n; the
    Sun's disc blurs by ``|J n|`` times its radius. The direction is that of `LinearPhase`'s spot,
    from which the fit starts. Noise grows with light, so weights fall to a sixth at the brightest
    pixel.

    The share of a pixel that is sensitive is on no drawing, crosstalk and a spectrum unlike the
    one assumed blur as well: the width's derivative is fitted beside the place and, even where
    that is odd, costs it little. Behind a slanted slit the height of the pixels spreads the image
    over an unknown box, whose width is fitted. The mean wavelength is not: behind a slit four
    pixels wide, 550 nm in place of 620 treble the error (`pda-slit`), behind one of seven nothing
    changes. The cubic term of the phase is left out, which moves spots as smoothly with direction
    as the model learns.

    Failure: a NaN row where `LinearPhase` has one and where a fit does not converge.

    Cost: that of `LinearPhase`, and for each spot 12 Fresnel integrals and 12 chords for each of
    some 500 places, and 10 operations per pixel and step, 4 to 20 of them.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> drawn = dict(height_px=50.0, pixel_mm=0.05)
    >>> SlitImage(**design, **drawn).extract(profiles).round(1)
    array([[43.3, 36.8]])
    """

    about: ClassVar = AboutExtractor(
        name="slit-image",
        taxonomy="None",
        origin="ours",
        needs=NEEDS,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    height_px: float = field(kw_only=True)
    pixel_mm: float = field(kw_only=True)
    mask_px: float = field(default=0.0, kw_only=True)
    glass: tuple[tuple[float, float], ...] = field(default=(), kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self.about.name, height_px=self.height_px, pixel_mm=self.pixel_mm)
        if not self.mask_px >= 0.0:
            raise ValueError(f"{self.about.name}: mask_px must not be negative; got {self.mask_px}")
        for slant in self.tangents:
            widths = [slit[2] for slit in self.slits if slit[1] == slant]
            if not np.allclose(widths, widths[0], rtol=1e-9, atol=0.0):
                raise UnsuitableDesignError(
                    f"{self.about.name} fits slits of one slant with one image: they must be "
                    f"equally wide; got {widths!r} px"
                )
        thick = sum(plate[0] for plate in self.glass)
        if any(not (t > 0 and n >= 1) for t, n in self.glass) or thick > self.height_px:
            raise ValueError(
                f"{self.about.name}: glass must be plates of positive thickness that fit under the "
                f"mask, and an index of at least 1; got {self.glass!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the fit for this sensor's lines and slits.

        ValueError where a field of `needs` is None, or where the slits do not give both
        coordinates.
        """
        drawn = LinearPhase.for_sensor(geometry)
        pitch = geometry.pixel_pitch_mm or 0.0
        return cls(
            drawn.line_axes,
            drawn.line_pixels,
            drawn.slits,
            drawn.reach_px,
            drawn.margin_px,
            height_px=(geometry.focal_length_mm or 0.0) / pitch,
            pixel_mm=pitch,
            mask_px=(geometry.mask_thickness_mm or 0.0) / pitch,
            glass=tuple((t / pitch, n) for t, n in geometry.cover_glass or ()),
        )

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in profiles (N, A L); ValueError on wrong input."""
        from algorithms.extractors.profiles import slit_image_kernel  # noqa: PLC0415 - Numba

        lines = self.lines(observations)
        lined = (self.line_axes, self.line_pixels, self.slits, self.reach_px, self.margin_px)
        moved = LinearPhase(*lined).extract(observations) - self.middle_px
        shifts = np.empty((len(moved), len(self.line_axes), len(self.tangents)))
        shapes = np.empty((*shifts.shape, 3))
        for line, axis in enumerate(self.line_axes):
            along, across = moved.T if axis == "x" else moved.T[::-1]
            for group, slant in enumerate(self.tangents):
                width = next(slit[2] for slit in self.slits if slit[1] == slant)
                shifts[:, line, group] = along + across * slant
                shapes[:, line, group] = self._shape(along, across, slant, width)
        found = shifts.reshape(len(lines), -1)
        slanted = [float(slit[1] != 0.0) for slit in self.slits]
        slit_image_kernel.add_shifts(
            found,
            lines,
            np.stack([self.pattern(), self.groups, slanted], axis=1),
            shapes.reshape(*found.shape, 3),
            math.ceil(max(s[2] * (0.5 if s[1] == 0.0 else 1.0) for s in self.slits))
            + math.ceil(self.margin_px)
            + _DARK_PX,
            _WAVES / np.array([self.pixel_mm, 1.0]),
            _chords(),
            _fresnel_table(slit_image_kernel.FRESNEL_STEPS),
        )
        return self.spots(found)

    def _shape(self, along: Floats, across: Floats, slant: float, width: float) -> Floats:
        """(N, 3) half width, spread and blur of images whose shadow is displaced that far."""
        bent = self._tangents(np.hypot(along, across))
        square = bent**2
        sine = bent / np.sqrt(1.0 + square)
        cosine = 1.0 / np.sqrt(1.0 + square)
        air = self.height_px - sum(plate[0] for plate in self.glass)
        across_ray, along_ray = air / cosine, air / cosine**3
        for thickness, index in self.glass:
            inside = np.sqrt(index**2 - sine**2)
            across_ray = across_ray + thickness / inside
            along_ray = along_ray + thickness * index**2 / inside**3
        distance = np.hypot(along, across)
        normal = np.hypot(1.0, slant)
        # the displacement's direction against the slit's normal, (1, slant) along and across
        part = np.divide(
            along + slant * across, normal * distance, out=np.zeros_like(bent), where=distance > 0.0
        )
        share = part**2
        spread = along_ray * share + across_ray * (1.0 - share)
        blur = np.sqrt((along_ray * cosine) ** 2 * share + across_ray**2 * (1.0 - share))
        half = 0.5 * (width - self.mask_px * normal * bent * np.abs(part))
        return np.stack([half, spread * normal**2, _SUN_RAD * blur * normal], axis=1)

    def _tangents(self, distance: Floats) -> Floats:
        """Tangents (N,) off the boresight of light that lands that far off, glass allowed for."""
        tangents = distance / self.height_px
        for _ in range(_BENT if self.glass else 0):
            height = np.full_like(distance, self.height_px)
            for thickness, index in self.glass:
                bent = np.sqrt(index**2 + (index**2 - 1.0) * tangents**2)
                height -= thickness * (1.0 - 1.0 / bent)
            tangents = distance / height
        return tangents


@lru_cache(maxsize=1)
def _chords() -> Floats:
    """(Q, 2) places of chords of the Sun's disc in units of its radius, and their shares of light.

    A disc whose light falls by the limb darkening u has chords of ``2 (1 - u) s + u pi s^2 / 2``
    at the height ``sqrt(1 - s^2)``.
    """
    places, weights = np.polynomial.legendre.leggauss(_CHORDS)
    square = 1.0 - places**2
    light = 2.0 * (1.0 - _LIMB_DARKENING) * np.sqrt(square) + _LIMB_DARKENING * math.pi / 2 * square
    shares = weights * light
    return np.stack([places, shares / shares.sum()], axis=1)


@lru_cache(maxsize=1)
def _fresnel_table(steps: int) -> Floats:
    """(M, 4) Fresnel integrals C and S, `steps` a unit, and their derivatives."""
    from scipy.special import fresnel  # noqa: PLC0415 - SciPy, at first use

    places = np.arange(_TABLED * steps + 1) / steps
    sines, cosines = fresnel(places)
    angles = math.pi / 2.0 * places**2
    return np.stack([cosines, sines, np.cos(angles), np.sin(angles)], axis=1)
