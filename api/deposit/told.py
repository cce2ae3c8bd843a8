"""Tables of the bundle that are told from facts and plan: resolution, verdicts, publications."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import survey_data
from benchmark.plan.combinations import scorable
from registry.resolution import ESSENTIAL, resolve, resolve_all
from registry.studies import facts
from survey_data.editions import editions
from survey_data.findings.publications import publications


def resolution() -> list[Mapping[str, Any]]:
    """Return a row for each pipeline of each study on each data set that it is planned on.

    Of both editions, each study's own beside it.
    """
    plan, known = scorable(), facts()
    every = facts("all").studies
    resolved = resolve_all(plan, facts=known)
    later = (study for key, study in every.items() if key not in resolved)
    resolved |= {study.key: resolve(study, plan, facts=known) for study in later}
    return [
        {
            "study": key,
            "edition": every[key].edition,
            "state": found.state,
            **{name: getattr(pipeline, name) for name in ESSENTIAL},
            "dataset": dataset,
            **{f"{name}_basis": pipeline.basis[name] for name in ESSENTIAL},
            "assumed": [f"{name}: {rule}" for name, rule in pipeline.assumed.items()],
        }
        for key, found in resolved.items()
        for pipeline in found.pipelines
        for dataset in pipeline.datasets
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
            "edition_version": one.version,
        }
        for one in editions()
    ]


def verdicts() -> list[Mapping[str, Any]]:
    """Return a row for each finding of the survey, with its counts and what would settle it."""
    return [
        {
            "finding": found.id,
            "verdict": found.verdict,
            "matching": found.matching,
            "counted": found.counted,
            "named": [f"{value} {count}" for value, count in found.named],
            "ranking": [f"{value} {count}" for value, count in found.ranking],
            "settled_by": found.settled_by,
        }
        for found in survey_data.fidelity(survey_data.load()).findings
    ]


def published() -> list[Mapping[str, Any]]:
    """Return the studies per year and per venue."""
    return [
        {"per": row.kind, "year_or_venue": row.value, "studies_count": row.studies}
        for row in publications(survey_data.load())
    ]
