"""What following an answer costs, by brute force over stored scores."""

from __future__ import annotations

import math

import pytest

from benchmark.assessment import regret
from benchmark.experiments.__main__ import main
from benchmark.results.store import Store
from registry.requirements import PARAMETERS, SETTINGS, Requirements
from registry.studies import facts


def test_drawn_requirements_ask_for_everything_that_is_measured_or_of_studies():
    known = facts()
    drawn = list(regret.drawn_requirements(200, 1, known))
    for asked in drawn:
        Requirements.parse(asked, known.taxonomy)
    names = {name for asked in drawn for name in asked}
    assert names < {*PARAMETERS, *SETTINGS}
    assert {"task", "exclude_detector", "max_error_deg", "min_fov_deg", "survive"} <= names
    assert {"accuracy", "bench_deg", "confidence", "exclude_needs"} <= names
    assert list(regret.drawn_requirements(200, 1, known)) == drawn
    assert list(regret.drawn_requirements(200, 2, known)) != drawn


@pytest.mark.slow
def test_of_a_hundred_sets_the_best_is_named_first_and_the_usual_answer_tells_its_regret(capsys):
    assert main(["regret", "20"]) == 0
    printed = capsys.readouterr().out
    assert "in 0 of 100" in printed


@pytest.mark.slow
def test_the_best_is_named_first_and_regret_told_for_a_few_sets():
    found = list(regret.regrets(Store(), 12, 3))
    assert [one.requirements for one in found if not one.is_consistent] == []
    assert sum(math.isfinite(one.best_deg) for one in found) > 6
    for one in found:  # what the survey advises for a kind of error leads, whatever it measures
        if "error" not in one.requirements and math.isfinite(one.best_deg):
            assert math.isnan(one.own_ratio) or one.own_ratio <= 2.0, one.requirements


def test_what_is_no_seed_is_refused(capsys):
    with pytest.raises(SystemExit):
        main(["regret", "twenty"])
    assert "twenty" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("measured", "advice", "ratio", "kept"),
    [
        (0.1, 0.3, 3.0, True),
        (0.2, 0.3, 1.5, False),  # not the best first
        (0.1, 0.3, 1.0, False),  # a regret kept silent
        (0.1, 0.3, None, False),
        (0.1, math.inf, None, True),
        (0.1, math.inf, 1.0, False),
    ],
)
def test_an_answer_that_hides_its_regret_is_found(measured, advice, ratio, kept):
    first = {"measured": measured, "advice": advice}
    one = regret.DrawnRequirement({}, 0.1, 0.1, 0.1, first, {"measured": 1.0, "advice": ratio})
    assert one.is_consistent == kept
