"""Loops of the extractors beside OpenCV's: ``python docs/decisions/opencv.py``.

Prints the table of ``opencv.md``: the least processor time of several turns on one thread, and how
far results are apart. Frames are drawn with fixed seeds.
"""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Iterator
from typing import Any

import cv2
import matplotlib.image
import numpy as np
from numpy.typing import NDArray

from algorithms.extractors.frames.cameras import dark_holes_kernel
from algorithms.extractors.frames.cameras.hough import HoughCircle, HoughLines
from algorithms.extractors.frames.mirror import search_kernel
from algorithms.extractors.frames.multi_spot import correlation_kernel, spots_kernel
from algorithms.extractors.frames.multi_spot.records import Seen
from algorithms.kernels import moments
from benchmark.synthetic_features.frames import REFERENCE_SETS

Frames = NDArray[Any]
#: What is timed, on what: ours, OpenCV's, and how their results differ.
Case = tuple[str, str, Callable[[], Any], Callable[[], Any], Callable[[Any, Any], str]]
_TURNS, _CUT = 7, 0.3


def apart(what: str) -> Callable[[Any, Any], str]:
    """Compare results by their largest difference."""

    def compare(ours: Any, theirs: Any) -> str:
        far = np.abs(np.asarray(ours, float) - np.asarray(theirs, float)).max()
        return "same bits" if far == 0.0 else f"{what} {far:.1e}"

    return compare


def nearest(ours: Any, theirs: Any) -> str:
    """Compare spots (N, S, 2), which stand in another order, by the distance to the nearest."""
    away = np.linalg.norm(ours[:, :, None] - theirs[:, None], axis=3)
    return f"px {away.min(axis=2).max():.1e}"


def errors(centres: Any, axes: slice) -> Callable[[Any, Any], str]:
    """Compare results by their errors, root mean square, px."""

    def rms(found: Any) -> str:
        error = np.asarray(found)[:, axes] - np.asarray(centres)[:, axes]
        answered = np.isfinite(error).all(axis=1)
        return f"{np.sqrt(np.mean(error[answered] ** 2)):.3f} px ({answered.mean():.0%})"

    return lambda ours, theirs: f"error {rms(ours)}, OpenCV {rms(theirs)}"


def thresholded(frames: Frames) -> Iterator[Case]:
    """First moments of the light above a part of the maximum."""

    def ours() -> Any:
        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        level, sums = _CUT * maxima.max(axis=1), np.empty((len(frames), 6))
        moments.moments_above(frames, maxima, level, moments.whole_frame(frames), sums)
        return sums[:, 1:3] / sums[:, :1]

    def theirs() -> Any:
        found = np.empty((len(frames), 2))
        for k, frame in enumerate(frames):
            level = _CUT * cv2.minMaxLoc(frame)[1]
            light = cv2.subtract(frame.astype(np.float64), level)
            m = cv2.moments(cv2.threshold(light, 0.0, 0.0, cv2.THRESH_TOZERO)[1])
            found[k] = m["m10"] / m["m00"], m["m01"] / m["m00"]
        return found

    def integers() -> Any:
        found = np.empty((len(frames), 2))
        for k, frame in enumerate(frames):
            level = _CUT * cv2.minMaxLoc(frame)[1]
            m = cv2.moments(cv2.threshold(frame, level, 0, cv2.THRESH_TOZERO)[1])
            found[k] = m["m10"] / m["m00"], m["m01"] / m["m00"]
        return found

    size = f"{len(frames)} frames of {frames.shape[1]} px"
    yield "moments: cv2.moments", size, ours, theirs, apart("px")
    yield "moments: cv2.moments, level left in", size, ours, integers, apart("px")


