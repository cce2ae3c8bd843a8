"""What Plotly draws of a figure is what its table has; the first picture is drawn of the same."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping
from importlib.resources import files
from xml.etree import ElementTree as ET

import plotly.graph_objects as go
import pytest

from api.figures import plots, shapes
from api.figures.catalogue import MATRIX, TITLES, evidence_map, figure
from api.figures.figure import Figure
from api.figures.picture import picture
from api.figures.sankey import crossings, order
from api.figures.specification import specification
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
    # a dark page has another for every colour, which programs without variables read, too
    dark, plain = drawn.split("</style>", 1)
    assert "var(" not in plain
    painted = set(re.findall(r"[a-z-]+: #[0-9a-f]{6}", plain))
    assert painted
    assert painted == set(re.findall(r'\[style\*="([^"]*)"\]', dark))
    assert len(re.findall(r"#[0-9a-f]{6}", plain)) == len(re.findall(r": #[0-9a-f]{6}", plain))


def test_a_trace_that_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(ValueError, match="violin"):
        picture(specification([{"type": "violin"}], height=100), "No picture")


def test_nodes_are_ordered_so_that_fewer_bands_cross() -> None:
    links = {("a", "z"): 2.0, ("b", "y"): 3.0}
    assert crossings([("a", "b"), ("y", "z")], links) == 6.0
    found = order([("a", "b"), ("y", "z")], links)
    assert crossings(found, links) == 0.0
    assert order([("a", "b"), ("y", "z")], links, pinned=(0, 1)) == (("a", "b"), ("y", "z"))


def test_plotly_has_every_kind_of_trace_that_a_picture_has() -> None:
    library = (files("api") / "static" / "plotly.min.js").read_text(encoding="utf-8")
    there = set(re.findall(r'moduleType:"trace",name:"([a-z]+)"', library))
    assert there == plots.TYPES | shapes.TYPES.keys()
