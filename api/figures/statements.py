"""What the survey's text says of its own figures, beside what the data here show."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from api.figures.catalogue import LEVELS

if TYPE_CHECKING:
    from survey_data.findings.report import FidelityReport

_ALSO = {"model": "model_category", "extractor": "extractor_family"}
_WORDS = {
    "reproduced": "shown here too",
    "contradicted": "not shown here",
    "undecidable": "too few studies to say",
}


@dataclass(frozen=True)
class Statement:
    """A statement, whether the data here show it (`verdict`), in words, and on which counts."""

    id: str
    text: str
    verdict: str
    said: str
    counts: str


def statements(figure: str) -> tuple[Statement, ...]:
    """Return what the survey says of a figure: of its attributes and no others."""
    levels = set(LEVELS.get(figure, ()))
    levels |= {_ALSO[level] for level in levels if level in _ALSO}
    found = []
    for finding in _report().findings:
        named = {part.partition("=")[0] for part in finding.given.split("&") if part}
        named |= set(finding.expects.partition(":")[0].split("+"))
        if named <= levels:
            said = _WORDS.get(finding.verdict, finding.verdict)
            found.append(
                Statement(finding.id, finding.statement, finding.verdict, said, finding.settled_by)
            )
    return tuple(found)


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
