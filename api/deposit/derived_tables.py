"""Tables of the bundle that are derived from facts and plan: resolution, verdicts, publications."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import survey_data
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
