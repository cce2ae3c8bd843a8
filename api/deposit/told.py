"""Tables of the bundle that are told from facts and plan: resolution, verdicts, publications."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import survey_data
from benchmark.plan.combinations import scorable
from benchmark.plan.shown import data_sets
from registry.fidelity.runnable import ESSENTIAL
from registry.resolution import resolve_all
from survey_data.findings.publications import publications


def resolution() -> list[Mapping[str, Any]]:
    """Return a row for each pipeline of each study in each setting that stands for the study."""
    return [
        {
            "study": key,
            "grade": found.fidelity.grade,
            "state": found.state,
            **{name: getattr(pipeline, name) for name in ESSENTIAL},
            "dataset": setting.dataset,
            "condition": setting.condition,
            **{f"{name}_basis": pipeline.basis[name] for name in ESSENTIAL},
            "assumed": [f"{name}: {rule}" for name, rule in pipeline.assumed.items()],
        }
        for key, found in resolve_all(scorable(), data_sets=data_sets()).items()
        for pipeline in found.pipelines
        for setting in pipeline.settings
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


def published() -> list[Mapping[str, Any]]:
    """Return the studies per year and per venue."""
    return [
        {"per": row.kind, "year_or_venue": row.value, "studies_count": row.studies}
        for row in publications(survey_data.load())
    ]
