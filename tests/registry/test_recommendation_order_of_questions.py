"""An answer is the same whatever was asked before it."""

from collections.abc import Callable, Mapping

import pytest
from scores import STUDY, pipeline

from benchmark.assessment.regret import drawn_requirements
from registry.answer_json import answer_digest, answer_json
from registry.measured_pipelines import MeasuredPipeline, Measurements, Score
from registry.recommendation import answer, recommend
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]


def test_what_was_judged_for_one_question_does_not_tell_for_another(
    facts_of: Callable[[Rows], Facts], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Answers are the same whatever was asked before, and however little is kept."""
    facts = facts_of([STUDY, {**STUDY, "detector": ["CCD"]}, {**STUDY, "error": ["Electrical"]}])
    rows: list[MeasuredPipeline] = [
        pipeline(hazards={"albedo": (Score("bad", 0.9),)}),
        pipeline(extractor="b"),
    ]
    asks: list[dict[str, object]] = [
        *({}, {"survive": ["albedo"]}, {"min_fov_deg": 30.0}, {"max_latency_us": 1.0}),
        *({"exclude_error": ["Electrical"]}, {"exclude_detector": ["CCD"]}, {"task": ["Cost"]}),
        *({"max_error_deg": 0.5}, {"max_error_deg": 0.6}, {"confidence": 0.6, "bench_deg": 0.1}),
    ]
    fresh = [recommend(ask, list(rows), facts=facts).document for ask in asks]
    for name in (
        *("pipelines.MOST_ERRORS", "design_arrays.MOST_BEST", "design_arrays.MOST_COUNTED"),
        *("answer_json.MOST_TEXTS", "answer_json.MOST_ARCHITECTURES", "texts.paths.MOST_TEXTS"),
        *("texts.calibrations.MOST_TEXTS", "texts.calibrations.MOST_PIPELINES"),
    ):
        monkeypatch.setattr(f"registry.{name}", 2)
    kept = Measurements(rows)
    for _ in range(2):
        assert [recommend(ask, kept, facts=facts).document for ask in asks] == fresh


def test_digests_tell_answers_apart(survey: Facts) -> None:
    """Two processes have been asked different things: an answer has one digest all the same."""
    questions = [dict(drawn) for drawn in drawn_requirements(60, 4102, survey)]
    digests = []
    for order in (questions, questions[::-1]):
        rows = Measurements()
        found = [answer(question, rows, facts=survey) for question in order]
        digests.append({answer_digest(one): answer_json(one) for one in found})
    assert digests[0] == digests[1]
    assert len(digests[0]) > 30
