"""Charts on pages: each line goes through the numbers of the record, at their places."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import pytest

from api.pages import algorithm, claim, dataset
from api.pages.boards import best_of, field_line
from api.service.claims import claim as claim_document
from api.service.knowledge import Knowledge
from benchmark.metrics.rings import RINGS
from tests.api.conftest import Client

DATASET = "cmos-single-aperture"


@pytest.fixture(scope="module")
def known(atlas: Client) -> Knowledge:
    found: Knowledge = atlas.app.state.knowledge
    return found


def through(figure: Any) -> dict[str, list[tuple[Any, Any]]]:
    """Points of each line, by its name; bands left out."""
    return {
        one["name"]: list(zip(one["x"], one["y"], strict=True))
        for one in figure.plotly["data"]
        if one.get("fill") is None
    }


def test_learning_curves_have_the_middle_of_their_draws_at_the_number_of_poses(
    known: Knowledge,
) -> None:
    rows = [row for row in known.measurements.curves if row["dataset"] == DATASET]
    drawn = through(dataset._curve(known, DATASET))
    assert len(rows) > 1
    assert drawn == {
        f"{row['extractor']} + {row['model']}": [
            (point["poses"], point["middle_deg"]) for point in row["points"]
        ]
        for row in rows
    }


def test_errors_over_the_field_stand_in_the_middle_of_their_rings(known: Knowledge) -> None:
    row = next(r for r in known.measurements.board_rows(DATASET) if r["condition"] == "nominal")
    line = field_line(row, "best")
    middles = {ring.column: (ring.inner_deg + ring.outer_deg) / 2.0 for ring in RINGS}
    wanted = [(at, row[column]) for column, at in middles.items() if row[column] is not None]
    assert len(wanted) > 2
    assert [point for point in line.points if point[1] is not None] == wanted
    assert line.points[-1] == wanted[-1]


def test_sweeps_of_an_extractor_have_its_error_and_bound(known: Knowledge) -> None:
    wanted = defaultdict(list)
    for row in known.measurements.sweeps:
        if row["extractor"] == "bctm" and row["sweep"] == "noise" and row["value"] is not None:
            wanted[row["series"]].append(row)
    charts = dict(algorithm._sweep(known, "bctm"))
    for series, rows in wanted.items():
        (figure,) = (
            figure
            for title, figure in charts.items()
            if title.endswith(f": {series}") and figure.name.startswith("noise")
        )
        drawn = through(figure)
        for name, column in (("error", "rms"), ("bound", "bound")):
            assert drawn[name] == [(row["value"], row[column]) for row in rows]


def test_a_claim_is_drawn_through_the_medians_of_its_trials(known: Knowledge) -> None:
    document: Any = claim_document(known, "C04").document
    lines = document["lines"]
    assert through(claim._chart(document)) == {
        name: list(zip(line["x"], line["median"], strict=True)) for name, line in lines.items()
    }


def test_the_best_place_of_an_algorithm_is_its_smallest_rank(known: Knowledge) -> None:
    ranks = defaultdict(dict)
    for name in known.measurements.presets:
        for row in known.measurements.board_rows(name):
            first = known.measurements.presets[name].conditions[0]
            if row["condition"] == first and row["rank"] is not None:
                place = ranks[row["extractor"]]
                place[name] = min(row["rank"], place.get(name, row["rank"]))
    best = best_of(known)
    for name, of in ranks.items():
        assert best[name]["rank"] == min(of.values())
        assert of[best[name]["dataset"]] == best[name]["rank"]
        assert best[name]["boards"] == len(of)
