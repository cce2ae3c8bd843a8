"""Light of reference features, its noise, and the Cramer-Rao bound of where they are.

Flat features have a rim blurred by a Gaussian; the other ones are Gaussian. All are integrated
over the pixel: discs by quadrature, bars and Gaussians exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

Profile = Literal["flat", "gaussian"]

BACKGROUND_E = 20.0
READ_NOISE_E = 10.0
#: Sigma of a flat feature's rim.
EDGE_PX = 0.7
#: Half step of the bound's central differences, px.
STEP_PX = 1e-3
#: Digital numbers of the brightest light: room for a pedestal and noise in 16 bits.
_BRIGHTEST_DN = 20_000.0
#: Light further out than this many blur widths is left out: below 1e-8 of the peak.
_TAIL_SIGMAS = 6.0
_QUADRATURE = 4


def peak_e(snr: float) -> float:
    """Electrons a pixel above the background whose signal over noise is `snr`.

    Noise is that of the light, the background and the read-out.
    """
    noise2 = BACKGROUND_E + READ_NOISE_E**2
    return float((snr**2 + np.sqrt(snr**4 + 4.0 * snr**2 * noise2)) / 2.0)


def gain_e_per_dn(peak: float) -> float:
    """Electrons a digital number: one, or more where the peak would not fit."""
    return max(1.0, peak / _BRIGHTEST_DN)


def spots(
    size_px: int, centres: Floats, radius_px: float, profile: Profile, weights: Floats | None = None
) -> Floats:
    """Frames (N, size, size) of spots of height one.

    Parameters
    ----------
    size_px
        Side of the frames.
    centres
        (N, S, 2) x, y of each frame's spots; one whose centre is beyond the frame gives no light.
    radius_px
        To half the light of a disc; sigma of a Gaussian.
    profile
        ``flat`` is a disc with a blurred rim.
    weights
        (N, S) heights; one by default.
    """
    count, number, _ = centres.shape
    blur = EDGE_PX if profile == "flat" else radius_px
    reach = int(np.ceil((radius_px if profile == "flat" else 0.0) + _TAIL_SIGMAS * blur)) + 1
    offsets = np.arange(-reach, reach + 1)
    frames = np.zeros((count, size_px + 2 * reach, size_px + 2 * reach))
    rows = np.arange(count)[:, None, None]
    for spot in range(number):
        whole = np.rint(centres[:, spot]).astype(np.int64)
        local = centres[:, spot] - whole
        light = _discs if profile == "flat" else _gaussians
        patch = light(offsets - local[:, :1], offsets - local[:, 1:], radius_px)
        seen = ((whole >= 0) & (whole < size_px)).all(axis=1)
        height: Floats = np.asarray(seen, dtype=np.float64)
        if weights is not None:
            height *= weights[:, spot]
        near = np.clip(whole, 0, size_px - 1) + reach
        y = near[:, 1, None, None] + offsets[None, :, None]
        x = near[:, 0, None, None] + offsets[None, None, :]
        frames[rows, y, x] += patch * height[:, None, None]
    return np.ascontiguousarray(frames[:, reach : reach + size_px, reach : reach + size_px])


def bars(
    size_px: int, centres: Floats, half_px: float, profile: Profile, weights: Floats | None = None
) -> Floats:
    """Profiles (N, size) of bars of height one at (N, S); `half_px` is half their width or sigma.

    Other parameters as `spots`.
    """
    pixels = np.arange(size_px)[None, None, :] - centres[:, :, None]
    if profile == "gaussian":
        light = _pixel_gaussian(pixels, half_px)
    else:
        # the mean over a pixel of a step blurred by a Gaussian is a difference of its integral
        low, high = (_ramp((pixels + half_px + e) / EDGE_PX) for e in (-0.5, 0.5))
        light = high - low
        low, high = (_ramp((pixels - half_px + e) / EDGE_PX) for e in (-0.5, 0.5))
        light = EDGE_PX * (light - (high - low))
    if weights is not None:
        light = light * weights[:, :, None]
    return np.asarray(light.sum(axis=1))


def detect(
    mean_e: Floats, peak: float, pedestal: float, rng: np.random.Generator
) -> NDArray[np.uint16]:
    """Digital numbers of mean electrons: Poisson and read noise, gain, pedestal, 16 bits.

    `pedestal` is a share of the peak, added to the digital numbers.
    """
    gain = gain_e_per_dn(peak)
    electrons = rng.poisson(mean_e) + rng.normal(0.0, READ_NOISE_E, mean_e.shape)
    numbers = np.rint(electrons / gain) + round(pedestal * peak / gain)
    return np.asarray(np.clip(numbers, 0, 2**16 - 1), dtype=np.uint16)


def variance_e(mean_e: Floats, peak: float) -> Floats:
    """Variance of `detect` in electrons: light, read-out and rounding; clipping is left out."""
    return np.asarray(mean_e + READ_NOISE_E**2 + gain_e_per_dn(peak) ** 2 / 12.0)


def position_bound(
    mean: Callable[[Floats], Floats],
    places: Floats,
    nuisances: Callable[[Floats], list[Floats]],
    variance: Callable[[Floats], Floats],
    step: float = STEP_PX,
) -> float:
    """Root mean square Cramer-Rao bound of one coordinate of `places` (N, K).

    Parameters
    ----------
    mean
        Expected observations (N, ...) at places (N, K).
    places
        True coordinates.
    nuisances
        Derivatives (N, ...) of the expected observations, given, by what else is unknown.
    variance
        Of independent observations, from the expected ones.
    step
        Half step of the central differences.
    """
    count, axes = places.shape
    here = mean(places)
    derivatives = []
    for axis in range(axes):
        move = np.zeros(axes)
        move[axis] = step
        derivatives.append((mean(places + move) - mean(places - move)) / (2.0 * step))
    derivatives += nuisances(here)
    jacobian = np.stack([d.reshape(count, -1) for d in derivatives], axis=1)
    weighted = jacobian / variance(here).reshape(count, 1, -1)
    fisher = weighted @ np.swapaxes(jacobian, 1, 2)
    covariance = np.linalg.inv(fisher)
    return float(np.sqrt(np.mean([covariance[:, axis, axis] for axis in range(axes)])))


def _discs(x: NDArray[Any], y: NDArray[Any], radius: float) -> Floats:
    """Mean over pixels at offsets x, y (N, W) of discs: (N, W, W)."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy, where light is made

    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE)
    total = np.zeros((*y.shape, x.shape[1]))
    for a, along in zip(nodes / 2.0, weights / 2.0, strict=True):
        for b, across in zip(nodes / 2.0, weights / 2.0, strict=True):
            distance = np.hypot(x[:, None, :] + b, y[:, :, None] + a)
            total += along * across * ndtr((radius - distance) / EDGE_PX)
    return total


def _gaussians(x: NDArray[Any], y: NDArray[Any], sigma: float) -> Floats:
    return np.asarray(_pixel_gaussian(y, sigma)[:, :, None] * _pixel_gaussian(x, sigma)[:, None, :])


def _pixel_gaussian(t: NDArray[Any], sigma: float) -> Floats:
    """Mean over the pixel at t of a Gaussian of peak one."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy, where light is made

    share = ndtr((t + 0.5) / sigma) - ndtr((t - 0.5) / sigma)
    return np.asarray(np.sqrt(2.0 * np.pi) * sigma * share)


def _ramp(t: NDArray[Any]) -> Floats:
    """Integral of the normal distribution function."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy, where light is made

    return np.asarray(t * ndtr(t) + np.exp(-(t**2) / 2.0) / np.sqrt(2.0 * np.pi))
