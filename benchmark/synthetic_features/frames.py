"""Reference frames of one spot whose true centre and Cramer-Rao bound are known.

Frames are electrons at one electron a digital number, so the sets hold for every extractor of
frames without a sensor around it. Light is integrated over the pixel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.seeds import generator

#: Half step of the central differences of the bound, px.
_STEP_PX = 1e-3
_BATCH = 100
#: Light further out than this many blur widths from a spot's rim is left out: below 1e-8 of it.
_TAIL_SIGMAS = 6.0
#: Points of Gauss-Legendre quadrature across a pixel; the rim is smooth on that scale.
_QUADRATURE = 4


@dataclass(frozen=True)
class SyntheticSet:
    """One spot a frame on a flat background, with Poisson and read noise.

    Attributes
    ----------
    name
        Names the random stream.
    shape
        ``disc``: uniform, its rim blurred by a Gaussian (an error function across it).
        ``gaussian``: round.
    size_px
        Side of the square frame.
    scale_px
        Radius of the disc to half its light, or sigma of the Gaussian.
    margin_px
        Least distance of a centre from the outermost pixel's centre.
    peak_e, background_e, read_noise_e
        Electrons a pixel, above the background where it is the peak.
    edge_px
        Sigma of the disc's rim; unused by the Gaussian.
    bits
        Of the converter: digital numbers are rounded and clipped to ``0 .. 2**bits - 1``.
    """

    name: str
    shape: Literal["disc", "gaussian"]
    size_px: int
    scale_px: float
    margin_px: float
    peak_e: float
    background_e: float = 20.0
    read_noise_e: float = 10.0
    edge_px: float = 0.7
    bits: int = 12

    def centres(self, count: int) -> Floats:
        """Return the true centres (count, 2) px, uniform over the frame within its margin."""
        far = self.size_px - 1.0 - self.margin_px
        rng = generator("reference", self.name, "centres")
        return rng.uniform(self.margin_px, far, (count, 2))

    def expected(self, centres: Floats) -> Floats:
        """Return the mean electrons (N, H, W) of spots at (N, 2)."""
        frames = np.full((len(centres), self.size_px, self.size_px), self.background_e)
        blur = self.scale_px if self.shape == "gaussian" else self.edge_px
        rim = 0.0 if self.shape == "gaussian" else self.scale_px
        reach = int(np.ceil(rim + _TAIL_SIGMAS * blur)) + 1
        for frame, (x, y) in zip(frames, centres, strict=True):
            rows = _near(y, reach, self.size_px)
            columns = _near(x, reach, self.size_px)
            frame[rows.start : rows.stop, columns.start : columns.stop] += self.peak_e * (
                _gaussian(np.array(columns) - x, np.array(rows) - y, blur)
                if self.shape == "gaussian"
                else _disc(np.array(columns) - x, np.array(rows) - y, rim, blur)
            )
        return frames

    def frames(self, count: int) -> tuple[NDArray[np.uint16], Floats]:
        """Return frames (count, H, W) and their true centres (count, 2), always the same."""
        centres = self.centres(count)
        rng = generator("reference", self.name, "noise")
        frames = np.empty((count, self.size_px, self.size_px), dtype=np.uint16)
        for first in range(0, count, _BATCH):
            light = self.expected(centres[first : first + _BATCH])
            signal = rng.poisson(light) + rng.normal(0.0, self.read_noise_e, light.shape)
            frames[first : first + _BATCH] = np.clip(np.rint(signal), 0, 2**self.bits - 1)
        return frames, centres

    def bound_px(self, centres: Floats) -> float:
        """Root mean square Cramer-Rao bound of one axis over these spots, px.

        Unknown are both coordinates, the spot's brightness and the background; the shape is
        known. The Fisher matrix is ``J^T V^-1 J`` with the variance of light, read noise and
        rounding; clipping is left out.
        """
        return float(np.sqrt(np.mean([self._variances(centre) for centre in centres])))

    def _variances(self, centre: Floats) -> Floats:
        """Return the bound's variances (2,) of x and y for one centre (2,), px^2."""
        steps = _STEP_PX * np.array([[1, 0], [-1, 0], [0, 1], [0, -1], [0, 0]])
        right, left, down, up, here = self.expected(centre + steps).reshape(5, -1)
        jacobian = np.column_stack(
            [
                (right - left) / (2 * _STEP_PX),
                (down - up) / (2 * _STEP_PX),
                (here - self.background_e) / self.peak_e,
                np.ones_like(here),
            ]
        )
        variance = here + self.read_noise_e**2 + 1.0 / 12.0
        fisher = jacobian.T @ (jacobian / variance[:, None])
        return np.asarray(np.diag(np.linalg.inv(fisher))[:2], dtype=np.float64)


#: Peak electrons, noise and shapes are those of the issue that asked for these sets.
REFERENCE_SETS: Mapping[str, SyntheticSet] = MappingProxyType(
    {
        found.name: found
        for found in (
            SyntheticSet("disc", "disc", 64, 8.0, margin_px=16.0, peak_e=2000.0),
            SyntheticSet("disc-512", "disc", 512, 8.0, margin_px=16.0, peak_e=2000.0),
            SyntheticSet("gaussian", "gaussian", 64, 3.0, margin_px=16.0, peak_e=200.0),
        )
    }
)


def _near(centre: float, reach: int, size: int) -> range:
    middle = round(centre)
    return range(max(middle - reach, 0), min(middle + reach + 1, size))


def _gaussian(x: NDArray[Any], y: NDArray[Any], sigma: float) -> Floats:
    """Mean over the pixel of a Gaussian of peak one, at pixels' offsets x (W,) and y (H,)."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy, where frames are made

    across, along = (
        np.sqrt(2 * np.pi) * sigma * (ndtr((t + 0.5) / sigma) - ndtr((t - 0.5) / sigma))
        for t in (x, y)
    )
    return np.asarray(np.outer(along, across), dtype=np.float64)


def _disc(x: NDArray[Any], y: NDArray[Any], radius: float, edge: float) -> Floats:
    """Mean over the pixel of a disc of height one with a blurred rim, by quadrature."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy, where frames are made

    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE)
    fine_x, fine_y = ((t[:, None] + nodes / 2).ravel() for t in (x, y))
    light = ndtr((radius - np.hypot(fine_x[None, :], fine_y[:, None])) / edge)
    cells = light.reshape(len(y), _QUADRATURE, len(x), _QUADRATURE)
    return np.asarray(np.einsum("iajb,a,b->ij", cells, weights / 2, weights / 2), dtype=np.float64)
