"""What other libraries offer for the centre of one spot, as their users call it.

Each peer takes frames (N, H, W) and returns centres (N, 2). The libraries are the extra `peers`,
installed by `make bench` only; one that is missing is named instead.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

Method = Callable[[NDArray[Any]], Floats]

THRESHOLD = 0.3
#: Half side of the cut-out about the brightest pixel that fits are given, px, where no other is.
REACH = 24
#: Evaluations of the elliptical profile, slopes counted, after which its fit is given up.
_EVALUATIONS = 600

#: Libraries that need not be there, by what is imported.
_LIBRARIES = {
    "photutils": "photutils.centroids",
    "sep": "sep",
    "scikit-image": "skimage.measure",
}


def opencv_loop(frames: NDArray[Any]) -> Floats:
    """Return the moments (N, 2) of the pixels above a fraction of the maximum, by OpenCV."""
    found = np.empty((len(frames), 2))
    for k, frame in enumerate(frames):
        _, largest, _, _ = cv2.minMaxLoc(frame)
        _, above = cv2.threshold(frame, THRESHOLD * largest, 0, cv2.THRESH_TOZERO)
        m = cv2.moments(above)
        found[k] = m["m10"] / m["m00"], m["m01"] / m["m00"]
    return found


def peers(reach: int = REACH) -> tuple[dict[str, Method], list[str]]:
    """Return the peers by name, and the names of the libraries that are not installed.

    Fits are given the pixels up to `reach` from the brightest one.
    """
    found: dict[str, Method] = {
        "scipy center_of_mass": _scipy_moments,
        "scipy curve_fit gaussian": partial(scipy_gaussian, reach=reach),
        "scipy curve_fit ellipse": partial(scipy_ellipse, reach=reach),
    }
    missing = []
    for library, module in _LIBRARIES.items():
        try:
            imported = importlib.import_module(module)
        except ImportError:
            missing.append(library)
            continue
        found |= _MAKERS[library](imported, reach)
    return found, missing


def _photutils(centroids: Any, reach: int) -> dict[str, Method]:
    def above(frame: NDArray[Any]) -> Floats:
        return np.asarray(np.where(frame > THRESHOLD * frame.max(), frame, 0), dtype=np.float64)

    def dark(frame: NDArray[Any]) -> Floats:
        return frame - float(np.median(frame))

    return {
        "photutils centroid_com": _each(centroids.centroid_com, dark),
        "photutils com, threshold": _each(centroids.centroid_com, above),
        "photutils centroid_quadratic": _each(centroids.centroid_quadratic, dark),
        "photutils centroid_1dg": _each(centroids.centroid_1dg, dark, reach=reach),
        "photutils centroid_2dg": _each(centroids.centroid_2dg, dark, reach=reach),
    }


def _sep(sep: Any, _: int) -> dict[str, Method]:
    def extract(frame: NDArray[Any]) -> tuple[float, float]:
        light = frame.astype(np.float32)
        back = sep.Background(light)
        objects = sep.extract(light - back, 5.0, err=back.globalrms)
        if not len(objects):
            return np.nan, np.nan
        brightest = objects[np.argmax(objects["flux"])]
        return float(brightest["x"]), float(brightest["y"])

    def windowed(frame: NDArray[Any]) -> tuple[float, float]:
        light = frame.astype(np.float32)
        back = sep.Background(light)
        light -= back
        objects = sep.extract(light, 5.0, err=back.globalrms)
        if not len(objects):
            return np.nan, np.nan
        chosen = objects[[np.argmax(objects["flux"])]]
        at = chosen["x"], chosen["y"]
        radius, _ = sep.flux_radius(light, *at, 6.0 * chosen["a"], 0.5)
        x, y, _ = sep.winpos(light, *at, radius / 1.1774)  # its Gaussian's sigma, as documented
        return float(x[0]), float(y[0])

    return {"sep extract": _each(extract), "sep winpos": _each(windowed)}


def _skimage(measure: Any, _: int) -> dict[str, Method]:
    def region(frame: NDArray[Any]) -> tuple[float, float]:
        labels = measure.label(frame > THRESHOLD * frame.max())
        regions = measure.regionprops(labels, intensity_image=frame)
        if not regions:
            return np.nan, np.nan
        y, x = max(regions, key=lambda found: found.area).centroid_weighted
        return float(x), float(y)

    return {"scikit-image regionprops": _each(region)}


_MAKERS: dict[str, Callable[[Any, int], dict[str, Method]]] = {
    "photutils": _photutils,
    "sep": _sep,
    "scikit-image": _skimage,
}


def _scipy_moments(frames: NDArray[Any]) -> Floats:
    """Return the centres (N, 2) of mass above a fraction of the maximum, by SciPy."""
    from scipy.ndimage import center_of_mass

    found = np.empty((len(frames), 2))
    for k, frame in enumerate(frames):
        y, x = center_of_mass(np.where(frame > THRESHOLD * frame.max(), frame, 0))
        found[k] = x, y
    return found


def scipy_gaussian(frames: NDArray[Any], reach: int = REACH) -> Floats:
    """Return the centres (N, 2) of Gaussians fitted to cut-outs by SciPy's `curve_fit`."""
    from scipy.optimize import curve_fit

    found = np.empty((len(frames), 2))
    for k, frame in enumerate(frames):
        part, left, top = _cut_out(frame, reach)
        rows, columns = (axis.ravel().astype(np.float64) for axis in np.indices(part.shape))

        def model(_: object, *p: float, rows: Any = rows, columns: Any = columns) -> Floats:
            across = np.exp(-(((columns - p[1]) / p[3]) ** 2) / 2)
            along = np.exp(-(((rows - p[2]) / p[4]) ** 2) / 2)
            return np.asarray(p[5] + p[0] * across * along, dtype=np.float64)

        dark, peak = float(np.median(part)), float(part.max())
        [(x, y)] = opencv_loop(part[None])
        start = (peak - dark, float(x), float(y), 4.0, 4.0, dark)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of covariances that cannot be determined
                fitted, _ = curve_fit(model, columns, part.ravel().astype(np.float64), start)
        except RuntimeError:  # SciPy: no convergence
            found[k] = np.nan
        else:
            found[k] = fitted[1] + left, fitted[2] + top
    return found


