"""Light bent at apertures, on windows of pixels: `DiffractedLight`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.diffraction_tables import RoundPattern
from benchmark.simulator.optics.projection import Camera, ProjectedLight
from benchmark.simulator.optics.rectangle_patterns import (
    RectanglePattern,
    apart,
    bend,
    disc_image,
    disc_strips,
    matrix,
    shade_edges,
)

#: Points of the Sun that give the middle of its image and its light.
_RINGS = (8, 12)
#: Cells a pixel, an axis, that light behind rectangles turned against the pixels is summed on.
_CELLS = 3.0
#: Round holes: largest phase across a cell, and how far outside the shadow tables end, in ``k a``
#: times the direction cosine; as of `RoundSpots`.
_CELL_RAD, _TABULATED = 5.0, 25.0


@dataclass(frozen=True)
class Stance:
    """How the head stands at each sample.

    Attributes
    ----------
    head
        (N, 3) unit vectors to the Sun in the head's frame.
    height_mm
        (N,) from the detector to the foil's middle.
    seen
        Where the Sun's points put the mask's rims.
    """

    head: Floats
    height_mm: Floats
    seen: ProjectedLight


def few_points(camera: Camera) -> Camera:
    """Return the camera under a Sun of few points, enough for its image's middle and light."""
    return replace(camera, sun=replace(camera.sun, rings=_RINGS, spiral=0))


