"""The Toeplitz matrices of eigen-analysis: real ones, of the same eigenvalues and eigenvectors."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.kernels.spot_spectra_kernel import as_series, frequency_correlations


def toeplitz(spectrum):
    """Build the Hermitian matrix entry by entry, from the spectrum continued by its conjugate."""
    count = len(spectrum)
    series = [spectrum[k] if k >= 0 else spectrum[-k].conjugate() for k in range(1 - count, count)]
    lags = [
        sum(series[k + lag] * series[k].conjugate() for k in range(len(series) - lag))
        for lag in range(count)
    ]
    return np.array(
        [
            [lags[i - j] if i >= j else lags[j - i].conjugate() for j in range(count)]
            for i in range(count)
        ]
    )


@settings(deadline=None, derandomize=True, max_examples=60)
@given(count=st.integers(1, 24), seed=st.integers(0, 2**32 - 1))
def test_real_matrices_have_the_eigenvalues_and_eigenvectors_of_the_complex_ones(count, seed):
    rng = np.random.default_rng(seed)
    spectra = rng.normal(size=(2, 1, count)) + 1j * rng.normal(size=(2, 1, count))
    spectra[..., 0] = spectra[..., 0].real  # of real light
    found = np.empty((2, 1, count, count))
    frequency_correlations(spectra, found)
    assert np.array_equal(found, found.swapaxes(-1, -2))
    values, vectors = np.linalg.eigh(found)
    series = np.empty((2, 1, count), dtype=complex)
    as_series(np.ascontiguousarray(vectors[..., -1]), series)
    for n in range(2):
        matrix = toeplitz(spectra[n, 0])
        largest = values[n, 0, -1]
        scale = np.abs(values[n, 0]).max()
        assert values[n, 0] == pytest.approx(np.linalg.eigvalsh(matrix), abs=1e-12 * scale)
        assert np.vdot(series[n, 0], series[n, 0]).real == pytest.approx(1.0, abs=1e-12)
        assert np.abs(matrix @ series[n, 0] - largest * series[n, 0]).max() < 1e-12 * scale


def test_a_spectrum_that_is_not_finite_gives_zeros():
    found = np.ones((1, 1, 3, 3))
    frequency_correlations(np.array([[[1.0, np.nan, 2.0]]], dtype=complex), found)
    assert not found.any()
