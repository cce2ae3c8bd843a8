"""The ledger of claims: what decides, what came out, and that it is of this code."""

from __future__ import annotations

import dataclasses
import functools
import math

import pandas as pd
import pytest

import survey_data
from benchmark.claims.experiment import Trial, find_experiments
from benchmark.claims.ledger import EXPLANATIONS, ledger
from benchmark.claims.outcomes import (
    RECORD,
    OutcomeError,
    outcome_of,
    plan_digest,
    read_outcomes,
    row_of,
)
from benchmark.claims.rules import DIRECTORY, FEWEST_TRIALS, VERDICTS, claims
from benchmark.experiments.claims import Claims
from benchmark.results.csv_tables import StoreError


def trials(count=6, **more):
    one = {"little": 1.0, "before": 2.0}
    return [Trial(one, {"line": ((1, 2), (0.5, math.nan))}, one, **more) for _ in range(count)]


def keep(directory, made):
    """Write the outcome of C04 to a record, of the plan and the code as they are."""
    row = row_of(outcome_of(claims()["C04"], made))
    RECORD.write({"C04": {**row, "key": keys()["C04"]}}, directory)


@functools.cache
def keys():
    return Claims().keys()


def test_every_claim_of_the_survey_has_rules_and_trials():
    assert list(claims()) == list(survey_data.load().claims["id"])
    for claim in claims().values():
        assert claim.rules
        assert claim.trials >= FEWEST_TRIALS
        assert len({rule.name for rule in claim.rules}) == len(claim.rules)
        for rule in claim.rules:
            assert (rule.relation == "within") == (rule.upper > rule.limit)
    for name in ("rules.csv", "trials.csv", "claims_review.csv"):
        assert set(pd.read_csv(DIRECTORY / name)["claim"]) == set(claims())
    assert not pd.read_csv(DIRECTORY / "trials.csv")["claim"].duplicated().any()
    assert sum(bool(claim.second) for claim in claims().values()) >= 5


def test_every_claim_has_an_experiment_in_its_family():
    for name, one in find_experiments().items():
        assert one.module.split(".")[-2] == claims()[name].family


def test_verdicts_follow_from_the_published_numbers():
    """Recomputed from the files by hand: Student's interval by pandas, limits from the CSV."""
    table = pd.read_csv(DIRECTORY / "rules.csv", keep_default_na=False)
    rows_of_claims = RECORD.read()
    for entry in (entry for entry in ledger() if entry.outcome):
        document = rows_of_claims[entry.claim.id]
        rows = table[table["claim"] == entry.claim.id]
        assert set(document["values"]) == set(rows["rule"])
        assert entry.verdict in VERDICTS
        results = {one.rule.name: one.result for one in entry.rules}
        for row in rows.itertuples():
            values = pd.Series(document["values"][row.rule], dtype=float).dropna()
            assert len(document["values"][row.rule]) == entry.claim.trials >= 5
            if row.scale == "linear" and len(values) >= 5:
                half = values.sem() * {4: 2.7764, 5: 2.5706, 7: 2.3646}[len(values) - 1]
                low, high = values.mean() - half, values.mean() + half
                outside = {
                    ">": high <= float(row.limit),
                    ">=": high < float(row.limit),
                    "<": low >= float(row.limit),
                    "<=": low > float(row.limit),
                }
                if row.relation in outside and abs(half) > 1e-9:
                    assert (results[row.rule] == "fails") == outside[row.relation]


def test_what_is_not_reproduced_is_explained():
    assert all(one.explanation for one in ledger() if one.verdict in VERDICTS[1:])
    written = pd.read_csv(EXPLANATIONS)
    verdicts = {one.claim.id: one.verdict for one in ledger()}
    assert [verdicts[name] for name in written["claim"]] == written["verdict"].tolist()


def test_an_outcome_is_read_as_it_was_written(tmp_path):
    keep(tmp_path, trials())
    again = read_outcomes(tmp_path)["C04"]
    assert again.values == {"little": (1.0,) * 6, "before": (2.0,) * 6}
    assert again.lines["line"].x == (1.0, 2.0)
    assert again.lines["line"].median[0] == 0.5
    assert math.isnan(again.lines["line"].median[1])
    before = RECORD.read(tmp_path)["C04"]
    assert {**row_of(again), "key": before["key"]} == before


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"values": {"little": 1.0}}, "trial 0"),
        ({"second": {"other": 1.0}}, "the second method gives"),
        ({"second": {}}, "expected numbers by the second method"),
        ({"lines": {"line": ((1, 2, 3), (0.5, 1.0))}}, "3 places and"),
    ],
)
def test_trials_that_do_not_fit_their_claim_are_refused(change, said):
    made = [dataclasses.replace(trial, **change) for trial in trials()]
    with pytest.raises(OutcomeError, match=said):
        outcome_of(claims()["C04"], made)


def test_trials_that_place_their_points_differently_are_refused():
    made = trials()
    made[3] = dataclasses.replace(made[3], lines={"line": ((1, 3), (0.5, 0.5))})
    with pytest.raises(OutcomeError, match="differently"):
        outcome_of(claims()["C04"], made)


@pytest.mark.slow
def test_a_changed_rule_or_code_makes_an_outcome_stale(tmp_path):
    keep(tmp_path, trials())
    experiment, row = Claims(tmp_path), RECORD.read(tmp_path)["C04"]
    key = keys()["C04"]
    assert experiment.why_outdated(row, key) == ""
    plan, code = key.split()
    assert experiment.why_outdated(row, f"other {code}") == "rules or plan changed"
    assert experiment.why_outdated(row, f"{plan} other") == "code changed"


def test_a_plan_is_of_rules_and_trials_and_of_no_words():
    claim = claims()["C04"]
    tightened = dataclasses.replace(claim.rules[0], limit=0.95)
    changed = dataclasses.replace(claim, rules=(tightened, *claim.rules[1:]))
    assert plan_digest(changed) != plan_digest(claim)
    assert plan_digest(dataclasses.replace(claim, measured_on="other")) == plan_digest(claim)


def test_a_broken_file_is_named(tmp_path):
    (tmp_path / RECORD.name).write_text('{"schema":1,"claims":[{"claim": "C04"}]}')
    with pytest.raises(StoreError, match=r"claims\.json: claims/0/values: Field"):
        read_outcomes(tmp_path)
