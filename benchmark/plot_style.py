"""Matplotlib for pictures that are the same wherever they are drawn."""

from __future__ import annotations

import hashlib
import io
import re
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ONE = threading.Lock()
#: The same numbers give the same bytes: no identifiers at random, text left to the reader's fonts.
_STYLE = {
    "svg.hashsalt": "sun-sensor-atlas",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.sans-serif": "DejaVu Sans",
    "path.simplify": False,
}
_FONT = "font-family: 'DejaVu Sans', sans-serif; "


@contextmanager
def plain_style(**settings: Any) -> Iterator[None]:
    """Draw by Matplotlib's own defaults, whatever a user has set, and by what is given here.

    One picture at a time: the library's settings are those of the whole process.
    """
    from matplotlib import style  # noqa: PLC0415 - a second that only pictures need

    with _ONE, style.context(["default", settings]):
        yield


def svg(draw: Callable[[], Figure], about: str) -> str:
    """Draw a figure as SVG of few bytes, the same for the same numbers; `about` is its title."""
    written = io.StringIO()
    with plain_style(**_STYLE):
        metadata = {"Title": about, "Date": None, "Creator": None}
        draw().savefig(written, format="svg", metadata=metadata)
    return _compact(written.getvalue())


def _compact(svg: str) -> str:
    """Leave out of an SVG what draws nothing: indents, names and empty groups, turns by nothing.

    Numbers keep two digits, a hundredth of a point: rounding that differs between machines is not
    a change of the picture.
    """
    svg = svg[svg.index("<svg") :]  # no prolog that refers to a definition elsewhere
    svg = re.sub(r' transform="rotate\(-?0 [^)]*\)"', "", svg)
    svg = re.sub(r'\n *<g id="[^"]*"/>', "", svg)
    svg = re.sub(r'<g id="[^"]*">', "<g>", svg)
    # once, where all text finds it
    svg = svg.replace(_FONT, "").replace("<g>", f'<g style="{_FONT.strip("; ")}">', 1)
    svg = re.sub(r"<[^>]*>", lambda tag: _few_digits(tag[0]), svg)  # not in texts
    svg = _named_by_place(svg)
    return "".join(f"{line.strip()}\n" for line in svg.splitlines())


def _few_digits(tag: str) -> str:
    return re.sub(r"-?\d+\.\d{3,}", lambda found: f"{float(found[0]) + 0.0:z.2f}", tag)


def _named_by_place(svg: str) -> str:
    """Name what is defined by its place among definitions and by the title.

    Matplotlib names it by a digest of all digits of its numbers, and the last ones differ between
    processors. The title keeps names apart where a page holds several pictures.
    """
    of = hashlib.sha256(svg[svg.index("<title") : svg.index("</title")].encode()).hexdigest()[:6]
    names = dict.fromkeys(re.findall(r'id="([A-Za-z][0-9a-f]{10})"', svg))
    for number, name in enumerate(names):
        svg = re.sub(rf"(?<=[\"#]){name}(?=[\")])", f"{name[0]}{of}-{number}", svg)
    return svg
