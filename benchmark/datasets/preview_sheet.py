"""Sheets that previews are drawn on: Matplotlib's figure, measured in pixels from the top left."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from algorithms.contract import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap, Normalize

INK, MUTED, RULE, SHADE = "#1a1c20", "#606670", "#d6dae0", "#e8ebf0"
#: Apart for every kind of colour vision (Okabe and Ito), dark enough on white.
LINES = (
    "#0072b2",
    "#d55e00",
    "#009e73",
    "#cc79a7",
    "#56b4e9",
    "#e69f00",
    "#5a5a5a",
    "#783c14",
)
_DPI = 100


class Sheet:
    """A white sheet of `width` by `height` pixels; positions are (x, y) from the top left."""

    def __init__(self, width: int, height: int) -> None:
        from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

        self.width, self.height = width, height
        self.figure = Figure((width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float = 13,
        *,
        colour: str = INK,
        bold: bool = False,
    ) -> None:
        """Write a line that starts at x and whose baseline is at y, in letters of `size` pixels."""
        self.figure.text(
            x / self.width,
            1.0 - y / self.height,
            text,
            size=points(size),
            color=colour,
            weight="bold" if bold else "normal",
            ha="left",
            va="baseline",
        )

    def box(self, x: float, y: float, width: float, height: float, colour: str) -> None:
        """Fill a rectangle, below everything else."""
        from matplotlib.patches import Rectangle  # noqa: PLC0415 - see `Sheet`

        corner = (x / self.width, 1.0 - (y + height) / self.height)
        size = (width / self.width, height / self.height)
        where = self.figure.transFigure
        filled = Rectangle(corner, *size, transform=where, color=colour, linewidth=0, zorder=-1)
        self.figure.add_artist(filled)

    def picture(self, x: int, y: int, values: Floats, norm: Normalize) -> None:
        """Put values (H, W) as colours, a pixel each, with their top left corner at (x, y)."""
        lower = self.height - y - len(values)
        self.figure.figimage(values, x, lower, norm=norm, cmap=heat(), origin="upper")

    def axes(self, x: float, y: float, width: float, height: float) -> Axes:
        """Add bare axes whose area has its top left corner at (x, y)."""
        axes = self.figure.add_axes(
            (
                x / self.width,
                1.0 - (y + height) / self.height,
                width / self.width,
                height / self.height,
            )
        )
        axes.tick_params(labelsize=points(12), labelcolor=MUTED, color=MUTED, length=3)
        axes.patch.set_visible(False)
        return axes

    def plot(self, x: float, y: float, width: float, height: float, *, most_y: int = 4) -> Axes:
        """Add axes with light rules at round values, at most `most_y` + 1 of them upwards."""
        from matplotlib.ticker import FuncFormatter, MaxNLocator  # noqa: PLC0415 - see `Sheet`

        axes = self.axes(x, y, width, height)
        for axis, most in ((axes.xaxis, 8), (axes.yaxis, most_y)):
            axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10]))
            axis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
        axes.tick_params(axis="y", left=False)
        axes.grid(axis="y", color=RULE, linewidth=0.8)
        axes.set_axisbelow(True)
        axes.spines[["left", "right", "top"]].set_visible(False)
        axes.spines["bottom"].set_color(MUTED)
        return axes

    def scale(self, x: float, y: float, height: float, norm: Normalize, unit: str) -> None:
        """Draw the scale of the colours, ticks to its right and the unit above."""
        from matplotlib.cm import ScalarMappable  # noqa: PLC0415 - see `Sheet`
        from matplotlib.colors import LogNorm  # noqa: PLC0415
        from matplotlib.ticker import (  # noqa: PLC0415
            FuncFormatter,
            LogLocator,
            MaxNLocator,
            NullLocator,
        )

        axes = self.axes(x, y, 14, height)
        bar = self.figure.colorbar(ScalarMappable(norm, heat()), cax=axes)
        bar.outline.set_visible(False)
        logarithmic = isinstance(norm, LogNorm)
        locator = LogLocator(subs=(1, 2, 5)) if logarithmic else MaxNLocator(5, steps=[1, 2, 5, 10])
        axes.yaxis.set_major_locator(locator)
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
        self.text(x, y - 8, unit, 12, colour=MUTED)

    def png(self) -> bytes:
        """Return the sheet as PNG."""
        written = io.BytesIO()
        # compressed as far as it goes: written once, read often; without the library's version
        self.figure.savefig(
            written,
            format="png",
            metadata={"Software": None},
            pil_kwargs={"compress_level": 9},
        )
        return written.getvalue()


def heat() -> Colormap:
    """Return colours from dark to light, evenly so for the eye; NaN is white."""
    import matplotlib as mpl  # noqa: PLC0415 - see `Sheet`

    return mpl.colormaps["inferno"].with_extremes(bad="white")


def span(values: Any) -> Normalize:
    """Return the scale from the least to the largest of some values, which may all be equal."""
    from matplotlib.colors import Normalize  # noqa: PLC0415 - see `Sheet`

    low, high = float(np.min(values)), float(np.max(values))
    return Normalize(low, max(high, low + 1e-12))


def points(pixels: float) -> float:
    """Return a size of letters in points."""
    return pixels * 72 / _DPI


def number(value: float) -> str:
    """Write a number shortly."""
    if value and not 1e-3 <= abs(value) < 1e5:
        return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{value:.6g}"
