"""What Plotly draws of a figure is what its table has; the first picture is drawn of the same."""

from __future__ import annotations

import itertools
import json
import re
from collections import Counter
from collections.abc import Mapping
from xml.etree import ElementTree as ET

import plotly.graph_objects as go
import pytest

from api.figures.catalogue import LEVELS, MATRIX, TITLES, evidence_map, figure
from api.figures.figure import Figure
from api.figures.ordering import crossings, order
from api.figures.picture import picture
from api.figures.specification import DARK, faint, on_dark, specification
from api.service.knowledge import Knowledge
from registry.studies import facts

FLOWS = ("error", "performance", "cross-analysis", "task", "aggregate")


@pytest.fixture(scope="module")
def figures(knowledge: Knowledge) -> Mapping[str, Figure]:
    return {
        **{name: figure(name, facts()) for name in TITLES},
        MATRIX: evidence_map(facts(), evidence=knowledge.evidence),
    }


@pytest.mark.parametrize("name", [*TITLES, MATRIX])
def test_plotly_takes_every_specification(name: str, figures: Mapping[str, Figure]) -> None:
    read = go.Figure(json.loads(json.dumps(figures[name].plotly)))
    assert read.data
    assert figures[name].plotly_figure().layout.title.text == figures[name].title


@pytest.mark.parametrize("name", FLOWS)
def test_a_sankey_has_the_numbers_of_the_table(name: str, figures: Mapping[str, Figure]) -> None:
    (trace,) = figures[name].plotly["data"]
    node, link = trace["node"], trace["link"]
    labels = [label.rsplit("  ", 1) for label in node["label"]]
    links = Counter(
        (labels[s][0], labels[t][0], value)
        for s, t, value in zip(link["source"], link["target"], link["value"], strict=True)
    )
    rows = [row for row in figures[name].rows if row["next_level"]]
    assert sum(row["count"] for row in rows) == sum(link["value"])
    assert len(rows) == len(link["value"])
    assert Counter(value for *_, value in links.elements()) == Counter(r["count"] for r in rows)
    linked = {(row["level"], row["value"]) for row in rows}
    linked |= {(row["next_level"], row["next_value"]) for row in rows}
    counts = [
        row["count"]
        for row in figures[name].rows
        if not row["next_level"] and (row["level"], row["value"]) in linked
    ]
    assert [int(count) for _, count in labels] == counts
    for mark, row in zip(link["customdata"], rows, strict=True):
        assert list(mark["studies"]) == row["studies"]


def test_no_nodes_of_a_sankey_meet_and_columns_stand_in_line(
    figures: Mapping[str, Figure],
) -> None:
    for name in FLOWS:
        found = figures[name].plotly
        node = found["data"][0]["node"]
        assert len(set(node["x"])) == len(LEVELS[name])
        height = found["layout"]["height"]
        for column in set(node["x"]):
            middles = sorted(y for x, y in zip(node["x"], node["y"], strict=True) if x == column)
            assert all(b - a > 14 / height for a, b in itertools.pairwise(middles))
            assert 0 < middles[0] <= middles[-1] < 1


def test_a_sunburst_has_the_memberships_of_the_table(figures: Mapping[str, Figure]) -> None:
    (trace,) = figures["models"].plotly["data"]
    drawn = dict(zip(trace["ids"], trace["values"], strict=True))
    rows = {
        " > ".join(filter(None, (r["model_category"], r["calibration"], r["model"]))): r
        for r in figures["models"].rows
    }
    assert drawn == {one: rows[one]["memberships"] for one in drawn}
    for one, value in drawn.items():
        inside = [v for other, v in drawn.items() if other.rpartition(" > ")[0] == one]
        assert not inside or sum(inside) == value


def test_bars_have_the_counts_of_the_table(figures: Mapping[str, Figure]) -> None:
    drawn = Counter[tuple[str, str]]()
    for trace in figures["publications"].plotly["data"]:
        lying = trace.get("orientation") == "h"
        value, count = ("y", "x") if lying else ("x", "y")
        for place, long in zip(trace[value], trace[count], strict=True):
            drawn["venue" if lying else "year", str(place)] += long
    table = Counter[tuple[str, str]]()
    for row in figures["publications"].rows:
        table[row["part"], row["value"]] += row["count"]
    assert all(table[place] == count for place, count in drawn.items())
    assert {one for one in table if one[0] == "year"} <= drawn.keys()
    left_out = [count for one, count in table.items() if one not in drawn and one[1]]
    assert set(left_out) == {1}


