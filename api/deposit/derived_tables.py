"""Rows of the bundle's tables that are derived: resolution, verdicts, publications, claims."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import survey_data
from benchmark import datasets as presets
from benchmark.claims.ledger import Entry
from benchmark.metrics.ranking import own_errors
from benchmark.plan.combinations import scorable_plan, study_plans
from benchmark.plan.shown import data_sets
from registry.fidelity.runnable import ESSENTIAL
from registry.resolution import resolve_all, resolve_later
from registry.studies import facts
from registry.taxonomy import Plan
from survey_data.editions import editions
from survey_data.findings.publications import publications


def resolution(
    rows: Sequence[Mapping[str, Any]] = (), own: Mapping[str, Plan] | None = None
) -> list[Mapping[str, Any]]:
    """Return a row for each study, pipeline and setting (data set, condition) used for the study.

    Of both editions, each study's own beside it.

    Parameters
    ----------
    rows : published scores of all units, which grades take errors from; without them no score is
        asked for
    own : what can be scored on sensors of single studies, by study; that of those simulated by
        default
    """
    owned = study_plans() if own is None else own
    plan, shown, known, every = scorable_plan(), data_sets(), facts(), facts("all")
    scores = own_errors(rows) if rows else None
    resolved = resolve_all(plan, own=owned, data_sets=shown, facts=known, scores=scores)
    resolved |= resolve_later(plan, known, every, data_sets=shown, scores=scores)
    return [
        {
            "study": key,
            "edition": every.studies[key].edition,
            "grade": found.fidelity.grade,
            "state": found.state,
            **{name: getattr(pipeline, name) for name in ESSENTIAL},
            "dataset": setting.dataset,
            "condition": setting.condition,
            **{f"{name}_basis": pipeline.basis[name] for name in ESSENTIAL},
            "assumed": [f"{name}: {rule}" for name, rule in pipeline.assumed.items()],
        }
        for key, found in resolved.items()
        for pipeline in found.pipelines
        for setting in pipeline.settings
    ]


def datasets() -> list[Mapping[str, Any]]:
    """Return a row for each standard data set and each sensor of a single study."""
    names = sorted((*presets.names(), *presets.study_names()))
    return [
        {
            **{name: getattr(one, name) for name in ("name", "version", "detector", "mask")},
            "observation": str(one.observation),
            "half_fov_deg": one.geometry.half_fov_deg,
            "conditions": one.conditions,
            "description": one.description,
            "follows": one.follows,
        }
        for one in map(presets.get, names)
    ]


def all_studies() -> list[Mapping[str, Any]]:
    """Return a row for each study of both editions."""
    columns = ("key", "edition", "title", "authors", "year", "venue", "type", "doi")
    rows = survey_data.load().edition("all").studies[list(columns)]
    filled = rows.astype(object).where(rows.notna(), None).to_dict("records")
    return [{"study" if name == "key" else name: row[name] for name in columns} for row in filled]


def edition_rows() -> list[Mapping[str, Any]]:
    """Return a row for each edition, as it is cited."""
    return [
        {
            "edition": one.name,
            "edition_title": one.title,
            "edition_studies": one.studies,
            "edition_last_year": one.last_year,
            "edition_later": one.later,
            "edition_version": one.version,
        }
        for one in editions()
    ]


def verdicts() -> list[Mapping[str, Any]]:
    """Return a row for each clause of the survey's findings, with its counts."""
    return [
        {
            "finding": found.id,
            "clause": clause.clause,
            "finding_verdict": found.verdict,
            "verdict": clause.verdict,
            "matching": clause.matching,
            "counted": clause.counted,
            "named": [f"{value} {count}" for value, count in clause.named],
            "ranking": [f"{value} {count}" for value, count in clause.ranking],
            "settled_by": clause.settled_by,
        }
        for found in survey_data.fidelity(survey_data.load()).findings
        for clause in found.clauses
    ]


def publication_counts() -> list[Mapping[str, Any]]:
    """Return the studies per year and per venue."""
    return [
        {"per": row.kind, "year_or_venue": row.value, "studies_count": row.studies}
        for row in publications(survey_data.load())
    ]


def claim_verdicts(entries: Sequence[Entry]) -> list[Mapping[str, Any]]:
    """Return a row for each claim."""
    return [
        {
            "claim": entry.claim.id,
            "claim_verdict": entry.verdict,
            "claim_case": entry.review.case,
            "claim_sentence": entry.review.sentence,
            "measured_on": entry.claim.measured_on,
            "replicate": entry.claim.replicate,
            "second_method": entry.claim.second,
            "second_agrees": entry.agrees,
            "explanation": entry.explanation,
        }
        for entry in entries
    ]


def claim_rules(entries: Sequence[Entry]) -> list[Mapping[str, Any]]:
    """Return a row for each rule, with what the trials say of it."""
    return [
        {
            "claim": entry.claim.id,
            **{name: value for name, value in rule.items() if name != "trials"},
            "trials_count": rule["trials"],
        }
        for entry in entries
        for rule in entry.to_dict()["rules"]
    ]


def claim_trials(entries: Sequence[Entry]) -> list[Mapping[str, Any]]:
    """Return a row for each rule and trial, with the number that was measured."""
    found: list[Mapping[str, Any]] = []
    for outcome in (entry.outcome for entry in entries if entry.outcome is not None):
        for rule, values in outcome.values.items():
            second = outcome.second.get(rule, (None,) * len(values))
            found += [
                {
                    "claim": outcome.claim,
                    "rule": rule,
                    "trial": number,
                    "statistic_value": value,
                    "second_value": other,
                }
                for number, (value, other) in enumerate(zip(values, second, strict=True))
            ]
    return found
