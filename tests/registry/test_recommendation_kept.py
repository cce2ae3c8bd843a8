"""What is kept between recommendations: never much, and it changes no answer."""

from collections.abc import Callable, Mapping

import pytest
from scores import pipeline

from registry import paths
from registry.designs import design_table
from registry.measured import Measured, Measurements, Score
from registry.ranked_designs import RankedPlace, kept_places
from registry.ranking import Sort
from registry.recommendation import answered, recommend
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


def test_an_architecture_is_ranked_once_for_all_questions_that_leave_it_the_same(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = facts_of([STUDY, {**STUDY, "detector": ["CCD"]}, {**STUDY, "error": ["Electrical"]}])
    rows = Measurements([pipeline(), pipeline(extractor="b", extractor_taxonomy="BCM")])

    def place(sort: Sort = "advice", **asked: object) -> RankedPlace:
        found = answered(asked, rows, sort=sort, facts=facts).ranked.places
        return next(place for place in found if place.place.architecture[0] == "CMOS")

    first = place()
    assert place(exclude_detector="CCD") is place(exclude_task="Accuracy") is first
    assert place(max_error_deg=180.0).designs.tolist() == first.designs.tolist()
    others = (
        place("measured"),
        place(task="Cost"),  # advised or not for that alone
        place(exclude_error="Electrical"),  # one study less
        place(exclude_extractor="BCTM"),  # a calibration less
        place(min_availability=0.5),  # judged by what keeps it
    )
    assert first not in others
    assert others[2].studies == first.studies & ~0b100


def test_ranked_architectures_that_are_kept_are_never_many(
    facts_of: Callable[[Rows], Facts], monkeypatch: pytest.MonkeyPatch
) -> None:
    facts = facts_of([STUDY, {**STUDY, "detector": ["CCD"]}, {**STUDY, "detector": ["PSD"]}])
    monkeypatch.setattr("registry.ranked_designs.MOST_PLACES", 2)
    monkeypatch.setattr("registry.path_columns.MOST_SETS", 2)
    measured = Measurements([pipeline(), pipeline(extractor="b")])
    for ask in ({}, {"exclude_detector": ["CCD"]}, {"task": ["Cost"]}, {}):
        told = recommend(ask, measured, facts=facts).to_dict()
        assert told == recommend(ask, list(measured.rows), facts=facts).to_dict()
        assert len(kept_places(design_table(facts, measured))) <= 2
