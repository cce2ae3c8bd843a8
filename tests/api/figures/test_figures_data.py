"""What figures show, recounted from the survey's CSV files without the project's code."""

from __future__ import annotations

import itertools
import json
from collections import Counter, defaultdict
from typing import Any

import pytest

from api.figures.catalogue import LEVELS, TITLES, evidence_map, figure
from registry.studies import facts
from registry.taxonomy import InvalidValueError
from tests.api.figures.conftest import Values, read, studies_with

FLOWS = ("error", "performance", "cross-analysis", "task", "aggregate")


@pytest.mark.parametrize("name", FLOWS)
def test_every_flow_has_the_studies_with_both_values(
    name: str, values: Values, sensors: dict[str, set[tuple[str, str]]]
) -> None:
    drawn = figure(name, facts())
    links = {
        ((row["level"], row["value"]), (row["next_level"], row["next_value"])): set(row["studies"])
        for row in drawn.rows
        if row["next_level"]
    }
    expected = {}
    for one, other in itertools.pairwise(LEVELS[name]):
        pairs = {
            ((one, a), (other, b)) for of in values.values() for a in of[one] for b in of[other]
        }
        expected |= {pair: studies_with(values, sensors, *pair) for pair in pairs}
    assert links == {pair: keys for pair, keys in expected.items() if keys}
    said = [line.split() for line in drawn.text if line.startswith("Widest flow from ")]
    widest = [
        max(len(keys) for (source, _), keys in links.items() if source[0] == level)
        for level in LEVELS[name][:-1]
    ]
    assert [int(words[-2]) for words in said] == widest


def test_arcs_of_the_sunburst_hold_the_studies_of_their_models(values: Values) -> None:
    rows = figure("models", facts()).rows
    models = {row["model"]: set(row["studies"]) for row in rows if row["level"] == "model"}
    expected: dict[str, set[str]] = defaultdict(set)
    for key, of in values.items():
        for model in of["model"]:
            expected[model].add(key)
    assert models == expected
    for row in rows:
        inside = [
            r
            for r in rows
            if r["level"] == "model"
            and r["model_category"] == row["model_category"]
            and (row["level"] == "model_category" or r["calibration"] == row["calibration"])
            and row["model"] in ("", r["model"])
        ]
        assert row["memberships"] == sum(len(models[r["model"]]) for r in inside)
        assert set(row["studies"]) == set().union(*(models[r["model"]] for r in inside))
    categories = [row for row in rows if row["level"] == "model_category"]
    assert sum(row["memberships"] for row in categories) == sum(map(len, expected.values())) == 178


def test_publications_are_those_of_the_table_of_studies() -> None:
    rows = figure("publications", facts()).rows
    per_year = Counter(row["year"] for row in read("studies"))
    found: Counter[str] = Counter()
    for row in rows:
        assert row["count"] == len(row["studies"])
        if row["part"] == "year":
            found[row["value"]] += row["count"]
    assert found == per_year
    kinds = {(row["year"], row["type"]): 0 for row in read("studies")}
    for row in read("studies"):
        kinds[row["year"], row["type"]] += 1
    assert {(r["value"], r["stack"]): r["count"] for r in rows if r["part"] == "year"} == kinds
    venues: dict[str, set[str]] = defaultdict(set)
    for row in rows:
        if row["part"] == "venue":
            venues[row["value"]].update(row["studies"])
    expected: dict[str, set[str]] = defaultdict(set)
    known = {row["study"]: row["venue"] for row in read("venues")}
    for row in read("studies"):
        expected[known.get(row["key"], "")].add(row["key"])
    assert venues == expected


@pytest.mark.parametrize(
    ("rows", "columns"),
    [("detector", "mask"), ("task", "error"), ("accuracy", "model_category"), ("model", "model")],
)
def test_a_matrix_counts_the_studies_with_both_and_shows_every_gap(
    rows: str, columns: str, values: Values, sensors: dict[str, set[tuple[str, str]]]
) -> None:
    table = evidence_map(facts(), {}, rows, columns).rows
    taxonomy = facts().taxonomy
    assert len(table) == len(taxonomy.values(rows)) * len(taxonomy.values(columns))
    for row in table:
        keys = studies_with(values, sensors, (rows, row["row"]), (columns, row["column"]))
        if rows == columns:
            pair = {row["row"], row["column"]}
            keys = {key for key, of in values.items() if pair <= of[rows]}
        assert set(row["studies"]) == keys
        assert row["count"] == len(keys)


def test_an_unknown_figure_is_refused_by_naming_those_there_are() -> None:
    with pytest.raises(InvalidValueError) as caught:
        figure("errors", facts())
    assert caught.value.nearest == "error"
    assert all(name in str(caught.value) for name in TITLES)


@pytest.mark.parametrize("name", TITLES)
def test_a_filter_keeps_the_studies_that_have_the_value(name: str, values: Values) -> None:
    found = figure(name, facts(), {"detector": "Event"})
    expected = {key for key, of in values.items() if "Event" in of["detector"]}
    assert found.studies == len(expected) == 6
    assert set().union(*(row["studies"] for row in found.rows)) == expected


def _labels(data: Any) -> list[Any]:
    return [(t.get("labels"), t.get("name"), t.get("node", {}).get("label")) for t in data]


@pytest.mark.parametrize("name", TITLES)
def test_a_figure_has_sentences_and_columns_that_every_row_keeps(name: str) -> None:
    found = figure(name, facts())
    assert all(tuple(row) == found.columns for row in found.rows)
    assert all(text.endswith(".") and "None" not in text for text in found.text)
    assert '"None' not in json.dumps([found.plotly["layout"], _labels(found.plotly["data"])])