@dataclass(frozen=True)
class DiffractedLight:
    """Scalar Fresnel diffraction about the chief ray (see `diffraction`) on windows of pixels.

    For each wavelength, over the Sun's disc. Round apertures take tables in two coordinates,
    which hold any oblique incidence, the cubic term of the phase to first order
    (`RoundPattern.seen`). Rectangles, however turned, take
    the product of two slits' patterns along their own sides and what the coupling of both axes
    adds at the corners (see `rectangle_patterns`). Of a foil with a thickness light passes what
    both displaced rims leave open, in its middle.

    Attributes
    ----------
    camera, spectrum
        What shines through what.
    pitch_mm, size_px
        Pixels, and columns and rows of a window.
    reach_mm
        Distance from the spot's middle that a window shows.
    widest_deg
        Largest incidence tabulated; beyond, the pattern keeps this one's Fresnel numbers.
    """

    camera: Camera
    spectrum: Spectrum
    pitch_mm: float
    size_px: tuple[int, int]
    reach_mm: float
    widest_deg: float

    def __post_init__(self) -> None:
        if not 0 < self.widest_deg < 90:
            raise ValueError(f"widest_deg must be in (0, 90); got {self.widest_deg}")

    def render(self, stance: Stance, corner_mm: Floats) -> Floats:
        """(N, H, W) light of the mean sunlight in windows with first corners at (N, 2)."""
        columns, rows = self.size_px
        flux = np.zeros((len(stance.head), rows, columns))
        front = stance.head[:, 2:] > 1e-6
        stance = replace(stance, head=np.where(front, stance.head, [0.0, 0.0, 1.0]))
        rectangles: list[Aperture] = []
        round_ones: dict[float, list[Aperture]] = {}
        for aperture in self.camera.mask.apertures:
            if aperture.shape == "round":
                round_ones.setdefault(aperture.width_mm, []).append(aperture)
            else:
                rectangles.append(aperture)
        for group in round_ones.values():
            self._add_round(flux, stance, corner_mm, group)
        if rectangles:
            self._add_rectangles(flux, stance, corner_mm, rectangles)
        return flux

    def _cells(self, diameter: float) -> int:
        """Cells a side of a pixel over which a round hole's tables are averaged beforehand.

        So small that waves of the highest frequency, or half the softness of an edge, are hardly
        turned within one.
        """
        nm = np.array(self.spectrum.wavelengths_nm) * np.array(self.spectrum.weights)
        spread = float(nm.sum()) * 1e-6 * self.camera.height_mm
        finest = math.pi * diameter / spread * self.pitch_mm / _CELL_RAD
        return max(1, math.ceil(min(finest, 2.0 * self.pitch_mm / math.sqrt(spread))))

    def _pattern(self, diameter: float) -> RoundPattern:
        camera = self.camera
        far = _TABULATED * min(self.spectrum.wavelengths_nm) * 1e-6 / (math.pi * diameter)
        return RoundPattern(
            radius_mm=diameter / 2.0,
            height_mm=camera.height_mm,
            glass=camera.glass,
            sun=camera.sun,
            spectrum=self.spectrum,
            reach_mm=min(self.reach_mm, diameter / 2.0 + far * camera.height_mm),
            widest_deg=self.widest_deg,
            thickness_mm=camera.mask.thickness_mm,
            cell_mm=self.pitch_mm / self._cells(diameter),
        )

    def _add_round(
        self, flux: Floats, stance: Stance, corner_mm: Floats, group: list[Aperture]
    ) -> None:
        from benchmark.simulator.kernels.diffraction import add_round  # noqa: PLC0415 - Numba

        pattern = self._pattern(group[0].width_mm)
        cells = self._cells(group[0].width_mm)
        assembly, head = self.camera.assembly, stance.head
        corner = corner_mm - np.array([assembly.offset_x_mm, assembly.offset_y_mm])
        sine = np.sqrt(np.sum(head[:, :2] ** 2, axis=1))
        known = np.minimum(sine, math.sin(math.radians(self.widest_deg)))
        steps, unit = pattern.scales(known)
        light = head[:, 2] * self.camera.glass.transmission(head) * unit
        light = np.where(stance.seen.light.max(axis=1) > 0.0, light, 0.0)
        centres = np.array([(a.x_mm, a.y_mm) for a in group])
        inside = (np.arange(cells) + 0.5) * (self.pitch_mm / cells)
        add_round(
            flux,
            pattern.tables(),
            (
                head,
                np.column_stack([light, pattern.place(known), 1.0 / steps, pattern.seen(known)]),
                centres[None] - corner[:, None],
            ),
            (pattern.layers(), np.column_stack([inside, np.full(cells, 1.0 / cells)])),
        )

    def _rectangle(self, aperture: Aperture) -> RectanglePattern:
        camera = self.camera
        return RectanglePattern(
            half_mm=(aperture.width_mm / 2.0, aperture.height_mm / 2.0),
            thickness_mm=camera.mask.thickness_mm,
            # the drawn one, so that all units share their tables: those of edges are in Fresnel's
            # own coordinate, and what is left at corners hardly depends on it
            height_mm=camera.focal_length_mm,
            glass=camera.glass,
            sun=camera.sun,
            spectrum=self.spectrum,
            pitch_mm=self.pitch_mm,
            reach_mm=self.reach_mm,
            widest_deg=self.widest_deg,
        )

    def _add_rectangles(
        self, flux: Floats, stance: Stance, corner_mm: Floats, group: list[Aperture]
    ) -> None:
        # the disc's middle of light, a little off the Sun's, and all of its light
        seen = stance.seen
        light = seen.light.sum(axis=1)
        weights = seen.light / np.where(light > 0, light, 1.0)[:, None]
        lower, upper = np.sum(seen.rims_mm * weights[None, :, :, None], axis=2)
        middles = (lower + upper) / 2.0 - corner_mm
        for aperture in group:
            self._add_rectangle(flux, (light, middles, upper - lower), stance, aperture)

    def _add_rectangle(
        self,
        flux: Floats,
        spots: tuple[Floats, Floats, Floats],
        stance: Stance,
        aperture: Aperture,
    ) -> None:
        from benchmark.simulator.kernels.diffraction_corners import (  # noqa: PLC0415 - Numba
            add_corners,
        )
        from benchmark.simulator.kernels.diffraction_slits import (  # noqa: PLC0415 - Numba
            add_rectangle,
        )

        light, middles, parted = spots
        pattern = self._rectangle(aperture)
        turn = math.radians(aperture.rotation_deg)
        c, s = math.cos(turn), math.sin(turn)
        own = _turn(stance.head, c, s)
        sine = np.sqrt(np.sum(own[:, :2] ** 2, axis=1))
        limit = math.sin(math.radians(self.widest_deg))
        share = np.minimum(1.0, limit / np.maximum(sine, limit))[:, None]
        known = np.column_stack([own[:, :2] * share, np.sqrt(1.0 - np.minimum(sine, limit) ** 2)])
        spread = matrix(known, stance.height_mm, self.camera.glass)
        across, along, both = spread
        radius = math.sin(math.radians(self.camera.sun.diameter_deg / 2.0))
        shade, soft = shade_edges(known, np.abs(_turn(parted, c, s)), self.camera.mask.thickness_mm)
        shapes = np.column_stack(
            [
                light,
                aperture.width_mm / 2.0 - shade[:, 0],
                aperture.height_mm / 2.0 - shade[:, 1],
                across,
                along,
                disc_image(known, spread, radius),
                bend(known, stance.height_mm, self.camera.glass, spread),
                soft,
                apart(known, soft, self.camera.mask.thickness_mm, spread),
            ]
        )
        places = middles + np.array([aperture.x_mm, aperture.y_mm])
        add_rectangle(
            flux,
            (places, shapes),
            (
                np.array([c, s, self.pitch_mm, _CELLS]),
                pattern.waves(),
                disc_strips(self.camera.sun.limb_darkening),
            ),
            pattern.widths(),
        )
        coupling = both / np.sqrt(across * along)
        add_corners(
            flux,
            (places, np.column_stack([shapes[:, :5], coupling]), pattern.place(known)),
            np.array([c, s, self.pitch_mm]),
            pattern.corners(),
        )


def _turn(vectors: Floats, cosine: float, sine: float) -> Floats:
    """Vectors (N, 2 or 3) in axes turned by an angle about z."""
    out = vectors.copy()
    out[:, 0] = cosine * vectors[:, 0] + sine * vectors[:, 1]
    out[:, 1] = cosine * vectors[:, 1] - sine * vectors[:, 0]
    return out
