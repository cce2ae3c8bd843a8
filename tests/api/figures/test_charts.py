"""Charts of pages: what is not known leaves a gap, the front is what nothing beats."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from xml.etree import ElementTree as ET

import plotly.graph_objects as go
import pytest

from api import figures
from api.figures.architectures import Point, architectures_figure, pareto_front
from api.figures.catalogue import MATRIX
from api.figures.figure import Figure
from api.figures.lines import Line, line_figure
from api.figures.picture import picture
from api.pages import compare
from tests.api.conftest import Client

#: One page of every kind that has charts.
PAGES = (
    *("/", "/?across=poses", "/datasets/cmos-single-aperture", "/algorithms/tm"),
    *("/claims/C04", "/architectures/CMOS/Encoded"),
    "/compare?architecture=CMOS:Encoded&architecture=QPD:Single-Ap.",
)


@pytest.mark.parametrize("nothing", [None, math.nan, math.inf])
def test_what_is_not_known_leaves_a_gap_in_the_line_and_its_band(nothing: float | None) -> None:
    points = [(1.0, 2.0), (2.0, 3.0), (3.0, nothing), (4.0, 1.0), (5.0, 2.0)]
    band = [(x, y, y) for x, y in points]
    band[3] = (4.0, nothing, 2.0)  # the edge that is known alone bounds nothing
    found = line_figure("one", "One line", [Line("one", points, band)], "x", "y")
    *bands, line = found.plotly["data"]
    assert [max(one["x"]) for one in bands] == [2.0, 5.0]
    assert line["y"] == [2.0, 3.0, None, 1.0, 2.0]
    assert [row["one"] for row in found.rows] == line["y"]
    assert [row["x"] for row in found.rows] == line["x"]
    drawn = picture(found.plotly, found.title)
    assert "nan" not in drawn.lower()
    assert ET.fromstring(drawn) is not None
    empty = line_figure("none", "Nothing", [Line("none", [(1.0, nothing)])], "x", "y")
    assert empty.rows == ()


def test_an_axis_is_logarithmic_where_every_value_is_positive() -> None:
    for low, kind in ((0.1, "log"), (0.0, None)):
        found = line_figure("a", "A", [Line("a", [(1.0, low), (10.0, 2.0)])], "x", "y")
        assert found.plotly["layout"]["yaxis"].get("type") == kind
        assert found.plotly["layout"]["xaxis"].get("type") is None


def test_errors_by_angle_are_drawn_in_the_middle_of_their_rings() -> None:
    rings = [
        {"inner_deg": 0.0, "outer_deg": 10.0, "rms_deg": 0.1},
        {"inner_deg": 10.0, "outer_deg": 30.0, "rms_deg": None},
        {"inner_deg": 30.0, "outer_deg": 60.0, "rms_deg": 0.4},
    ]
    found = compare._chart([{"rings": rings}, {"rings": []}], ["first", "without"])
    (line,) = found.plotly["data"]
    assert (line["name"], list(line["x"])) == ("first", [5.0, 20.0, 45.0])
    assert list(line["y"]) == [0.1, None, 0.4]


def test_no_point_beats_one_of_the_front_and_one_beats_every_other() -> None:
    places = [(60, 0.1), (90, 0.1), (120, 0.3), (30, 0.05), (120, 0.2), (360, 1.0), (90, 0.5)]
    points = [Point(str(at), "/", x, y, None) for at, (x, y) in enumerate(places)]
    front = pareto_front(points, more_is_better=True)

    def beats(a: Point, b: Point) -> bool:
        no_worse = a.across >= b.across and a.error_deg <= b.error_deg
        return no_worse and (a.across, a.error_deg) != (b.across, b.error_deg)

    for point in points:
        assert (point in front) == (not any(beats(other, point) for other in points))
    made = architectures_figure(points, "error", "field", "°", more_is_better=True)
    go.Figure(json.loads(json.dumps(made.plotly)))
    assert [row["front"] for row in made.rows] == [point in front for point in points]
    drawn = {
        (name, x, y)
        for trace in made.plotly["data"]
        for name, x, y in zip(trace.get("text", ()), trace["x"], trace["y"], strict=False)
    }
    assert drawn == {(r["architecture"], r["across"], r["error_deg"]) for r in made.rows}


@pytest.mark.parametrize(
    "path", [pytest.param(path, marks=[pytest.mark.slow] * ("/" not in path[1:])) for path in PAGES]
)
def test_every_chart_of_a_page_can_be_had_and_draws_nothing_unknown(
    atlas: Client, path: str
) -> None:
    """Of a filter in the dark nothing is known: its points stood at the picture's edge."""
    page = atlas.get(path, accept="text/html").text
    addresses = re.findall(r'data-spec="([^"]*)"', page)
    assert addresses
    for address in addresses:
        given = atlas.get(address.replace("&amp;", "&"))
        assert given.status_code == 200, address
        read = go.Figure(given.json())
        assert read.data
        drawn = atlas.get(address.replace("&amp;", "&").replace(".plotly.json", ".svg"))
        assert drawn.headers["content-type"].startswith("image/svg+xml")
        assert "nan" not in re.sub(r"<(text|desc|title)\b.*?</\1>", "", drawn.text).lower()


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: figures.flow("error", detector="CMOS"), "error"),
        (figures.models, "models"),
        (figures.publications, "publications"),
        (figures.coordinates, "coordinates"),
        (lambda: figures.matrix("task", "mask"), MATRIX),
    ],
)
def test_a_notebook_shows_every_figure_with_its_title(
    make: Callable[[], Figure], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[go.Figure] = []
    monkeypatch.setattr(go.Figure, "show", lambda figure, renderer: shown.append(figure))
    found = make()
    found.show()
    assert found.name == name
    assert [one.layout.title.text for one in shown] == [found.title]
    assert len(shown[0].data) == len(found.plotly["data"]) > 0
