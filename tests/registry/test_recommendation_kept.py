"""What is kept between recommendations: never much, and it changes no answer."""

from collections.abc import Callable, Mapping

import pytest
from scores import pipeline

from registry import paths
from registry.measured import Measured, Measurements, Score
from registry.recommendation import recommend
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]
STUDY = {
    "task": ["Cost"],
    "detector": ["CMOS"],
    "mask": ["Slit"],
    "model": ["SPM"],
    "extractor": ["BCTM"],
}


def test_sets_and_nodes_made_once_are_kept_but_never_many(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(paths, "_MOST_KEPT", 2)
    kept: dict[str, int] = {}
    sizes = []
    for number, name in enumerate("abcde"):
        paths._keep(kept, name, number)
        assert kept[name] == number
        sizes.append(len(kept))
    assert sizes == [1, 2, 1, 2, 1]


def test_what_was_judged_for_one_question_does_not_tell_for_another(
    facts_of: Callable[[Rows], Facts], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Answers are the same whatever was asked before, and however much is kept."""
    facts = facts_of([STUDY])
    rows: list[Measured] = [
        pipeline(hazards={"albedo": (Score("bad", 0.9),)}),
        pipeline(extractor="b"),
    ]
    asks = [{}, {"survive": ["albedo"]}, {"min_fov_deg": 30.0}, {"max_latency_us": 1.0}]
    fresh = [recommend(ask, list(rows), facts=facts).to_dict() for ask in asks]
    monkeypatch.setattr("registry.kept_answers.MOST_KEPT", 2)
    kept = Measurements(rows)
    for _ in range(2):
        assert [recommend(ask, kept, facts=facts).to_dict() for ask in asks] == fresh
