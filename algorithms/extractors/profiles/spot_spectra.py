"""Cross-spectra of spots with their reference signal: what phase and subspace methods read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats
from algorithms.extractors.profiles.slit_lines import SlitLines, dark_level

#: First zero of a spectrum, in cycles a width: of a slit's even light, and of a disc's summed one.
FIRST_ZERO = {"square": 1.0, "round": 1.2196699}

#: Steps in turn, each in windows about the shift found before: the second already stays.
PASSES = 2

Shape = Literal["round", "square"]
_Step = Callable[[NDArray[np.complex128]], Floats]


@dataclass(frozen=True)
class SpotSpectra:
    """Windows around the spots of a line, and the spectra of their references.

    Attributes
    ----------
    places : ndarray, shape (S,)
        Positions of the spots at zero shift, px.
    groups : ndarray, shape (S,)
        Which shift moves each.
    half_px : int
        Half width of a window.
    period : int
        Length of the transform, px: the window's, or more where it is padded with zeros.
    reference : ndarray, shape (S, K)
        Spectra of the references at the frequencies 0 to K - 1, up to half the sampling, real:
        even light over the width of each spot, about the middle of its window, summed over pixels.
    zero : float
        First zero of the widest spot's reference, cycles a pixel.
    """

    places: Floats
    groups: NDArray[np.int64]
    half_px: int
    period: int
    reference: Floats
    zero: float

    @classmethod
    def behind(cls, slits: SlitLines, padded: bool) -> Self:
        """Windows and references of slits."""
        widths = [slit[2] for slit in slits.slits]
        return cls.of(slits.pattern(), slits.groups, widths, "square", slits.half_px, padded)

    @classmethod
    def of(  # noqa: PLR0917 - what the attributes are made of
        cls,
        places: Floats,
        groups: NDArray[np.int64],
        widths: list[float],
        shape: Shape,
        half_px: int,
        padded: bool,
    ) -> Self:
        """Windows and references of spots of these widths, px."""
        size = 2 * half_px + 1
        period = 2 * size - 1 if padded else size
        frequencies = np.arange((period - 1) // 2 + 1) / period
        reference = np.array(
            [width * _spectrum(frequencies * width, shape) for width in widths]
        ) * np.sinc(frequencies)
        return cls(places, groups, half_px, period, reference, FIRST_ZERO[shape] / max(widths))

    def shifts(self, slits: SlitLines, observations: ArrayLike, step: _Step) -> Floats:
        """Shifts (R, G), px, of the lines of observations, improved by a step, `PASSES` times.

        Each step goes from cross-spectra in windows about the shifts found before.
        """
        lines = slits.lines(observations)
        floors = dark_level(lines)
        shifts = slits.locate(lines, floors)
        for _ in range(PASSES):
            shifts = shifts + step(self.cross(lines, floors, shifts))
        return shifts

    @property
    def powers(self) -> Floats:
        """Squared references (G, K), summed over the spots of each group."""
        squares = self.reference**2
        return np.array([squares[self.groups == g].sum(axis=0) for g in np.unique(self.groups)])

    def cross(self, lines: Floats, floors: Floats, shifts: Floats) -> NDArray[np.complex128]:
        """Cross-spectra (R, G, K) of lines (R, L) at shifts (R, G); NaN where a spot is cut."""
        from algorithms.kernels import spot_spectra_kernel  # noqa: PLC0415 - Numba, at first use

        spectra = np.empty((*shifts.shape, self.reference.shape[1]), dtype=np.complex128)
        spot_spectra_kernel.cross_spectra(
            lines,
            floors,
            shifts,
            self.places,
            self.groups,
            self.half_px,
            self.period,
            self.reference,
            spectra,
        )
        return spectra

    def light(self, spectra: NDArray[np.complex128]) -> tuple[Floats, Floats]:
        """Power of the light in cross-spectra (R, G, K), and that of their noise (R, G)."""
        from algorithms.kernels import spot_spectra_kernel  # noqa: PLC0415 - Numba, at first use

        powers, noise = np.empty(spectra.shape), np.empty(spectra.shape[:2])
        spot_spectra_kernel.light_powers(spectra, self.powers, self.period, powers, noise)
        return powers, noise

    def slopes(self, spectra: NDArray[np.complex128], last: int | None) -> Floats:
        """Shifts (R, G), px, that the phases of cross-spectra (R, G, K) are linear in.

        Up to the frequency `last`, or those that stand out of the noise.
        """
        from algorithms.kernels import spot_spectra_kernel  # noqa: PLC0415 - Numba, at first use

        found = np.empty(spectra.shape[:2])
        spot_spectra_kernel.phase_slopes(
            spectra, *self.light(spectra), last or 0, self.zero, self.period, found
        )
        return found


def require_frequencies(frequencies: int | None, by: str) -> None:
    """Raise ValueError unless `frequencies` is None or at least 1."""
    if frequencies is not None and frequencies < 1:
        raise ValueError(f"{by}: frequencies must be None or at least 1; got {frequencies!r}")


def _spectrum(cycles: Floats, shape: Shape) -> Floats:
    """Spectrum, one at zero, of even light over a width, at frequencies in cycles a width."""
    if shape == "square":
        return np.asarray(np.sinc(cycles), dtype=np.float64)
    from scipy.special import j1  # noqa: PLC0415 - SciPy, for round apertures only

    angle = np.pi * np.where(cycles == 0, 1.0, cycles)
    return np.where(cycles == 0, 1.0, 2.0 * j1(angle) / angle)
