"""Spectra of the light of spots on lines: their noise, phases, correlations and projections.

Lines are (R, L) float64. ``places`` (S,) are the spots' positions at zero shift, px, and `groups`
(S,) say which of the G shifts moves each.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Counts = NDArray[np.int64]

#: Frequencies, cycles a pixel, from which on a spectrum is taken to be noise.
_NOISE_FROM = 0.25
#: Power over that of noise above which a frequency counts: three standard deviations.
_SIGNIFICANT = 9.0
#: Steps a pixel of the first search for the least projection; Newton's steps that follow it.
_STEPS = 4
_NEWTON = 6


@compiled
def cross_spectra(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Floats,
    floors: Floats,
    shifts: Floats,
    places: Floats,
    groups: Counts,
    half: int,
    period: int,
    reference: Floats,
    out: NDArray[np.complex128],
) -> None:
    """Write the pattern's cross-spectra with its spots' references to `out` (R, G, K).

    A window of ``2 half + 1`` pixels about each spot is transformed at the frequencies 0 to K - 1
    over `period`, its floor (R,) taken off, multiplied by its reference's spectrum (S, K), real,
    and summed over the spots of a group, each turned back by where its shift (R, G) puts it. A
    NaN row where a shift is NaN or a window leaves the line.
    """
    rows, length = lines.shape
    spots, frequencies = reference.shape
    cosine, sine = np.empty((2, 2 * half + 1, frequencies))
    for n in range(2 * half + 1):
        for k in range(frequencies):
            place = (n - half) * k % period
            cosine[n, k] = math.cos(2 * math.pi * place / period)
            sine[n, k] = math.sin(2 * math.pi * place / period)
    real, imaginary = np.empty((2, frequencies))
    for r in range(rows):
        out[r] = 0.0
        for i in range(spots):
            g = groups[i]
            at = places[i] + shifts[r, g]
            if not (half - 0.5 <= at <= length - 1 - half + 0.49):
                out[r, g] = np.nan
                continue
            centre = round(at)
            if centre < half or centre > length - 1 - half:
                out[r, g] = np.nan
                continue
            real[:] = 0.0
            imaginary[:] = 0.0
            for n in range(2 * half + 1):
                u = lines[r, centre - half + n] - floors[r]
                for k in range(frequencies):
                    real[k] += u * cosine[n, k]
                    imaginary[k] -= u * sine[n, k]
            for k in range(frequencies):
                angle = 2 * math.pi * k * (at - centre) / period
                turn = complex(math.cos(angle), math.sin(angle))
                out[r, g, k] += complex(real[k], imaginary[k]) * turn * reference[i, k]


@compiled
def light_powers(
    spectra: NDArray[np.complex128], norms: Floats, period: int, powers: Floats, noise: Floats
) -> None:
    """Write the light's power at each frequency to `powers` (R, G, K) and its noise to (R, G).

    That is the power of the cross-spectrum (R, G, K) over its references' (G, K), so that white
    noise has the same everywhere. The noise is read off the frequencies from a quarter of the
    sampling on, whose powers are exponentially distributed: the median over ``ln 2``. Light that
    sharp edges leave there is aliased, and counts as noise.
    """
    rows, kinds, frequencies = spectra.shape
    first = min(math.ceil(_NOISE_FROM * period), frequencies - 1)
    for r in range(rows):
        for g in range(kinds):
            for k in range(frequencies):
                norm = norms[g, k]
                value = spectra[r, g, k]
                power = value.real * value.real + value.imag * value.imag
                powers[r, g, k] = power / norm if norm > 0.0 else 0.0
            noise[r, g] = np.median(powers[r, g, first:]) / math.log(2.0)


@compiled
def bands(powers: Floats, noise: Floats, out: Counts) -> None:
    """Write the last frequency that stands out of the noise to `out` (R, G), at least 1."""
    rows, kinds, frequencies = powers.shape
    for r in range(rows):
        for g in range(kinds):
            out[r, g] = 1
            for k in range(2, frequencies):
                if powers[r, g, k] > _SIGNIFICANT * noise[r, g]:
                    out[r, g] = k


@compiled
def phase_slopes(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spectra: NDArray[np.complex128],
    powers: Floats,
    noise: Floats,
    last: int,
    zero: float,
    period: int,
    out: Floats,
) -> None:
    """Write the shifts, px, that the phases of spectra (R, G, K) are linear in to `out` (R, G).

    The phases of the frequencies 1 to `last` are unwrapped one after the other to the branch next
    to the line fitted to those before, then fitted with the light's powers (R, G, K) as weights;
    the line meets zero at frequency zero. With `last` 0 those frequencies count whose power stands
    out of the `noise` (R, G), less that. From the reference's first `zero` on, cycles a pixel,
    light a little narrower than it has its sign turned: there branches are half a turn apart.
    """
    rows, kinds, frequencies = spectra.shape
    end = min(last + 1, frequencies) if last > 0 else frequencies
    for r in range(rows):
        for g in range(kinds):
            moment = 0.0
            square = 0.0
            for k in range(1, end):
                weight = powers[r, g, k]
                if last == 0:
                    if k > 1 and not weight > _SIGNIFICANT * noise[r, g]:
                        continue
                    weight = max(weight - noise[r, g], 1e-9 * weight)
                value = spectra[r, g, k]
                phase = math.atan2(value.imag, value.real)
                if square > 0:
                    turn = 2 * math.pi if k < zero * period else math.pi
                    ahead = k * moment / square
                    phase += turn * np.rint((ahead - phase) / turn)
                moment += weight * k * phase
                square += weight * k * k
            out[r, g] = -period / (2 * math.pi) * moment / square if square > 0 else np.nan


@compiled
def _real_form(lags: NDArray[np.complex128], out: Floats) -> None:
    """Write the real matrix (K, K) of the Hermitian Toeplitz matrix of first column `lags`."""
    frequencies = lags.size
    half, odd = frequencies // 2, frequencies % 2
    for i in range(half):
        for j in range(half):
            near = lags[i - j] if i >= j else lags[j - i].conjugate()
            far = lags[frequencies - 1 - j - i].conjugate()
            out[i, j] = (near + far).real
            out[i, half + odd + j] = -(near - far).imag
            out[half + odd + i, j] = (near + far).imag
            out[half + odd + i, half + odd + j] = (near - far).real
        if odd:
            middle = math.sqrt(2.0) * lags[half - i].conjugate()
            out[i, half] = out[half, i] = middle.real
            out[half + 1 + i, half] = out[half, half + 1 + i] = middle.imag
    if odd:
        out[half, half] = lags[0].real


@compiled
def frequency_correlations(spectra: NDArray[np.complex128], out: Floats) -> None:
    """Write the matrices of spectra (R, G, K)'s own correlation to `out` (R, G, K, K), as real.

    A spectrum of real light is continued to the frequencies ``1 - K .. K - 1`` by its conjugate;
    entry (i, j) of the matrix T is its correlation at the lag i - j. T is Hermitian and Toeplitz,
    so that reversing an eigenvector conjugates it: vectors ``(t, r, reversed conjugate of t)`` with
    ``t = (p + j q) / sqrt(2)`` are as many as real ones (p, r, q), on which T acts as a symmetric
    real matrix of the same eigenvalues (Cantoni and Butler 1976), which costs half as much. Zero
    where a spectrum is not finite.
    """
    rows, kinds, frequencies = spectra.shape
    series = np.empty(2 * frequencies - 1, dtype=np.complex128)
    lags = np.empty(frequencies, dtype=np.complex128)
    for r in range(rows):
        for g in range(kinds):
            for k in range(frequencies):
                value = spectra[r, g, k]
                series[frequencies - 1 + k] = value
                series[frequencies - 1 - k] = value.conjugate()
            if not np.isfinite(series).all():
                out[r, g] = 0.0
                continue
            for lag in range(frequencies):
                total = complex(0.0, 0.0)
                for k in range(series.size - lag):
                    total += series[k + lag] * series[k].conjugate()
                lags[lag] = total
            _real_form(lags, out[r, g])


@compiled
def as_series(vectors: Floats, out: NDArray[np.complex128]) -> None:
    """Write the complex vectors that (R, G, K) real ones of `frequency_correlations` stand for."""
    rows, kinds, frequencies = vectors.shape
    half, odd = frequencies // 2, frequencies % 2
    for r in range(rows):
        for g in range(kinds):
            for i in range(half):
                value = complex(vectors[r, g, i], vectors[r, g, half + odd + i]) / math.sqrt(2.0)
                out[r, g, i] = value
                out[r, g, frequencies - 1 - i] = value.conjugate()
            if odd:
                out[r, g, half] = vectors[r, g, half]


@compiled
def _refined_shift(signal: NDArray[np.complex128], step: float, shift: float) -> float:
    """Return where the tone of `signal` (K) is strongest, by Newton's method from a shift near."""
    for _ in range(_NEWTON):
        value = complex(0.0, 0.0)
        slope = complex(0.0, 0.0)
        bend = complex(0.0, 0.0)
        for k in range(signal.size):
            angle = step * k * shift
            turn = complex(math.cos(angle), -math.sin(angle))
            term = signal[k] * turn
            value += term
            slope += complex(0.0, -step * k) * term
            bend -= (step * k) * (step * k) * term
        first = (value.conjugate() * slope).real
        second = (slope.conjugate() * slope + value.conjugate() * bend).real
        if not second < 0:
            break
        shift -= first / second
    return shift


