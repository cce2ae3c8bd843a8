"""The sparse network under faults: curves of the record on its page, and its plot."""

from __future__ import annotations

import json

from benchmark.results.store import PUBLISHED
from tests.api.conftest import Client


def test_answers_at_every_strength_are_a_row_of_the_csv(atlas: Client) -> None:
    rows = json.loads((PUBLISHED / "learned_faults.json").read_text("utf-8"))["faults"]
    expected = [
        (row["fault"], strength, way, sum(units) / (row["frames"] * len(units)))
        for row in sorted(rows, key=lambda row: str(row["fault"]))
        for at, strength in enumerate(row["strengths"])
        for way, units in ((way, of["answered"][at]) for way, of in row["ways"].items())
    ]
    table = atlas.table("/experiments/learned_faults")
    found = [
        (row["fault"], float(row["strength"]), row["way"], float(row["answered"])) for row in table
    ]
    assert found == expected


def test_the_page_has_the_plot_and_the_direction_leads_there(atlas: Client) -> None:
    page = atlas.get("/experiments/learned_faults", accept="text/html").text
    assert "/experiments/learned_faults/learned_faults.svg" in page
    drawn = atlas.get("/experiments/learned_faults/learned_faults.svg").text
    assert all(name in drawn for name in ("laser", "hidden holes", "glare"))
    directions = atlas.get("/directions", accept="text/html").text
    assert "/experiments/learned_faults" in directions
    assert "On cmos-encoded under 3 faults" in directions
