"""/v1/studies: the mapped studies, and what of each can be run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from api.http.answers import Answer
from api.http.endpoint import Endpoint, PathPart
from api.http.endpoints.attributes import attribute_filters, has_values, wanted_values
from api.http.knowledge import Knowledge
from api.http.pagination import CURSOR, LIMIT, page
from api.http.parameters import Arguments, Parameter, Parameters
from api.http.shapes import Studies, StudyDetail
from api.http.values import Choice, Integer, Text
from registry.studies import Study
from registry.taxonomy import ATTRIBUTES, NUMERIC_ATTRIBUTES

STATES = ("complete", "partial", "none")
COLUMNS = ("key", "title", "authors", "year", "venue", "doi", "url", "identity", "state")
DETAIL_COLUMNS = ("attribute", "value", "basis", "source", "note")


def endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return the endpoints of studies."""
    parameters = Parameters(
        [
            *attribute_filters(knowledge),
            Parameter("year_min", Integer(0, 9999), "Only studies of this year or later."),
            Parameter("year_max", Integer(0, 9999), "Only studies of this year or earlier."),
            Parameter(
                "state",
                Choice(lambda: STATES),
                "Only studies of which this much can be run.",
                repeatable=True,
            ),
            Parameter("q", Text(200), "Only studies whose key, title, authors or venue have all "
                      "these words, case aside."),
            LIMIT,
            CURSOR,
        ]
    )  # fmt: skip

    def row(study: Study) -> dict[str, Any]:
        summary = study.summary()
        values = summary.pop("values")
        return {**summary, "state": knowledge.resolutions[study.key].state, "values": values}

    def build_list(_parts: Mapping[str, str], arguments: Arguments) -> Answer:
        found = [s for s in knowledge.facts.studies.values() if _matches(knowledge, s, arguments)]
        shown = page(found, "/v1/studies", parameters, arguments)
        items = [row(study) for study in shown.items]
        return Answer(
            {"items": items, "total": shown.total, "next": shown.next},
            (*COLUMNS, *ATTRIBUTES, *NUMERIC_ATTRIBUTES),
            lambda: [
                {name: value for name, value in item.items() if name != "values"} | item["values"]
                for item in items
            ],
            shown.link,
        )

    def build_one(parts: Mapping[str, str], _arguments: Arguments) -> Answer:
        study = knowledge.facts.study(parts["key"])
        resolution = knowledge.resolutions[study.key]
        described = study.to_dict()
        simulating = knowledge.measurements.simulating
        document = {
            **row(study),
            "note": described["note"],
            "attributes": described["attributes"],
            "pipelines": [
                {**pipeline.to_dict(), "datasets": simulating(pipeline.detector, pipeline.mask)}
                for pipeline in resolution.pipelines
            ],
            "gaps": [gap.to_dict() for gap in resolution.gaps],
        }
        return Answer(document, DETAIL_COLUMNS, lambda: document["attributes"])

    return [
        Endpoint(
            path="/v1/studies",
            name="studies",
            summary="The mapped studies",
            description="The survey maps 129 studies (it states 128). Filters narrow the list.",
            shape=Studies,
            build=build_list,
            parameters=parameters,
            example_arguments="detector=CMOS&mask=Multi-Ap.&limit=1",
        ),
        Endpoint(
            path="/v1/studies/{key}",
            name="study",
            summary="One study",
            description="Every value of the mapping with its basis, the pipelines that run what "
            "the study did, and the values that nothing implements yet. As CSV: the values.",
            shape=StudyDetail,
            build=build_one,
            parts=(PathPart("key", "Key of the study.", knowledge.study_keys),),
            example={"key": "Chang2008"},
        ),
    ]


def _matches(knowledge: Knowledge, study: Study, arguments: Arguments) -> bool:
    """Say whether a study is among those asked for."""
    states = arguments["state"]
    return (
        _in_years(study, arguments["year_min"], arguments["year_max"])
        and _has_words(study, arguments["q"])
        and (not states or knowledge.resolutions[study.key].state in states)
        and has_values(knowledge, study, wanted_values(arguments))
    )


def _in_years(study: Study, first: int | None, last: int | None) -> bool:
    if first is None and last is None:
        return True
    if study.year is None:
        return False
    return (first is None or first <= study.year) and (last is None or study.year <= last)


def _has_words(study: Study, words: str | None) -> bool:
    if words is None:
        return True
    text = f"{study.key} {study.title} {study.authors} {study.venue}".casefold()
    return all(word in text for word in words.casefold().split())
