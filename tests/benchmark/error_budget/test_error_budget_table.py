"""The table of what holds pipelines back: of every data set, current, and said in words."""

import pytest

from benchmark.error_budget import sentences
from benchmark.error_budget.record import RECORD
from benchmark.error_budget.variants import VARIANTS
from benchmark.experiments.error_budget import ErrorBudget, leaders
from benchmark.results.store import Store

SCORE = {
    "dataset": "ccd-slit",
    "condition": "nominal",
    "extractor": "ppe",
    "model": "slit",
    "rms_deg": 0.05,
    "bound_deg": 0.004,
    "bound_unit_deg": 0.005,
    "answered": 400,
    "judged": 400,
}


def _row(**errors):
    """Return a row whose chain as it is errs by 0.05; what is not given changes nothing."""
    known = {f"{name}_deg": 0.05 for name in VARIANTS}
    given = {f"{name}_deg": error for name, error in errors.items()}
    return {**SCORE, **known, "surroundings_deg": None, **given}


def test_every_data_set_of_the_leaderboard_has_a_row_of_the_score_that_leads_it():
    leading = ErrorBudget().leader_rows
    assert leading.keys() == {row["dataset"] for row in Store().rows()}
    assert RECORD.read().keys() == leading.keys()


def test_whatever_is_not_near_its_bound_has_a_sentence_with_its_measurement():
    for name, row in RECORD.read().items():
        found = sentences.verdict(row)
        assert name in found.sentence
        assert sentences.degrees(row["rms_deg"]) in found.sentence
        bound = row["bound_unit_deg"] or row["bound_deg"]
        assert found.is_near_bound == (row["rms_deg"] <= 2.0 * bound)
        if not found.is_near_bound:
            named = sentences.PARTS[found.leading_part] in found.sentence
            assert named or found.leading_part == "noise"
            assert found.parts_deg[found.leading_part] == max(found.parts_deg.values())


def test_errors_of_independent_parts_add_as_squares():
    parts = sentences.contributions(
        _row(references=0.03, noise=0.04, perfect=0.005, perfect_dense=0.003, places_dense=0.0)
    )
    assert parts["references"] == pytest.approx(0.04)
    assert parts["noise"] == pytest.approx(0.03)
    assert parts["poses"] == pytest.approx(0.004)
    assert parts["extractor"] == pytest.approx(0.003)
    assert parts["model"] == 0.0
    assert parts["lamp"] == 0.0
    assert "surroundings" not in parts


@pytest.mark.parametrize(
    ("errors", "part", "said"),
    [
        (
            {"references": 0.006, "perfect": 0.004, "perfect_dense": 0.004, "places_dense": 0.001},
            "references",
            ("0.0060 deg (1.2 times)",),
        ),
        (
            {"perfect": 0.045, "perfect_dense": 0.04, "places": 0.02, "places_dense": 0.01},
            "extractor",
            ("0.045 deg (9.0 times)", "0.020 deg"),
        ),
        (
            {"perfect": 0.04, "perfect_dense": 0.039, "places": 0.041, "places_dense": 0.039},
            "model",
            ("0.040 deg (8.0 times)", "0.041 deg (8.2 times)"),
        ),
        (
            {"perfect": 0.04, "perfect_dense": 0.003, "places": None, "places_dense": None},
            "poses",
            ("0.040 deg (8.0 times)", "0.0030 deg"),
        ),
        (
            {"perfect": 0.04, "perfect_dense": 0.039, "places": None, "places_dense": None},
            "method",
            ("0.040 deg (8.0 times)", "0.039 deg"),
        ),
        (
            {"noise": 0.03, "perfect": 0.001, "perfect_dense": 0.001, "places_dense": 0.0},
            "noise",
            ("0.030 deg (6.0 times)", "8.0 times"),
        ),
    ],
)
def test_the_part_that_contributes_most_is_named_with_what_was_measured(errors, part, said):
    found = sentences.verdict(_row(**errors))
    assert found.leading_part == part
    assert sentences.PARTS[part] in found.sentence or part == "noise"
    for numbers in ("0.050 deg, 10 times", *said):
        assert numbers in found.sentence


def test_what_is_near_its_bound_has_no_leading_part():
    found = sentences.verdict(_row() | {"rms_deg": 0.006})
    assert found.is_near_bound
    assert "0.0060 deg, 1.2 times" in found.sentence
    assert not any(name in found.sentence for name in sentences.PARTS.values())


def test_the_leader_is_chosen_over_its_units():
    plain = {"dataset": "d", "condition": "c", "extractor": "e", "availability": 1.0}

    def scored(model, *errors):
        return [
            {**plain, "model": model, "unit": unit, "rms_deg": error, "rms_all_answers_deg": error}
            for unit, error in enumerate(errors)
        ]

    rows = [*scored("lucky", 1.0, 9.0), *scored("steady", 2.0, 2.0), *scored("once", 4.0)]
    assert leaders(rows, {"d": "c"})["d"]["model"] == "steady"
    assert leaders(rows, {"d": "c"})["d"]["rms_deg"] == 2.0
    assert leaders(rows, {"d": "other"}) == {}