def grids() -> Frames:
    """Frames of 5 x 5 discs."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[:118, :118]
    frames = np.full((60, 118, 118), 20.0)
    for frame, (dx, dy) in zip(frames, rng.uniform(-2, 2, (60, 2)), strict=True):
        for i in range(5):
            for j in range(5):
                away = np.hypot(x - 25 - 17 * i - dx, y - 25 - 17 * j - dy)
                np.add(frame, 2000 * np.clip(4.5 - away, 0, 1), out=frame)
    return np.clip(rng.normal(frames, 10), 0, 4095).astype(np.uint16)


def components(frames: Frames) -> Case:
    """Light-weighted centres of connected pixels above a level."""
    level = 600.0

    def ours() -> Any:
        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        spots, cuts = np.zeros((len(frames), 64, 4)), np.zeros((len(frames), 8, 3))
        counts, cut_counts = np.zeros((2, len(frames)), dtype=np.int64)
        levels = np.full(len(frames), level)
        seen = Seen(spots, counts, cuts, cut_counts)
        spots_kernel.segment(frames, maxima, levels, 4.0, 400.0, seen)
        return spots[:, :25, :2]

    def theirs() -> Any:
        found = np.empty((len(frames), 25, 2))
        rows, columns = (place.ravel() for place in np.indices(frames.shape[1:]))
        for k, frame in enumerate(frames):
            lit = (frame > level).astype(np.uint8)
            number, labels, _, _ = cv2.connectedComponentsWithStats(lit, connectivity=8)
            light, at = np.maximum(frame - level, 0.0).ravel(), labels.ravel()
            total = np.bincount(at, light, number)[1:]
            found[k, :, 0] = np.bincount(at, light * columns, number)[1:] / total
            found[k, :, 1] = np.bincount(at, light * rows, number)[1:] / total
        return found

    name = "components: cv2.connectedComponentsWithStats, np.bincount"
    return name, f"{len(frames)} frames of 118 px, 25 spots", ours, theirs, nearest


def erosion(frames: Frames) -> Case:
    """Least of every 2 x 2 pixels, with the rows' largest."""
    count, height, width = frames.shape
    flat = frames.reshape(count, height * width)
    square = np.ones((2, 2), dtype=np.uint8)

    def ours() -> Any:
        least = np.empty((count, height - 1, width), dtype=frames.dtype)
        largest = np.empty((count, height - 1), dtype=frames.dtype)
        for k in range(count):
            search_kernel._erode(flat[k], width, least[k], largest[k])
        return largest

    def theirs() -> Any:
        largest = np.empty((count, height - 1), dtype=frames.dtype)
        for k, frame in enumerate(frames):
            largest[k] = cv2.erode(frame, square, anchor=(0, 0))[:-1, :-1].max(axis=1)
        return largest

    name = "morphology: cv2.erode, rows' maxima by NumPy"
    return name, f"{count} frames of {height} px", ours, theirs, apart("light")


def blur(frames: Frames) -> Case:
    """Convolution with a Gaussian of 1.5 px along both axes."""
    taps = cv2.getGaussianKernel(11, 1.5).ravel()

    def ours() -> Any:
        out = np.empty(frames.shape)
        rows = np.empty(frames.shape[1:])
        for k, frame in enumerate(frames):
            dark_holes_kernel.blur(frame, taps, rows, out[k])
        return out

    def theirs() -> Any:
        edge = cv2.BORDER_REPLICATE
        return np.array(
            [cv2.sepFilter2D(one, cv2.CV_64F, taps, taps, borderType=edge) for one in frames]
        )

    size = f"{len(frames)} frames of {frames.shape[1]} px"
    return "blur: cv2.sepFilter2D", size, ours, theirs, apart("light")


def correlation() -> Case:
    """Correlation of windows of 25 px with templates of 15 px."""
    rng = np.random.default_rng(4)
    windows, template = rng.uniform(0, 2000, (400, 25, 25)), rng.normal(0, 1, (15, 15))

    def ours() -> Any:
        out = np.empty((400, 11, 11))
        for window, one in zip(windows, out, strict=True):
            correlation_kernel._correlate(window, template, one)
        return out

    def theirs() -> Any:
        small = template.astype(np.float32)
        return np.array(
            [cv2.matchTemplate(one.astype(np.float32), small, cv2.TM_CCORR) for one in windows]
        )

    def compare(a: Any, b: Any) -> str:
        return f"relative {np.abs(a - b).max() / np.abs(a).max():.1e}"

    return "correlation: cv2.matchTemplate", "400 windows of 25 px", ours, theirs, compare


