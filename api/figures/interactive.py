"""The figures as Plotly has them: to zoom, hover and restyle in a notebook or another page.

`plotly.io.from_json` takes what `specification` gives. The pages draw their own and load no chart
library; these are for who wants one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from api.figures import coordinates, matrix, publications, sunburst
from api.figures.figure import Figure, Row
from api.figures.wording import display_name

if TYPE_CHECKING:
    import plotly.graph_objects as go

_NOT_KNOWN = "not known"


def specification(figure: Figure) -> str:
    """Return a figure as Plotly's JSON, the same for the same figure."""
    text = plotly_figure(figure).to_json(pretty=False)
    return str(text)


def plotly_figure(figure: Figure) -> go.Figure:
    """Return a figure of Plotly's with the numbers of the table: its rows are all that is drawn."""
    import plotly.graph_objects as go  # noqa: PLC0415 - a second to load, for who asks alone

    trace = _OTHERS.get(figure.name, _sankey)(figure.rows)
    # No template: the default one is 7 kB of colours that a reader's own replaces.
    layout = {"title": {"text": figure.title}, "template": None, **_LAYOUTS.get(figure.name, {})}
    return go.Figure(data=trace, layout=layout)


def _sankey(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    nodes = [row for row in rows if not row["next_level"]]
    place = {(row["level"], row["value"]): at for at, row in enumerate(nodes)}
    links = [row for row in rows if row["next_level"]]
    return [
        {
            "type": "sankey",
            "node": {
                "label": [display_name(row["level"], row["value"]) for row in nodes],
                "customdata": [row["name"] for row in nodes],
                "hovertemplate": "%{customdata}: %{value}<extra></extra>",
            },
            "link": {
                "source": [place[row["level"], row["value"]] for row in links],
                "target": [place[row["next_level"], row["next_value"]] for row in links],
                "value": [row["count"] for row in links],
            },
        }
    ]


def _sunburst(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    rings = ("model_category", "calibration", "model")
    paths = [tuple(row[ring] for ring in rings if row[ring]) for row in rows]
    return [
        {
            "type": "sunburst",
            "ids": ["/".join(path) for path in paths],
            "parents": ["/".join(path[:-1]) for path in paths],
            "labels": [row["model"] or row["name"] for row in rows],
            "values": [row["memberships"] for row in rows],
            "branchvalues": "total",
            "hovertext": [f"{row['name']}: {row['count']} studies" for row in rows],
            "hoverinfo": "text",
        }
    ]


def _bars(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    traces = []
    for part, axes in (("year", ("x", "y")), ("venue", ("x2", "y2"))):
        of_part = [row for row in rows if row["part"] == part]
        for stack in dict.fromkeys(row["stack"] for row in of_part):
            bars = [row for row in of_part if row["stack"] == stack]
            traces.append(
                {
                    "type": "bar",
                    "name": stack,
                    "x": [row["value"] or _NOT_KNOWN for row in bars],
                    "y": [row["count"] for row in bars],
                    "xaxis": axes[0],
                    "yaxis": axes[1],
                }
            )
    return traces


def _categories(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    of = {"year": "Year", "detector": "Detector", "mask": "Mask", "accuracy": "Accuracy class"}
    return [
        {
            "type": "parcats",
            "dimensions": [
                {
                    "label": label,
                    "values": [_NOT_KNOWN if row[c] is None else str(row[c]) for row in rows],
                }
                for c, label in of.items()
            ],
        }
    ]


def _heatmap(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    across = list(dict.fromkeys(row["column"] for row in rows))
    down = list(dict.fromkeys(row["row"] for row in rows))
    states = {(row["row"], row["column"]): row["state"] for row in rows}
    counts = {
        (row["row"], row["column"]): None if row["state"] == "impossible" else row["count"]
        for row in rows
    }
    return [
        {
            "type": "heatmap",
            "x": across,
            "y": down,
            # an impossible pair has no cell, another that no study has a zero
            "z": [[counts[row, column] for column in across] for row in down],
            "text": [[states[row, column] for column in across] for row in down],
            "hoverongaps": False,
        }
    ]


_OTHERS: Mapping[str, Callable[[tuple[Row, ...]], list[dict[str, Any]]]] = {
    sunburst.NAME: _sunburst,
    publications.NAME: _bars,
    coordinates.NAME: _categories,
    matrix.NAME: _heatmap,
}
_LAYOUTS: Mapping[str, Mapping[str, Any]] = {
    publications.NAME: {
        "barmode": "stack",
        "grid": {"rows": 2, "columns": 1, "pattern": "independent"},
        "xaxis": {"type": "category", "title": {"text": "Year"}},
        "xaxis2": {"type": "category", "title": {"text": "Venue"}},
    },
    matrix.NAME: {"yaxis": {"autorange": "reversed"}},
}
