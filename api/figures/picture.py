"""The first picture of a figure: its Plotly specification drawn by Matplotlib.

Drawn are traces of types scatter, bar, heatmap (`api.figures.plots`), sankey and sunburst
(`api.figures.shapes`). A page shows the picture as an image; with `#dark` behind its address it has
the colours of a dark page. As PNG it fits a slide.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from api.figures.specification import TEXT, on_dark
from benchmark.plot_style import plain_style, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FONT = "'DejaVu Sans', sans-serif"
_PAINT = re.compile(r"(?:fill|stroke|stop-color): #[0-9a-f]{6}")
_DOTS_PER_INCH = 180
"""Of the PNG: 2,500 px for a figure of 1,000."""


def picture(plotly: Mapping[str, Any], title: str, description: str = "") -> str:
    """Return the picture of a specification as SVG, the same for the same specification.

    Parameters
    ----------
    plotly : as `api.figures.specification.specification` makes it
    title, description : what the SVG says of itself

    Raises
    ------
    ValueError
        For a trace of a type that cannot be drawn.
    """
    return _picture(json.dumps(plotly), title, description)


def png(plotly: Mapping[str, Any]) -> bytes:
    """Return the picture of a specification as PNG on white."""
    return _png(json.dumps(plotly))


@lru_cache(64)
def _png(text: str) -> bytes:
    written = io.BytesIO()
    with plain_style():
        _figure(json.loads(text)).savefig(written, dpi=_DOTS_PER_INCH, facecolor="white")
    return written.getvalue()


@lru_cache(256)
def _picture(text: str, title: str, description: str) -> str:
    plotly = json.loads(text)
    drawn = svg(lambda: _figure(plotly), title)
    # Colours stand beside what they paint, as programs for slides do not know variables; these, in
    # turn, are inherited by what is drawn again and again (use), which knows nothing above it.
    painted = sorted(set(_PAINT.findall(drawn)))
    dark = {one[-7:]: on_dark(one[-7:]) for one in painted}
    style = "".join(
        f'[style*="{one}"]{{{one[:-7]}var(--c{one[-6:]},{one[-7:]})!important}}' for one in painted
    )
    style += f"svg:target{{{''.join(f'--c{one[1:]}:{shown};' for one, shown in dark.items())}}}"
    drawn = drawn.replace("</defs>", f"</defs>\n<desc>{_escape(description)}</desc>", 1)
    drawn = drawn.replace(_FONT, "system-ui, 'Liberation Sans', Arial, sans-serif")
    return drawn.replace("<svg ", '<svg id="dark" ', 1).replace(
        '<style type="text/css">', f'<style type="text/css">{style}', 1
    )


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _figure(plotly: Mapping[str, Any]) -> Figure:
    """Return the specification as a figure of Matplotlib's, a point for each pixel."""
    from matplotlib import rcParams  # noqa: PLC0415 - half a second that only pictures need
    from matplotlib.figure import Figure  # noqa: PLC0415 - likewise

    from api.figures import plots, shapes  # noqa: PLC0415 - likewise

    rcParams.update({"font.size": 12, "text.color": TEXT, "axes.labelcolor": TEXT})  # of a context
    layout = plotly["layout"]
    size = (layout["meta"]["picture"] / 72, layout["height"] / 72)
    figure = Figure(figsize=size, dpi=72)
    figure.patch.set_visible(False)
    kinds = {trace["type"] for trace in plotly["data"]}
    if not kinds:
        figure.text(0.01, 0.9, "Nothing to show.", va="top")
    elif kinds <= plots.TYPES:
        plots.draw(figure, plotly)
    elif len(kinds) == 1 and kinds <= shapes.TYPES.keys():
        shapes.TYPES[kinds.pop()](figure, plotly)
    else:
        raise ValueError(f"a picture of {', '.join(sorted(kinds))} cannot be drawn")
    return figure