def circles() -> Case:
    """Centres of discs by the circle Hough transform."""
    frames, centres = REFERENCE_SETS["disc"].frames(200)

    def theirs() -> Any:
        found = np.full((len(frames), 2), np.nan)
        for k, frame in enumerate(frames):
            shades = cv2.normalize(frame, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)  # type: ignore[call-overload]
            circle = cv2.HoughCircles(
                shades, cv2.HOUGH_GRADIENT_ALT, 1, 64, param1=300, param2=0.8, minRadius=2
            )
            if circle is not None:
                found[k] = circle[0, 0, :2]
        return found

    name, size = "circles: cv2.HoughCircles (8 bits)", "200 frames of 64 px"
    both = slice(0, 2)
    return name, size, lambda: HoughCircle().extract(frames), theirs, errors(centres, both)


def lines() -> Case:
    """Place across of the blooming line of a saturated Sun."""
    rng = np.random.default_rng(5)
    y, x = np.mgrid[:200, :240]
    centres = rng.uniform(80, 120, (40, 2))
    frames = np.empty((40, 200, 240), dtype=np.uint16)
    for frame, (a, b) in zip(frames, centres, strict=True):
        light = 15000 / (1 + ((x - a) ** 2 + (y - b) ** 2) / 4) ** 1.5
        light[(abs(x - a) <= 1.5) & (abs(y - b) <= 60)] = 4095
        frame[:] = np.clip(rng.normal(light, 8), 0, 4095)

    def ours() -> Any:
        return HoughLines(tilt_deg=0.0).lines(frames)[:, :1]

    def theirs() -> Any:
        found = np.full((len(frames), 1), np.nan)
        for k, frame in enumerate(frames):
            full = (frame > 0.8 * 4095).astype(np.uint8)
            line = cv2.HoughLines(full, 0.25, np.pi / 2, 20)
            if line is not None:
                found[k] = line[0, 0, 0]
        return found

    name, size = "lines: cv2.HoughLines (of two angles)", "40 frames of 200 x 240 px"
    return name, size, ours, theirs, errors(centres[:, :1], slice(0, 1))


def reading() -> Case:
    """Pixels of a PNG; ours is Matplotlib's reader."""
    rng = np.random.default_rng(6)
    image = rng.integers(0, 255, (600, 800, 3), dtype=np.uint8)
    png = cv2.imencode(".png", image)[1].tobytes()

    def ours() -> Any:
        return (matplotlib.image.imread(io.BytesIO(png), format="png") * 255).round()

    def theirs() -> Any:
        shown = cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_COLOR)
        return shown[:, :, ::-1]

    return "reading: cv2.imdecode", "one PNG of 600 x 800 px", ours, theirs, apart("shades")


def cases() -> Iterator[Case]:
    """Everything that is measured."""
    disc, large = REFERENCE_SETS["disc"].frames(1000)[0], REFERENCE_SETS["disc-512"].frames(40)[0]
    yield from thresholded(disc)
    yield from thresholded(large)
    yield components(grids())
    yield erosion(disc)
    yield erosion(large)
    yield blur(large)
    yield correlation()
    yield circles()
    yield lines()
    yield reading()


def main() -> None:
    """Print the table."""
    cv2.setNumThreads(1)
    print(f"OpenCV {cv2.__version__}\n")
    print("| what | on | ours, ms | OpenCV, ms | OpenCV / ours | results |")
    print("| --- | --- | ---: | ---: | ---: | --- |")
    for name, size, ours, theirs, compare in cases():
        results = ours(), theirs()
        best = [np.inf, np.inf]
        for _ in range(_TURNS):
            for side, call in enumerate((ours, theirs)):
                begin = time.process_time()
                call()
                best[side] = min(best[side], 1e3 * (time.process_time() - begin))
        agreement = compare(*results)
        cells = [name, size, *(f"{ms:.2f}" for ms in (*best, best[1] / best[0])), agreement]
        print("|", " | ".join(cells), "|")


if __name__ == "__main__":
    main()