@compiled
def least_projections(
    signals: NDArray[np.complex128], powers: Floats, period: int, reach: float, out: Floats
) -> None:
    """Write the shift, px, of least projection on the noise subspace to `out` (R, G).

    `signals` (R, G, K) are the unit eigenvectors of the signal, the only ones that are not of
    noise, so the projection of ``b = powers exp(-2 pi j k shift / period)`` on the others is
    ``|b|^2 - |signal^H b|^2``. It is searched over `reach` to both sides, then off the grid.
    """
    rows, kinds, frequencies = signals.shape
    step = 2 * math.pi / period
    tries = math.ceil(reach * _STEPS)
    turns = np.empty((2 * tries + 1, frequencies), dtype=np.complex128)
    for t in range(-tries, tries + 1):
        for k in range(frequencies):
            angle = step * k * (t / _STEPS)
            turns[t + tries, k] = complex(math.cos(angle), -math.sin(angle))
    signal = np.empty(frequencies, dtype=np.complex128)
    for r in range(rows):
        for g in range(kinds):
            out[r, g] = np.nan
            for k in range(frequencies):
                signal[k] = signals[r, g, k].conjugate() * powers[k]
            best = 0.0
            most = -1.0
            for t in range(-tries, tries + 1):
                total = complex(0.0, 0.0)
                for k in range(frequencies):
                    total += signal[k] * turns[t + tries, k]
                size = total.real * total.real + total.imag * total.imag
                if size > most:
                    most = size
                    best = t / _STEPS
            shift = _refined_shift(signal, step, best)
            if most > 0 and abs(shift - best) <= 1.0 / _STEPS:
                out[r, g] = shift
