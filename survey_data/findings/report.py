"""How faithful the tables are: counts against the survey's, completeness, and its findings.

Nothing here is tuned: a contradicted finding is a fact about the data set, and is shown with the
counts behind it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from survey_data.accuracy_classes import ClassDisagreement, class_disagreements
from survey_data.findings.checks import (
    VERDICTS,
    ClauseVerdict,
    FindingVerdict,
    evaluate,
    finding_verdict,
    study_values,
)
from survey_data.findings.grammar import Vocabulary
from survey_data.json_data import JsonData
from survey_data.problems import Problem
from survey_data.tables import SurveyTables
from survey_data.validation.rules import count_rows


@dataclass(frozen=True)
class CountLine:
    """A count held, the one the survey states (None: none), and why the two differ."""

    id: str
    held: int
    stated: int | None
    explanation: str


@dataclass(frozen=True)
class Completeness:
    """How many studies have a known value of an attribute, and what the values rest on.

    `by_basis` counts studies by the strongest basis of their values, strongest basis first.
    """

    known: int
    unknown: int
    by_basis: dict[str, int] = field(hash=False)


@dataclass(frozen=True)
class FidelityReport(JsonData):
    """Counts, completeness and findings of a set of tables; `to_dict` gives JSON data."""

    studies: int
    stated: int
    explanation: str
    counts: tuple[CountLine, ...]
    early_keys: tuple[str, ...]
    case_references: tuple[str, ...]
    completeness: dict[str, Completeness] = field(hash=False)
    class_disagreements: tuple[ClassDisagreement, ...]
    findings: tuple[FindingVerdict, ...]
    problems: tuple[Problem, ...]

    @property
    def verdicts(self) -> dict[str, int]:
        """Return verdict -> number of findings."""
        counted: dict[str, int] = dict.fromkeys(VERDICTS, 0)
        for finding in self.findings:
            counted[finding.verdict] += 1
        return counted

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain JSON data, with the number of findings of each verdict."""
        return {
            **super().to_dict(),
            "verdicts": self.verdicts,
            "findings": [finding.to_dict() for finding in self.findings],
        }


def fidelity(tables: SurveyTables, problems: Sequence[Problem] = ()) -> FidelityReport:
    """Compare valid tables with what the survey says of itself, every number counted from them.

    `problems` are carried in the report. KeyError or LookupError where the tables are not valid.
    """
    counts = _counts(tables)
    by_id = {line.id: line for line in counts}
    stated = by_id["studies"].stated
    if stated is None:
        raise LookupError("counts.csv states no number of studies")
    attributes = tables.attribute_definitions
    single = attributes.loc[~attributes["multiple"].astype(bool), "attribute"]
    vocabulary = Vocabulary(tables.taxonomy, set(single))
    values = study_values(tables.studies, tables.attributes, tables.architectures, vocabulary)
    clauses: dict[str, list[ClauseVerdict]] = {}
    for record in tables.finding_clauses.to_dict("records"):
        row = {str(name): cell for name, cell in record.items()}
        clauses.setdefault(str(row["finding"]), []).append(evaluate(row, values, vocabulary))
    early = tables.studies.loc[tables.studies["year"].isin(_excluded_years(tables)), "key"]
    references = tables.references
    case_studies = references.loc[references["role"] == "case study", "key"]
    return FidelityReport(
        studies=len(tables.studies),
        stated=stated,
        explanation=" ".join(
            line.explanation for line in counts if line.id.startswith(("studies", "case-studies"))
        ),
        counts=counts,
        early_keys=tuple(str(key) for key in early),
        case_references=tuple(str(key) for key in case_studies),
        completeness=_completeness(tables),
        class_disagreements=tuple(
            found for _, found in class_disagreements(tables.taxonomy, tables.attributes)
        ),
        findings=tuple(
            _finding({str(name): cell for name, cell in record.items()}, clauses)
            for record in tables.findings.to_dict("records")
        ),
        problems=tuple(problems),
    )


def _finding(
    row: Mapping[str, Any], clauses: Mapping[str, Sequence[ClauseVerdict]]
) -> FindingVerdict:
    tested = tuple(clauses[str(row["id"])])
    return FindingVerdict(
        id=str(row["id"]),
        verdict=finding_verdict(clause.verdict for clause in tested),
        survey_section=str(row["survey_section"]),
        statement=str(row["statement"]),
        not_tested="" if pd.isna(row["not_tested"]) else str(row["not_tested"]),
        clauses=tested,
    )


def _counts(tables: SurveyTables) -> tuple[CountLine, ...]:
    lines = []
    for row in tables.counts.to_dict("records"):
        column = "" if pd.isna(row["column"]) else str(row["column"])
        value = "" if pd.isna(row["value"]) else str(row["value"])
        lines.append(
            CountLine(
                id=str(row["id"]),
                held=count_rows(getattr(tables, row["table"]), column, value),
                stated=None if pd.isna(row["stated"]) else int(row["stated"]),
                explanation=str(row["explanation"]),
            )
        )
    return tuple(lines)


def _excluded_years(tables: SurveyTables) -> list[int]:
    """Return the years of which the survey states that it holds no study."""
    counts = tables.counts
    chosen = counts[(counts["table"] == "studies") & (counts["column"] == "year")]
    return [int(year) for year in chosen.loc[chosen["stated"] == 0, "value"]]


def _completeness(tables: SurveyTables) -> dict[str, Completeness]:
    rank = dict(zip(tables.bases["basis"], tables.bases["rank"].astype(int), strict=True))
    attributes = tables.attributes.assign(rank=tables.attributes["basis"].map(rank))
    known = attributes[attributes["value"].notna()]
    strongest = known.sort_values("rank", kind="stable").drop_duplicates(["study", "attribute"])
    entries = {}
    for attribute in map(str, tables.attribute_definitions["attribute"]):
        counted = strongest.loc[strongest["attribute"] == attribute, "basis"].value_counts()
        by_basis = {str(basis): int(counted[basis]) for basis in rank if basis in counted}
        number = sum(by_basis.values())
        entries[attribute] = Completeness(number, len(tables.studies) - number, by_basis)
    return entries
