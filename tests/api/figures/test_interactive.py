"""The figures for Plotly: the numbers of their tables, read back by Plotly itself."""

from __future__ import annotations

import functools
import json
from collections import Counter

import plotly.io
import pytest

from api.figures.catalogue import MATRIX, TITLES, evidence_map, figure
from api.figures.interactive import specification
from registry.studies import facts


@pytest.fixture(scope="module")
def drawn(knowledge):
    """Draws a figure by its name."""

    @functools.cache
    def draw(name):
        if name == MATRIX:
            return evidence_map(facts(), evidence=knowledge.evidence)
        return figure(name, facts())

    return draw


@pytest.mark.parametrize("name", [*TITLES, MATRIX])
def test_plotly_reads_every_figure_back_and_it_is_the_same_each_time(name, drawn):
    text = specification(drawn(name))
    read = plotly.io.from_json(text)
    assert read.data
    assert read.layout.title.text == drawn(name).title
    drawn.cache_clear()
    assert text == specification(drawn(name))


@pytest.mark.parametrize("name", ["error", "performance", "cross-analysis", "task", "aggregate"])
def test_flows_into_a_node_are_those_of_the_table(name, drawn):
    found = drawn(name)
    (trace,) = json.loads(specification(found))["data"]
    values, counted = Counter(), Counter()
    for target, value in zip(trace["link"]["target"], trace["link"]["value"], strict=True):
        values[target] += value
    nodes = [(row["level"], row["value"]) for row in found.rows if not row["next_level"]]
    for row in found.rows:
        if row["next_level"]:
            counted[nodes.index((row["next_level"], row["next_value"]))] += row["count"]
    assert values == counted
    assert len(trace["node"]["label"]) == len(nodes)


@pytest.mark.parametrize("name", ["error", "models", MATRIX])
def test_the_page_gives_it_under_its_own_name(atlas, name, drawn):
    answer = atlas.get(f"/figures/{name}.plotly.json")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/json"
    assert answer.json() == json.loads(specification(drawn(name)))
    page = atlas.get(f"/figures/{name}", headers={"accept": "text/html"})
    assert f"/figures/{name}.plotly.json" in page.text
    fewer = atlas.get(f"/figures/{name}.plotly.json?detector=CCD").json()
    assert fewer != answer.json()
