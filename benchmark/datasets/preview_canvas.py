"""Drawing for previews: a white sheet with text, lines, bars and axes, written as PNG by OpenCV."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Colour = tuple[int, int, int]  # red, green, blue
Image = NDArray[np.uint8]  # (H, W, 3) in that order

INK: Colour = (26, 28, 32)
MUTED: Colour = (96, 102, 112)
RULE: Colour = (214, 218, 224)
PAPER: Colour = (255, 255, 255)
SHADE: Colour = (232, 235, 240)
#: Apart for every kind of colour vision (Okabe and Ito), dark enough on white.
LINES: tuple[Colour, ...] = (
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (230, 159, 0),
    (90, 90, 90),
    (120, 60, 20),
)
#: Dark to light, evenly so for the eye (anchors of Matplotlib's inferno).
_HEAT = (
    (0, 0, 4),
    (31, 12, 72),
    (85, 15, 109),
    (136, 34, 106),
    (186, 54, 85),
    (227, 89, 51),
    (249, 140, 10),
    (249, 201, 50),
    (252, 255, 164),
)


class Canvas:
    """A white sheet of `width` by `height` pixels; positions are (x, y) from the top left."""

    def __init__(self, width: int, height: int) -> None:
        self.image: Image = np.full((height, width, 3), 255, dtype=np.uint8)

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float = 13,
        *,
        colour: Colour = INK,
        align: str = "left",
        bold: bool = False,
    ) -> None:
        """Write a line whose baseline is at y; `align` says what of it x is: left, middle, right.

        Letters are `size` pixels from one line to the next.
        """
        import cv2  # noqa: PLC0415 - a large library that only pictures need

        scale, weight = size / 28.0, 2 if bold else 1
        font = cv2.FONT_HERSHEY_SIMPLEX
        (width, _), _ = cv2.getTextSize(text, font, scale, weight)
        left = x - {"left": 0.0, "middle": 0.5, "right": 1.0}[align] * width
        place = (round(left), round(y))
        cv2.putText(self.image, text, place, font, scale, colour, weight, cv2.LINE_AA)

    def line(self, points: Sequence[tuple[float, float]], colour: Colour, width: int = 1) -> None:
        """Draw a line through points; it breaks where a coordinate is not finite."""
        import cv2  # noqa: PLC0415 - see `text`

        run: list[tuple[int, int]] = []
        for x, y in (*points, (math.nan, math.nan)):
            if math.isfinite(x) and math.isfinite(y):
                run.append((round(8 * x), round(8 * y)))  # eighths of a pixel: smooth slopes
                continue
            if len(run) > 1:
                path = np.array(run, dtype=np.int32).reshape(-1, 1, 2)
                cv2.polylines(self.image, [path], False, colour, width, cv2.LINE_AA, 3)
            run = []

    def box(self, x: float, y: float, width: float, height: float, colour: Colour) -> None:
        """Fill a rectangle, at least one pixel each way."""
        left, top = round(x), round(y)
        right, bottom = max(left + 1, round(x + width)), max(top + 1, round(y + height))
        self.image[max(top, 0) : bottom, max(left, 0) : right] = colour

    def picture(self, x: int, y: int, picture: Image) -> None:
        """Put a picture (H, W, 3) with its top left corner at (x, y)."""
        height, width = picture.shape[:2]
        self.image[y : y + height, x : x + width] = picture

    def scale(
        self,
        x: float,
        y: float,
        height: float,
        span: tuple[float, float],
        unit: str,
        *,
        logarithmic: bool = False,
    ) -> None:
        """Draw the scale of `heat`: colours over a span of values with ticks to their right."""
        width = 14
        low, high = span
        ramp = np.linspace(1.0, 0.0, round(height))[:, None].repeat(width, axis=1)
        self.picture(round(x), round(y), heat(ramp))
        for tick in decades(low, high) if logarithmic else ticks(low, high, 5):
            if logarithmic:
                at = y + height * math.log(high / tick) / math.log(high / low)
            else:
                at = y + height * (high - tick) / (high - low)
            self.line([(x + width, at), (x + width + 4, at)], MUTED)
            self.text(x + width + 7, at + 4, number(tick), 12, colour=MUTED)
        self.text(x, y - 8, unit, 12, colour=MUTED)

    def png(self) -> bytes:
        """Return the sheet as PNG."""
        import cv2  # noqa: PLC0415 - see `text`

        # Compressed as far as it goes: written once, read often.
        options = [cv2.IMWRITE_PNG_COMPRESSION, 9]
        done, encoded = cv2.imencode(".png", self.image[:, :, ::-1], options)
        if not done:
            raise RuntimeError("OpenCV could not encode the preview as PNG")
        return bytes(encoded.tobytes())


class Plot:
    """Axes on a canvas: x from `left` to `right`, y from `low` to `high`, ticks and light rules.

    Parameters
    ----------
    canvas
        To draw on.
    place
        (x, y, width, height) of the area between the axes, in pixels.
    across, up
        (first, last) value at the area's edges.
    x_ticks
        Whether to write the values along x.
    """

    def __init__(
        self,
        canvas: Canvas,
        place: tuple[float, float, float, float],
        across: tuple[float, float],
        up: tuple[float, float],
        *,
        x_ticks: bool = True,
        most_y: int = 4,
    ) -> None:
        self.canvas, self.place, self.across, self.up = canvas, place, across, up
        x, y, width, height = place
        for tick in ticks(*up, most_y):
            at = self.y(tick)
            canvas.line([(x, at), (x + width, at)], RULE)
            canvas.text(x - 6, at + 4, number(tick), 12, colour=MUTED, align="right")
        for tick in ticks(*across, 8) if x_ticks else ():
            at = self.x(tick)
            canvas.line([(at, y + height), (at, y + height + 4)], MUTED)
            canvas.text(at, y + height + 17, number(tick), 12, colour=MUTED, align="middle")
        canvas.line([(x, y + height), (x + width, y + height)], MUTED)

    def x(self, value: float) -> float:
        """Return where a value of x is, in pixels."""
        first, last = self.across
        return self.place[0] + self.place[2] * (value - first) / (last - first)

    def y(self, value: float) -> float:
        """Return where a value of y is, in pixels."""
        low, high = self.up
        return self.place[1] + self.place[3] * (high - value) / (high - low)

    def curve(self, x: NDArray[Any], y: NDArray[Any], colour: Colour, width: int = 1) -> None:
        """Draw y (N,) over x (N,)."""
        pairs = zip(x.tolist(), y.tolist(), strict=True)
        self.canvas.line([(self.x(a), self.y(b)) for a, b in pairs], colour, width)


def heat(values: NDArray[Any]) -> Image:
    """Colour values in [0, 1], (H, W), from dark to light; NaN is white."""
    anchors = np.array(_HEAT, dtype=np.float64)
    at = np.linspace(0.0, 1.0, len(anchors))
    plain = np.clip(np.nan_to_num(values, nan=0.0), 0.0, 1.0)
    image = np.stack([np.interp(plain, at, anchors[:, k]) for k in range(3)], axis=-1)
    image[np.isnan(values)] = 255.0
    return np.asarray(np.round(image), dtype=np.uint8)


def ticks(low: float, high: float, most: int) -> list[float]:
    """Round values between `low` and `high`, at most `most` + 1: steps of 1, 2 or 5."""
    span = high - low
    if not (math.isfinite(span) and span > 0):
        return [low]
    rough = span / most
    base = 10.0 ** math.floor(math.log10(rough))
    step = next(base * k for k in (1.0, 2.0, 5.0, 10.0) if base * k >= rough * (1 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]


def decades(low: float, high: float) -> list[float]:
    """Round values between two positive ones: 1, 2 and 5 of every power of ten."""
    powers = range(math.floor(math.log10(low)), math.floor(math.log10(high)) + 1)
    return [k * 10.0**p for p in powers for k in (1.0, 2.0, 5.0) if low <= k * 10.0**p <= high]


def number(value: float) -> str:
    """Write a number shortly."""
    if value and not 1e-3 <= abs(value) < 1e5:
        return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{value:.6g}"
