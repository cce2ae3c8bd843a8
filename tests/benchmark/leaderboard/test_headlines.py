"""Headlines of mapped studies: the table, and our number beside each."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from benchmark import datasets
from benchmark.leaderboard.headlines import (
    COLUMNS,
    Headline,
    HeadlineError,
    headlines,
    read_headlines,
)
from benchmark.results.store import PUBLISHED, Store
from survey_data.tables import load

NOMINAL = {"fake": "nominal"}


def score(**more: Any) -> dict[str, Any]:
    return {
        "dataset": "fake", "condition": "nominal", "unit": 0, "extractor": "e", "model": "m",
        "rms_deg": 0.1, "median_deg": 0.09, "p997_deg": 0.3, "repeatability_deg": 0.02,
        "bound_deg": 0.01, "availability": 0.9, **more,
    }  # fmt: skip


def headline(kind: str, statistic: str, published: float | None = 0.2) -> Headline:
    return Headline("A2000", "fake", "e", "m", published, kind, statistic, "None.")


def beside(one: Headline, *rows: dict[str, Any]) -> dict[str, Any]:
    (found,) = headlines(rows, NOMINAL, [one])
    return found


@pytest.mark.parametrize(
    ("kind", "statistic", "expected"),
    [
        ("accuracy", "rms", 0.1),
        ("accuracy", "unspecified", 0.1),
        ("accuracy", "3 sigma", 0.3),
        ("accuracy", "mean", 0.09),
        ("precision", "1 sigma", 0.02 / math.sqrt(2.0)),
    ],
)
def test_a_number_stands_beside_its_own_kind(kind: str, statistic: str, expected: float) -> None:
    found = beside(headline(kind, statistic), score())
    assert found["our_deg"] == pytest.approx(expected)
    assert found["ratio"] == pytest.approx(expected / 0.2)


def test_other_units_and_conditions_are_not_compared() -> None:
    other = score(unit=1, rms_deg=9.0), score(condition="aged", rms_deg=9.0)
    assert beside(headline("accuracy", "rms"), *other)["our_deg"] is None
    assert beside(headline("accuracy", "rms"), score(), *other)["our_deg"] == 0.1


def test_what_is_not_measured_or_not_published_has_no_ratio() -> None:
    assert beside(headline("accuracy", "rms"))["ratio"] is None
    assert beside(headline("accuracy", "rms", None), score())["ratio"] is None
    assert beside(headline("precision", "1 sigma"), score(repeatability_deg=None))["ratio"] is None


def test_every_headline_names_a_mapped_study_and_a_score_that_is_published() -> None:
    """But for a product of a mapped one's kind, and a network that nothing here stands for."""
    nominal = {name: datasets.get(name).conditions[0] for name in datasets.names()}
    found = headlines(Store(PUBLISHED).rows(), nominal)
    mapped = set(load().studies["key"])
    assert {row["study"] for row in found} - mapped == {
        "Mini-FSS (family of Boslooper2017)",
        "sparse CNN",
    }
    assert [row["study"] for row in found if row["our_deg"] is None] == ["sparse CNN"]
    assert {row["study"] for row in found if row["published_deg"] is None} == {"Boslooper2017"}


def test_published_figures_are_those_of_the_facts_where_they_have_one() -> None:
    """Independent of the table: what the mapping keeps of the study, accuracies as accuracies."""
    attributes = load().attributes
    for quantity in ("accuracy", "precision"):
        named = attributes[attributes["attribute"] == f"{quantity}_deg"]
        facts = named.set_index("study")["value"].astype(float)
        for one in read_headlines():
            if one.published_deg is None or one.study not in facts.index:
                continue
            same = [
                h.published_deg
                for h in read_headlines()
                if (h.study, h.kind) == (one.study, quantity)
            ]
            if same:
                assert any(h == pytest.approx(facts[one.study], rel=0.02) for h in same), one


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("A,d,e,m,0.1,accuracy,typical,x", "accuracy.*1"),
        ("A,d,e,m,-0.1,accuracy,rms,x", "-0.1 is no number of degrees"),
        ("A,d,e,m,tenth,accuracy,rms,x", "line 2: tenth is no number of degrees"),
        ("A,d,e,m,nan,accuracy,rms,x", "nan is no number of degrees"),
        ("A,d,e,m,0.1,accuracy,rms,", "line 2: .*differ"),
        ("A,d,e,m,0.1,accuracy,rms", "row 2, column difference"),
    ],
)
def test_a_broken_line_is_named(tmp_path: Path, line: str, said: str) -> None:
    path = tmp_path / "headlines.csv"
    path.write_text(f"{','.join(COLUMNS)}\n{line}\n", "utf-8")
    with pytest.raises(HeadlineError, match=said):
        read_headlines(path)
