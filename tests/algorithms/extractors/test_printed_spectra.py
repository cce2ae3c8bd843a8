"""alg:linearphase and alg:eigen transcribed, in each spot's window, by plain transforms."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.extractors.profiles.linear_phase import LinearPhase

#: Slit, px, and the window that holds its spot.
WIDTH, MARGIN = 9.0, 3.0
HALF = math.ceil(WIDTH / 2 + MARGIN)
LINES = {
    "line_axes": ("x", "y"),
    "line_pixels": 71,
    "slits": ((0.0, 0.0, WIDTH),),
    "reach_px": 20.0,
    "margin_px": MARGIN,
}


def noisy_lines(count=5, seed=3):
    """Lines (count, 2, 71) of a blurred slit's light and noise, and where it is (count, 2)."""
    rng = np.random.default_rng(seed)
    places = rng.uniform(27.0, 43.0, (count, 2))
    edges = np.arange(72) - 0.5
    blur = np.linspace(-1.0, 1.0, 9)
    light = np.zeros((count, 2, 71))
    for shift in blur:
        ends = np.clip(edges - places[..., None] - shift, -WIDTH / 2, WIDTH / 2)
        light += 1500.0 * np.diff(ends, axis=2) / len(blur)
    return rng.poisson(light + 30.0) + rng.normal(0, 8.0, light.shape), places


def transform(values, first, period):
    """Discrete Fourier transform at 0 to half the sampling of values from place `first` on."""
    return [
        sum(
            value * cmath.exp(-2j * math.pi * k * (first + n) / period)
            for n, value in enumerate(values)
        )
        for k in range((period - 1) // 2 + 1)
    ]


def sinc(x):
    return 1.0 if x == 0 else math.sin(math.pi * x) / (math.pi * x)


def reference(k, period):
    """S_0: spectrum of even light over the slit, summed over pixels, about the window's middle."""
    return WIDTH * sinc(WIDTH * k / period) * sinc(k / period)


def noise_of(powers, period):
    """What ERRATA's "low frequencies only" leaves open: above a quarter of the sampling is noise.

    Powers of noise are exponentially distributed: their median is ``ln 2`` of their mean.
    """
    high = [power for k, power in enumerate(powers) if k >= 0.25 * period]
    return float(np.median(high)) / math.log(2.0)


def linear_phase_as_printed(line, start, frequencies=None):
    """alg:linearphase: the slope of the phases of ``Y[k] = S_a[k] / S_0[k]``.

    ERRATA: weights ``|S[k]|^2``, and no bins that hold noise only.
    """
    period = 2 * HALF + 1
    place = start
    for _ in range(2):
        centre = round(place)
        window = [value - float(np.median(line)) for value in line[centre - HALF :][:period]]
        shifted = transform(window, -HALF - (place - centre), period)
        powers = [abs(value) ** 2 for value in shifted]
        noise = noise_of(powers, period)
        moment = square = 0.0
        for k in range(1, len(shifted)):
            y = shifted[k] / reference(k, period)
            if frequencies is None:
                if k > 1 and powers[k] <= 9.0 * noise:
                    continue
                weight = powers[k] - noise
            elif k > frequencies:
                break
            else:
                weight = powers[k]
            psi = cmath.phase(y)
            turn = 2 * math.pi if k * WIDTH < period else math.pi  # the sign of S_0 beyond
            if square > 0.0:
                psi += turn * round((k * moment / square - psi) / turn)
            moment += weight * k * psi
            square += weight * k * k
        alpha = -moment / square * period / (2 * math.pi)
        place += alpha
    return place


def eigen_as_printed(line, start, frequencies=None):
    """alg:eigen: least projection of ``b(tau)`` on all noise eigenvectors, on a fine grid.

    ERRATA: the minimum, and an exponent with its j.
    """
    size = 2 * HALF + 1
    k_x = 2 * size - 1
    place = start
    for _ in range(2):
        centre = round(place)
        window = [value - float(np.median(line)) for value in line[centre - HALF :][:size]]
        light = transform(window, -HALF - (place - centre), k_x)
        if frequencies is None:
            powers = [abs(value) ** 2 for value in light]
            loud = [k for k in range(2, len(light)) if powers[k] > 9.0 * noise_of(powers, k_x)]
            last = max([1, *loud])
        else:
            last = frequencies
        r_12 = {k: light[k] * reference(k, k_x) for k in range(last + 1)}
        r_12 |= {-k: r_12[k].conjugate() for k in range(1, last + 1)}
        # R_x by its definition: what the printed padded transforms give for these lags
        r_x = [
            sum(r_12[k + lag] * r_12[k].conjugate() for k in range(-last, last + 1 - lag))
            for lag in range(last + 1)
        ]
        covariance = np.array(
            [
                [r_x[i - j] if i >= j else r_x[j - i].conjugate() for j in range(last + 1)]
                for i in range(last + 1)
            ]
        )
        noise_space = np.linalg.eigh(covariance)[1][:, :-1]
        best, found = math.inf, 0.0
        for tau in np.arange(-1.5, 1.5, 2e-3):
            b = np.array(
                [
                    reference(k, k_x) ** 2 * cmath.exp(-2j * math.pi * k * tau / k_x)
                    for k in range(last + 1)
                ]
            )
            projection = float(np.sum(np.abs(b.conj() @ noise_space) ** 2))
            if projection < best:
                best, found = projection, tau
        place += found
    return place


@pytest.mark.parametrize("frequencies", [None, 1, 4])
def test_linear_phase(frequencies):
    lines, places = noisy_lines()
    method = LinearPhase(**LINES, frequencies=frequencies)
    found = method.extract(lines.reshape(len(lines), -1))
    for profile, mine, true in zip(lines, found, places, strict=True):
        expected = [
            linear_phase_as_printed(line, at, frequencies)
            for line, at in zip(profile, true, strict=True)
        ]
        np.testing.assert_allclose(mine, expected, rtol=0, atol=2e-3)


@pytest.mark.parametrize("frequencies", [None, 3, 14])
def test_eigen_analysis(frequencies):
    lines, places = noisy_lines(2)
    method = EigenAnalysis(**LINES, frequencies=frequencies)
    found = method.extract(lines.reshape(len(lines), -1))
    for profile, mine, true in zip(lines, found, places, strict=True):
        expected = [
            eigen_as_printed(line, at, frequencies) for line, at in zip(profile, true, strict=True)
        ]
        np.testing.assert_allclose(mine, expected, rtol=0, atol=4e-3)


@pytest.mark.parametrize("method", [LinearPhase, EigenAnalysis])
@pytest.mark.parametrize("width", [6.0, 16.0, 28.0])
def test_more_frequencies_where_the_light_has_them_are_finer(method, width):
    """A wide slit's edges are in many: a tenth of its width from the first alone is far coarser."""
    rng = np.random.default_rng(8)
    places = 60.0 + rng.uniform(-10, 10, (80, 2))
    edges = np.arange(122) - 0.5
    light = sum(
        np.diff(np.clip(edges - places[..., None] - shift, -width / 2, width / 2), axis=2) / 9
        for shift in np.linspace(-1, 1, 9)
    )
    profiles = (rng.poisson(2000 * light + 20) + rng.normal(0, 10, light.shape)).reshape(80, -1)
    lines = LINES | {"line_pixels": 121, "slits": ((0.0, 0.0, width),)}
    few, chosen = (
        np.sqrt(np.mean((method(**lines, frequencies=k).extract(profiles) - places) ** 2))
        for k in (1 if method is LinearPhase else 2, None)
    )
    assert chosen < 1.15 * few
    if width > 10.0:
        assert chosen < 0.7 * few
