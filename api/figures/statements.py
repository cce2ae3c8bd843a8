"""What the survey's text says of its own figures, beside what the data here show."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from api.figures.catalogue import LEVELS

if TYPE_CHECKING:
    from survey_data.findings.checks import ClauseVerdict, FindingVerdict
    from survey_data.findings.report import FidelityReport

_ALSO = {"model": "model_category", "extractor": "extractor_family"}
_WORDS = {
    "reproduced": "shown here too",
    "partly": "shown here in part",
    "contradicted": "not shown here",
    "undecidable": "open: too few cells are known to say",
}


@dataclass(frozen=True)
class Statement:
    """A statement, whether the data here show it (`verdict`), in words, and on which counts.

    `counts` has a line a clause that is tested, and one of what is not.
    """

    id: str
    text: str
    verdict: str
    verdict_words: str
    counts: tuple[str, ...]


def statements(figure: str) -> tuple[Statement, ...]:
    """Return what the survey says of a figure: of its attributes and no others."""
    levels = set(LEVELS.get(figure, ()))
    levels |= {_ALSO[level] for level in levels if level in _ALSO}
    found = []
    for finding in _report().findings:
        if set().union(*map(_levels, finding.clauses)) <= levels:
            said = _WORDS.get(finding.verdict, finding.verdict)
            found.append(
                Statement(finding.id, finding.statement, finding.verdict, said, _counts(finding))
            )
    return tuple(found)


def _levels(clause: ClauseVerdict) -> set[str]:
    """Return what a clause is about: the levels that it filters by and the one it ranks."""
    filtered = {part.partition("=")[0] for part in clause.given.split("&") if part}
    return filtered | set(clause.expects.partition(":")[0].split("+"))


def _counts(finding: FindingVerdict) -> tuple[str, ...]:
    """Return the counts behind each clause, and what is not tested."""
    if len(finding.clauses) == 1:
        lines = [finding.clauses[0].settled_by]
    else:
        lines = [
            f"{clause.statement}, {_WORDS.get(clause.verdict, clause.verdict)}: {clause.settled_by}"
            for clause in finding.clauses
        ]
    return (*lines, f"Not tested: {finding.not_tested}") if finding.not_tested else tuple(lines)


def number_of_studies() -> str:
    """Return in a sentence how many studies the survey states, how many are held, and why."""
    report = _report()
    return (
        f"The survey states {report.stated} studies; here are {report.studies}. "
        f"{report.explanation}"
    )


@cache
def _report() -> FidelityReport:
    from survey_data import fidelity, load  # noqa: PLC0415 - loads pandas: when first shown

    return fidelity(load())
