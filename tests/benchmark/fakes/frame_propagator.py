"""Light behind apertures by angular spectrum: an oracle that shares nothing with the simulator.

Masks, glass, wavelengths and the Sun are plain numbers here. The field behind the foil is a sum
of plane waves (a discrete Fourier transform), each of which gets its exact phase through the gap
and the glass. Nothing is expanded about the chief ray. A hole and its foil have a grid of their
own, `FINE_MM`: what bends between two rims of 10 um is some 2 um wide, and on the detector's cells
the middle of a round spot came out 1.2 % of its peak too dark. The Sun is added by smearing the
intensity with its own projected image, ray-traced point by point.

Intensity is ``|U|^2`` times the cosine of the chief ray, as in `slit_propagator`. That is the flux
of a black screen, field and slope of the incoming wave in the opening (Kirchhoff), to first order
in how far light has turned. Rayleigh's two integrals, of the field alone and of the slope alone,
lean by as much to either side of it: by the cosine of each plane wave over that of the chief ray
or its inverse, which at 60 deg moves centroids by up to 0.06 pixels. A metal foil does the one to
either polarisation; sunlight has none.

What it leaves out: polarisation; that surfaces of the glass reflect more of one plane wave than
of another (all get the transmission of the chief ray); that the pattern itself changes over half
a degree of the Sun.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates

Layers = Sequence[tuple[float, float]]

#: Cells of holes and their foil, and how far beyond a hole what bends in the foil is followed, mm.
FINE_MM, _AROUND_MM = 4e-4, 0.03
#: Quantum efficiencies that `SUNLIT_SILICON` is made of, at 450, 550, ... 950 nm.
_EFFICIENCY = (0.50, 0.60, 0.50, 0.35, 0.20, 0.08)


def sunlight(count: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """Wavelengths in nm, evenly from 400 to 1000, and weights.

    Photons of a black body of 5772 K times the quantum efficiency, linear between its values.
    """
    wave = 400.0 + 600.0 * (np.arange(count) + 0.5) / count
    micro = wave / 1000.0
    photons = micro**-4.0 / np.expm1(14387.769 / (micro * 5772.0))
    weights = photons * np.interp(wave, 450.0 + 100.0 * np.arange(6), _EFFICIENCY)
    return wave, weights / weights.sum()


@dataclass(frozen=True)
class Hole:
    """One opening: ``round`` or ``rectangle``, full sizes, place and turn as drawn."""

    shape: str
    width_mm: float
    height_mm: float
    x_mm: float = 0.0
    y_mm: float = 0.0
    turn_deg: float = 0.0

    def open(self, x: np.ndarray, y: np.ndarray, step: float) -> np.ndarray:
        """Share of the grid's cells (rows y, columns x) that is open: a signed distance, clipped.

        Exact for sides along the grid, to a hundredth of a cell for others.
        """
        c, s = math.cos(math.radians(self.turn_deg)), math.sin(math.radians(self.turn_deg))
        dx, dy = x[None, :] - self.x_mm, y[:, None] - self.y_mm
        if self.shape == "round":
            inside = self.width_mm / 2.0 - np.sqrt(dx**2 + dy**2)
            return np.clip(inside / step + 0.5, 0.0, 1.0)
        across = self.width_mm / 2.0 - np.abs(c * dx + s * dy)
        along = self.height_mm / 2.0 - np.abs(c * dy - s * dx)
        return np.clip(across / step + 0.5, 0.0, 1.0) * np.clip(along / step + 0.5, 0.0, 1.0)


@dataclass(frozen=True)
class Design:
    """What stands above the detector.

    `height_mm` counts from the detector to the foil's middle; `glass` are (thickness, index) of
    plates on the detector.
    """

    holes: tuple[Hole, ...]
    height_mm: float
    thickness_mm: float = 0.0
    glass: Layers = ()

    def layers(self, height_mm: float) -> list[tuple[float, float]]:
        """Thickness and index from a plane so far above the detector down."""
        return [(height_mm - sum(t for t, _ in self.glass), 1.0), *self.glass]

    def landing(self, sun: np.ndarray) -> np.ndarray:
        """(..., 2) where rays through the foil's middle land, by Snell's law."""
        across = sun[..., :2]
        square = np.sum(across**2, axis=-1)
        reach = np.zeros(square.shape)
        for thickness, index in self.layers(self.height_mm):
            reach = reach + thickness / np.sqrt(index**2 - square)
        return np.asarray(across * reach[..., None])

    def passed(self, sun: np.ndarray) -> np.ndarray:
        """Share of unpolarised light that passes the glass and goes on in vacuum."""
        before, cosine = 1.0, sun[..., 2]
        square = 1.0 - cosine**2
        s_wave, p_wave = np.ones(cosine.shape), np.ones(cosine.shape)
        for index in [n for _, n in self.glass] + [1.0]:
            inside = np.sqrt(index**2 - square) / index
            a, b = before * cosine, index * inside
            s_wave = s_wave * 4.0 * a * b / (a + b) ** 2
            c, d = index * cosine, before * inside
            p_wave = p_wave * 4.0 * c * d / (c + d) ** 2
            before, cosine = index, inside
        return (s_wave + p_wave) / 2.0


@dataclass(frozen=True)
class Grid:
    """Square cells about the aperture and, moved along, about the chief ray's landing point."""

    step_mm: float
    columns: int
    rows: int

    @property
    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        x, y = (
            (np.arange(count) - count // 2) * self.step_mm for count in (self.columns, self.rows)
        )
        return x, y

    @property
    def frequencies(self) -> tuple[np.ndarray, np.ndarray]:
        """Cycles a millimetre, (1, columns) and (rows, 1)."""
        fx, fy = (fft.fftfreq(count, self.step_mm) for count in (self.columns, self.rows))
        return fx[None, :], fy[:, None]


def grid_for(reach_mm: tuple[float, float], step_mm: float) -> Grid:
    """Grid of cells that holds so much on either side of its middle, of quick sizes."""
    columns, rows = (fft.next_fast_len(2 * math.ceil(r / step_mm)) for r in reach_mm)
    return Grid(step_mm, columns, rows)


def monochrome(design: Design, sun: np.ndarray, wavelength_nm: float, grid: Grid) -> np.ndarray:
    """Irradiance (rows, columns) about the chief ray, of light that is 1 at normal incidence.

    Sun: a point in the direction `sun` (3,), in front.
    """
    wave = wavelength_nm * 1e-6
    fx, fy = grid.frequencies
    # x and y of the detector are flipped: light from +x goes on towards +x
    gx, gy = fx + sun[0] / wave, fy + sun[1] / wave
    square = gx**2 + gy**2
    going = square < wave**-2
    square = np.where(going, square, 0.0)
    half = design.thickness_mm / 2.0
    spectrum = sum(_behind(hole, 2.0 * half, sun, wave, (fx[0], fy[:, 0])) for hole in design.holes)
    # through the foil's middle, wherever it crosses the lower rim's plane
    chief = design.landing(sun)
    phase = np.zeros(square.shape)
    reach_x, reach_y = np.zeros(square.shape), np.zeros(square.shape)
    for thickness, index in design.layers(design.height_mm - half):
        depth = np.sqrt((index / wave) ** 2 - square)
        phase += thickness * depth
        reach_x += thickness * gx / depth
        reach_y += thickness * gy / depth
    # plane waves that land outside the grid would come back in on its other side
    lost = np.abs(reach_x - chief[0]) > grid.columns // 2 * grid.step_mm * 0.98
    lost |= np.abs(reach_y - chief[1]) > grid.rows // 2 * grid.step_mm * 0.98
    phase += fx * chief[0] + fy * chief[1]
    spectrum *= np.where(going & ~lost, np.exp(2j * math.pi * np.remainder(phase, 1.0)), 0.0)
    field = fft.ifft2(spectrum, overwrite_x=True) / grid.step_mm**2
    flux = (field.real**2 + field.imag**2) * float(sun[2] * design.passed(sun))
    return fft.fftshift(flux)


def _behind(
    hole: Hole, foil_mm: float, sun: np.ndarray, wave: float, frequencies: tuple[np.ndarray, ...]
) -> np.ndarray:
    """Fourier integral (rows, columns) of the field at a hole's lower rim, mm^2."""
    extent = hole.width_mm, hole.width_mm if hole.shape == "round" else hole.height_mm
    step = min(FINE_MM, hole.width_mm / 64.0)
    around = (foil_mm > 0) * _AROUND_MM + step
    grid = grid_for((extent[0] / 2.0 + around, extent[1] / 2.0 + around), step)
    x, y = grid.axes
    opened = replace(hole, x_mm=0.0, y_mm=0.0).open(x, y, step)
    field = opened.astype(np.complex128)
    if foil_mm > 0:
        # the foil's walls take what hits them, its lower rim cuts
        fx, fy = grid.frequencies
        square = (fx + sun[0] / wave) ** 2 + (fy + sun[1] / wave) ** 2
        depth = np.sqrt((wave**-2 - square).astype(np.complex128))
        field = fft.ifft2(fft.fft2(field) * np.exp(2j * math.pi * foil_mm * depth)) * opened
    rows, columns = (np.flatnonzero(opened.any(axis=axis)) for axis in (1, 0))
    across, along = (
        np.exp(-2j * math.pi * np.outer(frequency, axis + place))
        for frequency, axis, place in zip(
            frequencies, (x[columns], y[rows]), (hole.x_mm, hole.y_mm), strict=True
        )
    )
    return along @ (field[np.ix_(rows, columns)] @ across.T) * step**2


def sun_image(
    design: Design, sun: np.ndarray, grid: Grid, diameter_deg: float, darkening: float
) -> np.ndarray:
    """(rows, columns) image that the Sun's disc has through a point, sum 1, on the grid.

    Radiance ``1 - u (1 - sqrt(1 - r^2))``; 60 rings of 180 points, each ray-traced, weighed by
    the cosine and the glass, and shared out to the four cells around it.
    """
    area, shares = np.polynomial.legendre.leggauss(60)
    area = (area + 1.0) / 2.0
    radiance = shares * (1.0 - darkening * (1.0 - np.sqrt(1.0 - area)))
    turn = 2.0 * math.pi * (np.arange(180) + 0.5) / 180
    off = math.sin(math.radians(diameter_deg / 2.0)) * np.sqrt(area)[:, None]
    helper = np.array([0.0, 0.0, 1.0]) if abs(sun[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = np.cross(helper, sun)
    first /= np.linalg.norm(first)
    second = np.cross(sun, first)
    points = (
        np.sqrt(1.0 - off**2)[..., None] * sun
        + (off * np.cos(turn))[..., None] * first
        + (off * np.sin(turn))[..., None] * second
    )
    weights = radiance[:, None] * points[..., 2] * design.passed(points)
    weights = weights / (radiance.sum() * len(turn) * sun[2] * design.passed(sun))
    places = (design.landing(points) - design.landing(sun)) / grid.step_mm
    image = np.zeros((grid.rows, grid.columns))
    column = np.floor(places[..., 0]).astype(int)
    row = np.floor(places[..., 1]).astype(int)
    u, v = places[..., 0] - column, places[..., 1] - row
    for i, share_y in ((0, 1.0 - v), (1, v)):
        for j, share_x in ((0, 1.0 - u), (1, u)):
            np.add.at(image, (row + i, column + j), weights * share_x * share_y)
    return image


def frame(
    design: Design,
    sun: np.ndarray,
    pitch_mm: float,
    first_mm: tuple[float, float],
    size_px: tuple[int, int],
    *,
    step_mm: float,
    reach_mm: tuple[float, float],
    light: tuple[np.ndarray, np.ndarray] | None = None,
    diameter_deg: float = 0.533,
    darkening: float = 0.6,
) -> np.ndarray:
    """Light averaged over each pixel, (rows, columns), in units of normal sunlight.

    Parameters
    ----------
    sun
        (3,) unit vector to the Sun's middle.
    first_mm
        Detector coordinate (x, y) of the first pixel's centre.
    size_px
        Columns and rows.
    step_mm, reach_mm
        Cells of the grid, and how much of it lies on either side of the chief ray along x and y.
        It must hold window, aperture and foil, and the cells the finest fringes in the window.
    light
        Wavelengths in nm and weights; `sunlight` by default.
    """
    grid = grid_for(reach_mm, step_mm)
    waves, weights = sunlight() if light is None else light
    total = np.zeros((grid.rows, grid.columns))
    for wave, weight in zip(waves, weights, strict=True):
        total += weight * monochrome(design, sun, float(wave), grid)
    spectrum = fft.fft2(total)
    if diameter_deg > 0:
        image = sun_image(design, sun, grid, diameter_deg, darkening)
        # the image's middle is the grid's first cell: negative places wrap, as Fourier's do
        spectrum *= fft.fft2(image)
    fx, fy = grid.frequencies
    spectrum *= np.sinc(fx * pitch_mm) * np.sinc(fy * pitch_mm)
    smooth = np.real(fft.ifft2(spectrum))
    chief = design.landing(sun)
    columns, rows = size_px
    x = (first_mm[0] + pitch_mm * np.arange(columns) - chief[0]) / step_mm + grid.columns // 2
    y = (first_mm[1] + pitch_mm * np.arange(rows) - chief[1]) / step_mm + grid.rows // 2
    row, column = np.meshgrid(y, x, indexing="ij")
    return map_coordinates(smooth, [row, column], order=3, mode="nearest")