def test_a_line_of_the_coordinates_has_the_values_of_its_row(
    figures: Mapping[str, Figure],
) -> None:
    axes = ("year", "detector", "mask", "fov_deg", "accuracy_rms_deg")
    drawn = Counter[tuple[object, ...]]()
    for trace in figures["coordinates"].plotly["data"]:
        marks = trace["customdata"]
        for at in range(0, len(marks), 6):
            assert marks[at + 5] is None
            drawn[tuple(mark["value"] for mark in marks[at : at + 5])] += 1
        for at, mark in enumerate(marks):
            if mark and at % 6 == 3 and mark["value"] is not None:
                assert trace["y"][at] == pytest.approx(0.12 + 0.88 * mark["value"] / 360)
    assert drawn == Counter(tuple(r[one] for one in axes) for r in figures["coordinates"].rows)


def test_cells_of_the_matrix_have_its_counts_and_states(figures: Mapping[str, Figure]) -> None:
    states, studied = figures[MATRIX].plotly["data"]
    rows = iter(figures[MATRIX].rows)
    signs = {"measured": "•", "unknown": "?", "unstudied": "", "impossible": "×"}
    for counts, kinds, texts in zip(studied["z"], states["z"], states["text"], strict=True):
        for count, kind, text in zip(counts, kinds, texts, strict=True):
            row = next(rows)
            assert (count or 0) == row["count"]
            assert (kind is None) == bool(count)
            assert count or text == signs[row["state"]]
    assert next(rows, None) is None


@pytest.mark.parametrize("name", [*TITLES, MATRIX])
def test_a_picture_is_the_same_each_time_and_says_what_it_shows(
    name: str, figures: Mapping[str, Figure]
) -> None:
    found = figures[name]
    drawn = picture(found.plotly, found.title, found.description)
    picture.__globals__["_picture"].cache_clear()
    assert drawn == picture(found.plotly, found.title, found.description)
    root = ET.fromstring(drawn)
    space = "{http://www.w3.org/2000/svg}"
    assert root.findtext(f".//{space}desc") == found.description
    shown = {"".join(text.itertext()).strip() for text in root.iter(f"{space}text")}
    labels = {
        FLOWS: found.plotly["data"][0].get("node", {}).get("label", ()),
        (MATRIX,): found.plotly["layout"].get("yaxis", {}).get("ticktext", ()),
        ("publications",): found.plotly["data"][-1].get("y", ()),
    }
    for names, wanted in labels.items():
        if name in names:
            assert {" ".join(one.split()) for one in wanted} <= {
                " ".join(one.split()) for one in shown
            }
    # every colour of the picture is a variable, which a dark page sets to another
    assert not re.search(r"(?<![,(:])#[0-9a-f]{6}(?![;}])", drawn.split("</style>", 1)[1])


def test_a_colour_of_the_atlas_has_one_for_dark_pages_and_another_none() -> None:
    for light, dark in DARK.items():
        assert on_dark(light) == dark
        assert on_dark(faint(light, 0.3)) == faint(dark, 0.3)
    assert on_dark("#123456") == "#123456"
    made = specification([{"type": "bar", "marker": {"color": "#2f6aa8"}}], height=100)
    assert made["layout"]["meta"]["dark"]["#2f6aa8"] == DARK["#2f6aa8"]


def test_a_trace_that_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(ValueError, match="violin"):
        picture(specification([{"type": "violin"}], height=100), "No picture")


def test_nothing_left_is_said_in_the_picture() -> None:
    empty = figure("error", facts(), {"detector": "OI"})
    assert empty.plotly["data"] == []
    assert "Nothing to show." in picture(empty.plotly, empty.title)


def test_nodes_are_ordered_so_that_fewer_bands_cross() -> None:
    links = {("a", "z"): 2.0, ("b", "y"): 3.0}
    assert crossings([("a", "b"), ("y", "z")], links) == 6.0
    found = order([("a", "b"), ("y", "z")], links)
    assert crossings(found, links) == 0.0
    assert order([("a", "b"), ("y", "z")], links, pinned=(0, 1)) == (("a", "b"), ("y", "z"))
