"""Shot noise, read noise and conversion to digits; independent of how samples are batched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator

#: From this mean on a Poisson variate is drawn as a Gaussian of the same mean and variance.
GAUSSIAN_FROM: float = 20.0


@dataclass(frozen=True)
class NoiseStreams:
    """Generators, each drawn in sample order: Gaussian values and small Poisson counts.

    Two, because the number of small counts depends on the signal: drawn from the Gaussian
    stream they would shift everything after them and tie the values to the batch size. The noise
    of columns has one of its own, so that pixels' noise stays as it is without it.
    """

    gaussian: np.random.Generator
    poisson: np.random.Generator
    columns: np.random.Generator | None = None

    @classmethod
    def named(cls, *names: str | int) -> NoiseStreams:
        """Return the streams of this dataset, version, condition and split."""
        return cls(*(generator(*names, of) for of in ("gaussian", "poisson", "columns")))

    def column_noise(self, deviation: float, shape: tuple[int, ...]) -> Floats:
        """Noise of the amplifiers of columns, a row of `shape` for every reading.

        Raises
        ------
        ValueError
            Where there is no stream of them.
        """
        if self.columns is None:
            raise ValueError("noise of columns needs a stream of its own; columns is None")
        return deviation * self.columns.standard_normal(shape)


def draw_counts(mean: Floats, read_noise: float, streams: NoiseStreams) -> Floats:
    """Electrons read out: Poisson(mean) plus Gaussian read noise, same shape as `mean`.

    Means of `GAUSSIAN_FROM` electrons and more are drawn as Gaussians of variance equal to the
    mean (skewness below 0.23, far below the read noise of the sensors here).
    """
    normal = streams.gaussian.standard_normal(mean.shape, dtype=np.float32)
    few = ~(mean >= GAUSSIAN_FROM)  # NaN, too: refused below
    dim = few.any()
    # in place, and without a choice where there is none: half of the time of a small frame
    electrons = np.where(few, 0.0, mean) if dim else mean.copy()
    electrons += read_noise**2
    np.sqrt(electrons, out=electrons)
    electrons *= normal
    electrons += mean
    if dim:
        means = np.maximum(mean[few], 0.0)
        electrons[few] += streams.poisson.poisson(means) - means
    return np.asarray(electrons, dtype=np.float64)
