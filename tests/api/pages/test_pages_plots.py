"""Drawn lines: what is not known leaves a gap, and is nowhere drawn as something."""

from __future__ import annotations

import math
import re

import pytest

from api.pages.plots.line_chart import Line, LineChart
from tests.api.conftest import Client

#: Places in a drawing: coordinates, radii and paths.
_PLACES = re.compile(r'\b(?:d|x|y|cx|cy|x1|x2|y1|y2|width|height|points|transform)="([^"]*)"')


@pytest.mark.parametrize("nothing", [None, math.nan, math.inf])
def test_what_is_not_known_leaves_a_gap_in_the_line_and_its_band(nothing: float | None) -> None:
    points = [(1.0, 2.0), (2.0, 3.0), (3.0, nothing), (4.0, 1.0), (5.0, 2.0)]
    band = [(x, y, y) for x, y in points]
    band[3] = (4.0, nothing, 2.0)  # the edge that is known alone bounds nothing
    line = Line("one", points, band)
    drawn = LineChart([line], "x", "y", "one line", log_up=False).__html__()
    assert "nan" not in " ".join(_PLACES.findall(drawn)).lower()
    assert drawn.count('class="line ') == 2
    assert drawn.count('class="band ') == 2
    assert drawn.count('class="dot ') == 4
    assert line.at(3.0) is None
    assert not LineChart([Line("none", [(1.0, nothing)])], "x", "y", "nothing").has_points


def test_no_claim_draws_what_was_not_measured(atlas: Client) -> None:
    """Of a filter in the dark nothing is known: its points stood at the picture's edge."""
    for claim in atlas.get("/v1/claims").json()["items"]:
        page = atlas.get(f"/claims/{claim['id']}", accept="text/html").text
        for drawing in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
            assert "nan" not in " ".join(_PLACES.findall(drawing)).lower(), claim["id"]
