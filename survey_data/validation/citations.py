"""Rules of what is cited: sources that can be named, labels that the survey has."""

from __future__ import annotations

from collections.abc import Iterator

from survey_data.labels import LABEL
from survey_data.problems import Problem
from survey_data.sources import Host, fault
from survey_data.validation.cells import Frames, Rule, problem, texts

#: Columns of sources, by table.
_SOURCES = {
    **dict.fromkeys(("attributes", "roles", "architectures", "hardware"), "source"),
    **dict.fromkeys(("compensated_models", "method_variants", "run_facts"), "source"),
    "studies": "url",
}
#: Columns that hold one label of the survey, by table.
_LABELS = {
    "claims": "section",
    **dict.fromkeys(
        (
            "taxonomy",
            "findings",
            "advice",
            "protocol",
            "counts",
            "defaults",
            "model_families",
            "purposes",
        ),
        "survey_section",
    ),
    "study_tables": "source",
}


def _sources_can_be_cited(frames: Frames) -> Iterator[Problem]:
    """Check that no source is a raw address, a mirror, or at a host without a name."""
    columns = ("host", "name", "kind")
    known = {cells[0]: Host(*cells) for _, cells in texts(frames["sources"], *columns)}
    for table, column in _SOURCES.items():
        if table not in frames:
            continue
        for index, (source,) in texts(frames[table], column):
            if message := fault(source, known):
                yield problem(table, index, column, message)


def _labels_are_of_the_survey(frames: Frames) -> Iterator[Problem]:
    """Check that a label in a table is one that the survey has."""
    known = {label for _, (label,) in texts(frames["labels"], "label")}
    for table, column in {**_SOURCES, **_LABELS}.items():
        if table not in frames:
            continue
        for index, (text,) in texts(frames[table], column):
            for label in () if "://" in text else LABEL.findall(text):
                if label not in known:
                    yield problem(table, index, column, f"the survey has no label {label!r}")


RULES: tuple[tuple[tuple[str, ...], Rule], ...] = (
    (("studies", "sources"), _sources_can_be_cited),
    (("studies", "labels"), _labels_are_of_the_survey),
)
