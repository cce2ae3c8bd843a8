"""Plotly specifications as plain dictionaries: what every figure's data and layout share.

Nothing here imports Plotly. Colours are those of light pages; `layout.meta.dark` names for each
colour of a figure the one that dark pages show instead.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

Plotly = Mapping[str, Any]
"""A figure for Plotly: `data`, a list of traces, and `layout`."""

TEXT, MUTED, SURFACE, LINE, AXIS = "#17212f", "#506073", "#ffffff", "#d5dce4", "#7b8897"
UNKNOWN = "#8a96a4"
"""Colour of what is not known."""
CATEGORIES = (
    *("#2f6aa8", "#b3610f", "#2f8058", "#a03f7c"),
    *("#7d6a12", "#6355ac", "#1f7d8c", "#a8443a"),
)
"""Colours of categories; the ninth category has the first colour again."""
SHADES = ("#e3ecf6", "#bfd4ea", "#8db2d8", "#3f74ad", "#1f4e82")
"""Shades of an amount, the least first."""
DARK: Mapping[str, str] = {
    TEXT: "#e7ecf3",
    MUTED: "#a7b4c4",
    SURFACE: "#151d29",
    LINE: "#2b3747",
    AXIS: "#718196",
    UNKNOWN: "#7b8897",
    **dict(
        zip(
            (*CATEGORIES, *SHADES),
            (
                *("#74a9e6", "#e99a4e", "#66c296", "#dd84b9"),
                *("#cdb54a", "#a79bf0", "#5bc0d0", "#ea8579"),
                *("#1d2c40", "#25405f", "#2f5885", "#7eaee0", "#b7d5f5"),
            ),
            strict=True,
        )
    ),
}
"""Colour -> what it is on a dark page."""

HOVER = "%{customdata.text}<extra></extra>"
"""`hovertemplate` of marks (`mark`): their text alone."""
_CLEAR = "rgba(0,0,0,0)"
_COLOUR = re.compile(r"#[0-9a-f]{6}|rgba\([^)]*\)")
_AXIS = re.compile(r"[xy]axis\d*")


def colour(place: int) -> str:
    """Return the colour of a category by its place among them."""
    return CATEGORIES[place % len(CATEGORIES)]


def faint(of: str, share: float) -> str:
    """Return a colour that lets 1 - `share` of what lies below through."""
    red, green, blue = (int(of[at : at + 2], 16) for at in (1, 3, 5))
    return f"rgba({red},{green},{blue},{share:g})"


def scale(shades: Sequence[str] = SHADES) -> list[list[Any]]:
    """Return shades as a `colorscale`."""
    return [[at / (len(shades) - 1), shade] for at, shade in enumerate(shades)]


def mark(text: str, href: str | None = None, **more: Any) -> dict[str, Any]:
    """Return the `customdata` of a mark.

    Parameters
    ----------
    text : said where the mark is pointed at or focused
    href : where it leads; None for nowhere
    more : `studies`, keys of the studies behind it, and `narrow`, attribute -> values that a click
        asks for, of nodes and links of a flow
    """
    return {"text": text, **({"href": href} if href else {}), **more}


def axis(title: str = "", **more: Any) -> dict[str, Any]:
    """Return an axis with a title; `more` as `layout.xaxis` has it, such as `type="log"`."""
    return {"title": {"text": title, "font": {"size": 13}}, **more}


def legend(y: float = 1.0) -> dict[str, Any]:
    """Return a legend in a row, above a plot whose upper end is at `y` of the figure's height."""
    place = {"x": 0, "xanchor": "left", "y": y, "yanchor": "bottom"}
    return {"orientation": "h", "traceorder": "normal", **place}


def specification(
    data: Sequence[Mapping[str, Any]],
    *,
    height: int,
    narrowest: int = 340,
    picture: int = 1000,
    **layout: Any,
) -> Plotly:
    """Return a figure for Plotly, in the atlas's colours and letters.

    Parameters
    ----------
    data : traces; those of types scatter, bar, heatmap, sankey and sunburst can be drawn as a
        first picture
    height : px
    narrowest : width in px below which the page scrolls the figure sideways
    picture : width in px for which the first picture is laid out; a page scales it
    layout : further members of the layout; axes get the colours of the others
    """
    shared = {"gridcolor": LINE, "linecolor": AXIS, "zeroline": False, "automargin": True}
    shared |= {"exponentformat": "none", "minorloglabels": "complete"}
    layout |= {name: {**shared, **of} for name, of in layout.items() if _AXIS.fullmatch(name)}
    whole: dict[str, Any] = {
        "height": height,
        "font": {"color": TEXT, "size": 13},
        "paper_bgcolor": _CLEAR,
        "plot_bgcolor": _CLEAR,
        "margin": {"l": 8, "r": 8, "t": 36, "b": 8},
        "legend": legend(),
        "modebar": {"bgcolor": _CLEAR, "color": AXIS, "activecolor": TEXT},
        "hoverlabel": {"bgcolor": SURFACE, "bordercolor": AXIS, "font": {"color": TEXT}},
        **layout,
    }
    drawn = _COLOUR.findall(json.dumps([list(data), whole]))
    widths = {"narrowest": narrowest, "picture": picture}
    whole["meta"] = {**widths, "dark": {one: on_dark(one) for one in set(drawn)}}
    whole["meta"]["dark"] = dict(sorted(whole["meta"]["dark"].items()))
    return {"data": list(data), "layout": whole}


def on_dark(light: str) -> str:
    """Return what a colour is on a dark page; the same for one that is not of the atlas."""
    if light.startswith("#"):
        return DARK.get(light, light)
    *rgb, share = light.removeprefix("rgba(").removesuffix(")").split(",")
    solid = "#" + "".join(f"{int(part):02x}" for part in rgb)
    return faint(DARK[solid], float(share)) if solid in DARK else light
