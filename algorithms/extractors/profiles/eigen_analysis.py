"""Shift of a spot from the noise subspace of its spectrum's covariance (eigen-analysis)."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import AboutExtractor, FeatureKind, Floats, Observation
from algorithms.documented import documented
from algorithms.extractors.profiles.slit_lines import NEEDS, SlitLines
from algorithms.extractors.profiles.spot_spectra import SpotSpectra, require_frequencies


@documented
@dataclass(frozen=True)
class EigenAnalysis(SlitLines):
    """Shift whose model spectrum has the smallest projection on the noise subspace.

    The cross-spectrum of a shifted spot and its reference is a pure tone over frequency. All
    eigenvectors of its covariance except the strongest span the noise subspace; the tone of the
    true shift has the smallest projection on it.

    Parameters
    ----------
    frequencies : int or None
        How many frequencies above zero make the series. The published method uses all frequencies.
        None, ours, ends it at the last whose power exceeds nine times the noise, estimated from
        the spectrum above a quarter of the sampling frequency: beyond, it is noise and aliased
        light.

    Notes
    -----
    Implements: alg:eigen (fe:eigena, Enright2006b): zero-padding of the N pixels to ``K_x = 2 N -
    1``; cross-spectrum ``R_r12[k]`` of the light with its reference; its own correlation over
    frequency ``R_x[l]``; the Toeplitz covariance of its first lags; ``b(tau) = |S[k]|^2 exp(-2 pi
    j k tau / K_x)``, as many entries; ``tau = argmin |b^H E_n|^2`` over the noise eigenvectors
    E_n, one spot leaving all but one. The survey prints argmax; corrected because the model of the
    right shift is orthogonal to noise. The survey prints the correlation's exponent without its j;
    corrected because the transform has one. ``R_x`` is summed directly: the printed detour over a
    padded transform gives the same lags. The shift is first found to about a pixel as the place
    where the pattern of slits is brightest (as PD does, on means over a slit's width), and the N
    pixels are those of a window about each spot; the cross-spectra of slits of one slant are
    summed. The minimum is searched on a grid and then off it, by Newton's method.

    Cost: 2 operations per pixel and slit, the median of each line, 8 per frequency and pixel of the
    windows, the eigenvectors of a matrix, 5 to 30 a side, and its side times 4 tries a pixel.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> EigenAnalysis(**design).extract(profiles).round(1)
    array([[43.3, 36.8]])
    """

    about: ClassVar = AboutExtractor(
        name="eigen-analysis",
        taxonomy="Eigen-analysis",
        studies=("Enright2006b",),
        labels=("fe:eigena", "alg:eigen"),
        origin="survey",
        needs=NEEDS,
        version=2,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    frequencies: int | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        require_frequencies(self.frequencies, self.about.name)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in profiles (N, A L); ValueError on wrong input."""
        spectra = SpotSpectra.behind(self, padded=True)
        return self.spots(spectra.shifts(self, observations, partial(self._steps, spectra)))

    def _steps(self, spectra: SpotSpectra, cross: NDArray[np.complex128]) -> Floats:
        """Shifts (R, G) of least projection of cross-spectra (R, G, K)."""
        from algorithms.kernels import spot_spectra_kernel  # noqa: PLC0415 - Numba, at first use

        rows, kinds, count = cross.shape
        last = np.full((rows, kinds), min(self.frequencies or 0, count - 1))
        if self.frequencies is None:
            spot_spectra_kernel.bands(*spectra.light(cross), last)
        reach = max(slit[2] for slit in self.slits) / 2.0 + 1.0
        steps = np.empty(last.shape)
        for size, group in itertools.product(np.unique(last) + 1, range(kinds)):
            chosen = np.flatnonzero(last[:, group] + 1 == size)
            part = np.ascontiguousarray(cross[chosen, group : group + 1, :size])
            covariance = np.empty((*part.shape, size))
            spot_spectra_kernel.frequency_correlations(part, covariance)
            # LAPACK takes one matrix at a time, so each profile's result is its own.
            vectors = np.ascontiguousarray(np.linalg.eigh(covariance)[1][..., -1])
            strongest = np.empty(part.shape, dtype=np.complex128)
            spot_spectra_kernel.as_series(vectors, strongest)
            found = np.empty((len(chosen), 1))
            powers = np.ascontiguousarray(spectra.powers[group, :size])
            spot_spectra_kernel.least_projections(strongest, powers, spectra.period, reach, found)
            steps[chosen, group] = found[:, 0]
        steps[~np.isfinite(cross).all(axis=-1)] = np.nan
        return steps
