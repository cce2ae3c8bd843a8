"""Where measurement contradicts what studies used or the survey advises, and by how much."""

import re
from collections.abc import Callable, Mapping

import pytest
from scores import STUDY, pipeline

from registry.recommendation import Architecture, Recommendation, recommend
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]
#: On an architecture that is advised for accuracy.
ADVISED = pipeline(mask="Encoded", rms_deg=0.02)


def only(answer: Recommendation) -> Architecture:
    (architecture,) = answer.architectures
    return architecture


def test_the_best_calibration_is_shown_where_no_study_used_it(
    facts_of: Callable[[Rows], Facts],
) -> None:
    """Two studies used one calibration; one that no study used errs less."""
    facts = facts_of([STUDY, STUDY])
    rows = [pipeline(), pipeline(model="lut", stages=("LUT",), rms_deg=0.02)]
    place = only(recommend({}, rows, facts=facts))
    assert [(c.model, c.studies) for c in place.calibrations] == [
        ("LUT", ()),
        ("SPM", ("S0", "S1")),
    ]
    assert place.best.model == "LUT"
    said = place.contradiction or ""
    assert re.search(r"^2 .*\bbctm \+ spm\b.* 0\.1 deg\b.* 0\.02\b", said)
    assert said.endswith("5 times smaller")
    first = recommend({}, rows, sort="support", facts=facts).regret
    assert first is not None
    assert first["ratio"] == 5.0
    assert "5 times smaller" in str(first["sentence"])
    turned = only(recommend({}, rows, sort="support", facts=facts))
    assert [c.model for c in turned.calibrations] == ["SPM", "LUT"]


@pytest.mark.parametrize("best", ["SPM", "LUT"])
def test_studies_that_used_the_best_count_whatever_error_they_state(
    facts_of: Callable[[Rows], Facts], best: str
) -> None:
    """It is measured: that no study states an error within the limit does not matter."""
    usual = {"SPM": "LUT", "LUT": "SPM"}[best]
    facts = facts_of([{**STUDY, "model": [model]} for model in (usual, usual, best)])
    errs = {usual: 0.1, best: 0.02}
    rows = [pipeline(model=m.lower(), stages=(m,), rms_deg=deg) for m, deg in errs.items()]
    said = only(recommend({"max_error_deg": 1.0}, rows, facts=facts)).contradiction or ""
    assert said.startswith("2 studies used")
    assert "used by 1 study, reaches" in said


def test_what_answers_too_seldom_is_contradicted_with_the_share_that_it_answers(
    facts_of: Callable[[Rows], Facts],
) -> None:
    seldom = pipeline(rms_deg=0.1, is_available=False, availability=0.7)
    other = pipeline(model="lut", stages=("LUT",), rms_deg=0.02)
    said = only(recommend({}, [seldom, other], facts=facts_of([STUDY]))).contradiction or ""
    assert "0.1 deg RMS at 70 % availability" in said


@pytest.mark.parametrize(("usual_deg", "ratio"), [(0.1, None), (0.0, 1.0)])
def test_beside_an_error_of_zero_no_ratio_is_said(
    facts_of: Callable[[Rows], Facts], usual_deg: float, ratio: float | None
) -> None:
    """A pipeline on exact numbers may have one."""
    facts = facts_of([STUDY, STUDY])
    rows = [pipeline(rms_deg=usual_deg), pipeline(model="lut", stages=("LUT",), rms_deg=0.0)]
    answer = recommend({}, rows, sort="support", facts=facts)
    assert answer.regret is not None
    assert (answer.regret["best_deg"], answer.regret["ratio"]) == (0.0, ratio)
    said = only(answer).contradiction
    assert (said is None) == (usual_deg == 0.0)
    assert "times" not in f"{said} {answer.regret['sentence']}"


def test_an_error_of_zero_that_is_not_advised_is_said(survey: Facts) -> None:
    rows = [ADVISED, pipeline(dataset="e", mask="Lens", rms_deg=0.0)]
    (said,) = recommend({"task": "Accuracy"}, rows, facts=survey).contradictions
    assert "0.02 deg" in said
    assert said.endswith("not advised, reaches 0 deg")


def test_errors_that_hardly_differ_contradict_nothing(facts_of: Callable[[Rows], Facts]) -> None:
    rows = [pipeline(), pipeline(model="lut", stages=("LUT",), rms_deg=0.092)]
    assert only(recommend({}, rows, facts=facts_of([STUDY]))).contradiction is None


def test_an_architecture_that_is_not_advised_but_better_is_said(survey: Facts) -> None:
    rows = [ADVISED, pipeline(dataset="e", mask="Lens", rms_deg=0.01)]
    (said,) = recommend({"task": "Accuracy"}, rows, facts=survey).contradictions
    assert "CMOS + Encoded" in said
    assert "0.02 deg" in said
    assert "CMOS" in said
    better = [pipeline(mask="Encoded", rms_deg=0.005), rows[1]]
    assert recommend({"task": "Accuracy"}, better, facts=survey).contradictions == ()
    assert recommend({"task": "Cost"}, rows, facts=survey).contradictions == ()
