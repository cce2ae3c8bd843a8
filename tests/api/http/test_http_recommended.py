"""Answers put together from pieces are the bytes of the document, whatever was asked before."""

from collections.abc import Mapping
from typing import Any

import pytest
from pydantic_core import to_json

from api.columns import RECOMMENDATIONS, csv_of
from api.http import recommended
from api.http.knowledge import Knowledge
from api.http.recommended import KeptPieces, encoded_answer
from api.http.recommended_table import table_text
from api.recommending import rows
from benchmark.assessment.regret import drawn_requirements
from registry.measured import Measurements
from registry.ranking import SORTS
from registry.recommendation import answered, recommend
from tests.api.conftest import Client

SEED = 4100


@pytest.fixture(scope="module")
def known(atlas: Client) -> Knowledge:
    return atlas.app.state.knowledge


def asked(number: int, drawn: Mapping[str, Any], known: Knowledge) -> dict[str, Any]:
    """A question of every kind: with nothing, with properties, with what nothing meets."""
    question = dict(drawn) if number % 11 else {}
    if number % 7 == 0:
        properties = list(known.facts.properties)
        question["properties"] = [properties[number % len(properties)]]
    if number % 13 == 0:
        question["max_latency_us"] = float(number + 1)
    if number % 5 == 0:
        question["bench_deg"] = (0.0, 0.003, 0.2)[number % 3]
    if number % 6 == 0:
        question |= {
            "confidence": (0.5, 0.95)[number % 4 // 2],
            "exclude_needs": ["rates", "nadir"],
        }
    if number % 17 == 0:
        question["max_error_deg"] = 1e-6
    return question


@pytest.mark.parametrize("questions", [40, pytest.param(300, marks=pytest.mark.slow)])
def test_pieces_make_the_bytes_of_the_document(known: Knowledge, questions: int) -> None:
    """The oracle is the document that `recommend` gives as objects, encoded as a whole."""
    blocked = 0
    for number, drawn in enumerate(drawn_requirements(questions, SEED, known.facts)):
        question = asked(number, drawn, known)
        shown = {"limit": (1, 5, 20, None)[number % 4], "calibrations": (1, 5, None)[number % 3]}
        sort = SORTS[number % len(SORTS)]
        found = answered(question, known.measured, sort=sort, facts=known.facts)
        told = recommend(question, known.measured, sort=sort, facts=known.facts, **shown)
        document = told.to_dict()
        blocked += document["blocked"] is not None
        assert encoded_answer(found, **shown).body == to_json(document, inf_nan_mode="null"), (
            question
        )
        assert table_text(found, **shown) == csv_of(RECOMMENDATIONS, rows(document)), question
    assert questions / 30 < blocked < questions / 2


def test_what_is_kept_is_bounded_and_changes_no_answer(
    known: Knowledge, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recommended, "MOST_BYTES", 3000)
    measured = Measurements(known.measured.rows)
    for number, drawn in enumerate(drawn_requirements(4, SEED + 1, known.facts)):
        found = answered(drawn, measured, facts=known.facts)
        told = recommend(drawn, known.measured, facts=known.facts)
        assert encoded_answer(found).body == to_json(told.to_dict(), inf_nan_mode="null"), number
    kept: KeptPieces[bytes] = KeptPieces()
    for number in range(100):
        assert kept.keep(number, b"x" * 500) == b"x" * 500
        assert kept.get(number) is not None
        assert sum(kept.get(other) is not None for other in range(100)) < 10


def test_digests_tell_answers_apart_whatever_was_asked_before(known: Knowledge) -> None:
    """Workers have been asked different things: an answer has one ETag all the same."""
    questions = list(drawn_requirements(25, SEED + 2, known.facts))
    told: dict[str, bytes] = {}
    digests = []
    for order in (questions, questions[::-1]):
        measured = Measurements(known.measured.rows)
        found = [encoded_answer(answered(q, measured, facts=known.facts), 3, 2) for q in order]
        digests.append({answer.body: answer.digest for answer in found})
        told |= {answer.digest: answer.body for answer in found}
    assert digests[0] == digests[1]
    assert len(told) == len(digests[0]) > 12


@pytest.mark.parametrize(
    ("query", "status"),
    [
        ("limit=3&limit=3", 422),
        ("task=Accuracy&task=Cost&task=Accuracy", 200),
        ("task=", 422),
        ("limit=", 422),
        ("max_error_deg=1e-1&sort=measured", 200),
        ("max_error_deg=%2B1", 422),
        ("task=Accuracy&tasks=Cost", 400),
        ("task=%ff", 400),
        ("%74ask=Accuracy", 200),
        ("format=json&format=csv", 422),
    ],
)
def test_a_query_read_straight_is_read_as_fastapi_reads_it(atlas, query, status) -> None:
    """A body of the same requirements goes through FastAPI."""
    answer = atlas.get(f"/v1/recommendations?{query}")
    assert answer.status_code == status
    if status == 200:
        body = answer.json()["requirements"]
        sort = answer.json()["sort"]
        posted = atlas.post("/v1/recommendations", json={**body, "sort": sort})
        assert posted.content == answer.content
    else:
        assert answer.json()["errors"]
