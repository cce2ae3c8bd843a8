"""What other libraries offer for the centre of one spot, as their users call it.

Each peer takes frames (N, H, W) and returns centres (N, 2) px. photutils, SEP and scikit-image are
in the dependency group `peers`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Method = Callable[[NDArray[Any]], NDArray[np.float64]]

THRESHOLD = 0.3
#: Half side of the cut-out about the brightest pixel that fits are given, px.
REACH = 24


def _above(frame: NDArray[Any]) -> NDArray[Any]:
    return np.where(frame > THRESHOLD * frame.max(), frame, 0)


def opencv_moments(frame: NDArray[Any]) -> tuple[float, float]:
    """Return the moments of the pixels above a fraction of the maximum."""
    _, largest, _, _ = cv2.minMaxLoc(frame)
    _, above = cv2.threshold(frame, THRESHOLD * largest, 0, cv2.THRESH_TOZERO)
    m = cv2.moments(above)
    return m["m10"] / m["m00"], m["m01"] / m["m00"]


def _scipy_moments(frame: NDArray[Any]) -> tuple[float, float]:
    from scipy.ndimage import center_of_mass

    y, x = center_of_mass(_above(frame))
    return x, y


def _scipy_gaussian(frame: NDArray[Any]) -> tuple[float, float]:
    from scipy.optimize import curve_fit

    part, left, top = _cut_out(frame)
    rows, columns = (axis.ravel().astype(float) for axis in np.indices(part.shape))

    def model(_: object, *p: float) -> NDArray[np.float64]:
        square = ((columns - p[1]) / p[3]) ** 2 + ((rows - p[2]) / p[4]) ** 2
        return np.asarray(p[5] + p[0] * np.exp(-square / 2))

    dark = float(np.median(part))
    start = (part.max() - dark, *opencv_moments(part), 4.0, 4.0, dark)
    try:
        fitted, _ = curve_fit(model, columns, part.ravel().astype(float), start)
    except RuntimeError:  # SciPy: no convergence
        return np.nan, np.nan
    return fitted[1] + left, fitted[2] + top


def _sep_windowed(frame: NDArray[Any]) -> tuple[float, float]:
    import sep

    light = frame.astype(np.float32)
    back = sep.Background(light)
    light -= back
    objects = sep.extract(light, 5.0, err=back.globalrms)
    if not len(objects):
        return np.nan, np.nan
    chosen = objects[[np.argmax(objects["flux"])]]
    radius, _ = sep.flux_radius(light, chosen["x"], chosen["y"], 6.0 * chosen["a"], 0.5)
    # its Gaussian's sigma, as documented
    x, y, _ = sep.winpos(light, chosen["x"], chosen["y"], radius / 1.1774)
    return float(x[0]), float(y[0])


def _skimage_region(frame: NDArray[Any]) -> tuple[float, float]:
    from skimage import measure

    labels = measure.label(frame > THRESHOLD * frame.max())
    regions = measure.regionprops(labels, intensity_image=frame)
    y, x = max(regions, key=lambda found: found.area).centroid_weighted
    return float(x), float(y)


def _photutils(name: str) -> Callable[[NDArray[Any]], tuple[float, float]]:
    def centre(frame: NDArray[Any]) -> tuple[float, float]:
        from photutils import centroids

        if name == "centroid_com":
            x, y = centroids.centroid_com(_above(frame).astype(float))
            return x, y
        part, left, top = _cut_out(frame)
        x, y = getattr(centroids, name)(part - float(np.median(part)))
        return x + left, y + top

    return centre


def _cut_out(frame: NDArray[Any]) -> tuple[NDArray[Any], int, int]:
    """Return the part about the brightest pixel, and its first column and row."""
    y, x = divmod(int(np.argmax(frame)), frame.shape[1])
    left, top = max(x - REACH, 0), max(y - REACH, 0)
    return frame[top : y + REACH + 1, left : x + REACH + 1], left, top


def _each(centre: Callable[[NDArray[Any]], tuple[float, float]]) -> Method:
    def method(frames: NDArray[Any]) -> NDArray[np.float64]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of fits that do not converge
            return np.array([centre(frame) for frame in frames])

    return method


OPENCV = "opencv threshold + moments"
PEERS: dict[str, Method] = {
    OPENCV: _each(opencv_moments),
    "scipy center_of_mass": _each(_scipy_moments),
    "scipy curve_fit gaussian": _each(_scipy_gaussian),
    "sep winpos": _each(_sep_windowed),
    "scikit-image regionprops": _each(_skimage_region),
    "photutils com, threshold": _each(_photutils("centroid_com")),
    "photutils quadratic": _each(_photutils("centroid_quadratic")),
    "photutils 1dg": _each(_photutils("centroid_1dg")),
    "photutils 2dg": _each(_photutils("centroid_2dg")),
}
