"""Published numbers beside ours: every one, like beside like, the farthest apart first."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, cast

import pandas as pd
import pytest

from api.service.knowledge import Knowledge
from benchmark.datasets import study_names
from benchmark.leaderboard.headlines import (
    FILE,
    Headline,
    headlines,
    read_differences,
)
from benchmark.results.store import PUBLISHED, PUBLISHED_STUDIES
from registry.resolution import Resolution
from registry.studies import Study
from survey_data.reported import Quantity, reported_accuracies
from survey_data.tables import load


def score(**more: Any) -> dict[str, Any]:
    return {
        "rms_deg": 0.1, "median_deg": 0.09, "p95_deg": 0.2, "p997_deg": 0.3, "max_deg": 0.5,
        "repeatability_deg": 0.02, "availability": 0.9, **more,
    }  # fmt: skip


def study(key: str, published: Mapping[tuple[Quantity, str], float]) -> Study:
    """A study that publishes these numbers by quantity and kind."""
    found = {q: reported_accuracies(q, value, kind) for (q, kind), value in published.items()}
    return cast("Study", SimpleNamespace(key=key, report=found.get))


def resolution(*settings: tuple[str, str]) -> Resolution:
    """What runs on these data sets and conditions, a pipeline each."""
    runs = [
        SimpleNamespace(
            extractor="e",
            model="m",
            settings=(SimpleNamespace(dataset=dataset, condition=condition),),
        )
        for dataset, condition in settings
    ]
    return cast("Resolution", SimpleNamespace(strongest_pipelines=runs))


def beside(quantity: Quantity, kind: str, published: float = 0.2, **more: Any) -> Headline:
    (found,) = headlines(
        {("fake", "hot", "e", "m"): score(**more)},
        [study("A2000", {(quantity, kind): published})],
        {"A2000": resolution(("fake", "hot"), ("fake", "nominal"))},
        {},
    )
    return found


@pytest.mark.parametrize(
    ("quantity", "kind", "expected"),
    [
        ("accuracy", "rms", 0.1),
        ("accuracy", "1sigma", 0.1),
        ("accuracy", "unspecified", 0.1),
        ("accuracy", "3sigma", 0.3),
        ("accuracy", "p95", 0.2),
        ("accuracy", "max", 0.5),
        ("accuracy", "mean", 0.09),
        ("precision", "1sigma", 0.02 / math.sqrt(2.0)),
    ],
)
def test_a_number_stands_beside_its_own_kind(
    quantity: Quantity, kind: str, expected: float
) -> None:
    found = beside(quantity, kind)
    assert found.our_deg == pytest.approx(expected)
    assert found.ratio == pytest.approx(expected / 0.2)
    assert found.place == ("fake", "hot", "e", "m"), "of the conditions measured, the study's own"


@pytest.fixture(scope="module")
def published() -> Sequence[Headline]:
    known = Knowledge()
    scores = known.measurements.score_of
    return headlines(scores, known.facts.studies.values(), known.resolutions)


def test_every_published_number_of_the_mapping_is_there(published: Sequence[Headline]) -> None:
    """Independent of the table: what the facts keep of each study."""
    attributes = load().attributes
    for quantity in ("accuracy", "precision"):
        facts = attributes[attributes["attribute"] == f"{quantity}_deg"].set_index("study")["value"]
        found = {row.study: row for row in published if row.published.quantity == quantity}
        assert {key: row.published.value_deg for key, row in found.items()} == {
            key: float(value) for key, value in facts.items()
        }


def test_ours_are_those_of_the_published_scores(published: Sequence[Headline]) -> None:
    """Independent of the store: the files, read by pandas."""
    for row in published:
        if row.published.quantity != "accuracy" or row.place is None:
            continue
        dataset, condition, extractor, model = row.place
        record = PUBLISHED_STUDIES if dataset in study_names() else PUBLISHED
        scores = pd.read_csv(record / "scores" / f"{dataset}.csv")
        same = (scores[["condition", "extractor", "model"]] == [condition, extractor, model]).all(
            axis=1
        )
        kinds = {"3sigma": "p997_deg", "p95": "p95_deg", "max": "max_deg", "mean": "median_deg"}
        column = kinds.get(row.published.statistic.kind, "rms_deg")
        assert scores[same & (scores["unit"] == 0)][column].tolist() == [row.our_deg]


def test_the_farthest_apart_come_first(published: Sequence[Headline]) -> None:
    distances = [row.distance for row in published]
    assert distances == sorted(distances, reverse=True)


def test_a_difference_is_said_of_a_number_that_is_there(published: Sequence[Headline]) -> None:
    there = {(row.study, row.published.quantity) for row in published}
    assert set(read_differences()) <= there
    assert all(read_differences().values())
    assert len(pd.read_csv(FILE)) == len(read_differences())