def scipy_ellipse(frames: NDArray[Any], reach: int = REACH) -> Floats:
    """Return the centres (N, 2) of general elliptical profiles fitted by SciPy's `curve_fit`.

    ``b + a exp(-q^p / 2)`` with q a quadratic form about the centre: a Gaussian for p = 1, a disc
    for p large. Fitted from the second moments of the light above the threshold.
    """
    from scipy.optimize import curve_fit

    found = np.full((len(frames), 2), np.nan)
    for k, frame in enumerate(frames):
        part, left, top = _cut_out(frame, reach)
        rows, columns = (axis.ravel().astype(np.float64) for axis in np.indices(part.shape))

        def model(_: object, *p: float, rows: Any = rows, columns: Any = columns) -> Floats:
            u = p[2] * (columns - p[0]) + p[3] * (rows - p[1])
            v = p[4] * (rows - p[1])
            with np.errstate(over="ignore"):
                q = (u * u + v * v + 1e-12) ** np.exp(np.clip(p[5], -2.0, 4.0))
            return np.asarray(p[7] + p[6] * np.exp(-q / 2.0), dtype=np.float64)

        dark, peak = float(np.median(part)), float(part.max())
        above = np.where(part > THRESHOLD * peak, part, 0).astype(np.float64)
        m = cv2.moments(above)
        light = max(m["m00"], 1.0)
        # of a disc the second moment is a quarter of the radius squared
        xx, xy, yy = (m[name] / light for name in ("mu20", "mu11", "mu02"))
        form = np.linalg.inv(3.0 * np.array([[xx, xy], [xy, yy]]) + 0.1 * np.eye(2))
        factor = np.linalg.cholesky(form)
        start = (
            *(m["m10"] / light, m["m01"] / light),
            *(factor[0, 0], factor[1, 0], factor[1, 1]),
            *(1.0, peak - dark, dark),
        )
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of covariances that cannot be determined
                fitted, _ = curve_fit(
                    model, columns, part.ravel().astype(np.float64), start, maxfev=_EVALUATIONS
                )
        except RuntimeError:  # SciPy: no convergence
            continue
        found[k] = fitted[0] + left, fitted[1] + top
    return found


def _cut_out(frame: NDArray[Any], reach: int) -> tuple[NDArray[Any], int, int]:
    """Return the part about the brightest pixel, and its first column and row."""
    y, x = divmod(int(np.argmax(frame)), frame.shape[1])
    left, top = max(x - reach, 0), max(y - reach, 0)
    return np.ascontiguousarray(frame[top : y + reach + 1, left : x + reach + 1]), left, top


def _each(
    centre: Callable[[Any], Any],
    prepare: Callable[[NDArray[Any]], NDArray[Any]] | None = None,
    *,
    reach: int | None = None,
) -> Method:
    """Return a method that calls a peer frame by frame, on a cut-out if it has a reach."""

    def method(frames: NDArray[Any]) -> Floats:
        found = np.empty((len(frames), 2))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of fits that do not converge
            for k, frame in enumerate(frames):
                part, left, top = (frame, 0, 0) if reach is None else _cut_out(frame, reach)
                x, y = centre(part if prepare is None else prepare(part))
                found[k] = x + left, y + top
        return found

    return method
