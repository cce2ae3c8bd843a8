"""/v1/assessment and /v1/sweeps: what methods can do, as the survey says and as measured."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from api.http.answers import Answer
from api.http.endpoint import Endpoint
from api.http.knowledge import Knowledge
from api.http.pagination import CURSOR, LIMIT, page
from api.http.parameters import Arguments, Parameter, Parameters
from api.http.shapes_assessment import Assessment, Sweeps
from api.http.values import Choice
from benchmark.reference.series import SWEEPS
from benchmark.sweeps.plan import SERIES

VERDICT_COLUMNS = ("method", "property", "survey", "measured", "agreement", "value", "reason")
SWEEP_COLUMNS = ("series", "sweep", "point", "extractor", "rms", "bound", "over_bound")


def endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return the endpoints of sweeps and assessment."""
    measurements = knowledge.measurements
    of_assessment = Parameters(
        [
            Parameter(
                "method",
                Choice(lambda: measurements.assessed_methods),
                "Only this method, as the survey's table calls it.",
                repeatable=True,
            ),
        ]
    )
    of_sweeps = Parameters(
        [
            Parameter("series", Choice(lambda: tuple(SERIES)), "Only this feature.", True),
            Parameter("sweep", Choice(lambda: tuple(SWEEPS)), "Only this sweep.", True),
            Parameter(
                "extractor",
                Choice(lambda: tuple(knowledge.catalogue.extractors)),
                "Only this extractor, by the name of its implementation.",
                repeatable=True,
            ),
            LIMIT,
            CURSOR,
        ]
    )

    def build_assessment(_parts: Mapping[str, str], arguments: Arguments) -> Answer:
        whole = measurements.assessment
        wanted = arguments["method"]
        methods = [m for m in whole["methods"] if not wanted or m["method"] in wanted]
        rows: list[Mapping[str, Any]] = [
            {
                **{name: method[name] for name in ("method", "taxonomy", "case_study")},
                **verdict,
            }
            for method in methods
            for verdict in method["properties"]
        ]
        totals = {
            name: sum(method["counts"][name] for method in methods) for name in whole["totals"]
        }
        document = {"definitions": whole["definitions"], "methods": methods, "totals": totals}
        return Answer(document, VERDICT_COLUMNS, lambda: rows)

    def build_sweeps(_parts: Mapping[str, str], arguments: Arguments) -> Answer:
        fields = ("series", "sweep", "extractor")
        rows = [
            row
            for row in measurements.sweeps
            if all(row[name] in arguments[name] for name in fields if arguments[name])
        ]
        shown = page(rows, "/v1/sweeps", of_sweeps, arguments)
        document = {"items": shown.items, "total": shown.total, "next": shown.next}
        return Answer(document, SWEEP_COLUMNS, lambda: shown.items, shown.link)

    return [
        Endpoint(
            path="/v1/sweeps",
            name="sweeps",
            summary="Sweeps on reference features",
            description="Error of every extractor over noise, feature size, sub-pixel phase and "
            "more, on features in closed form, with the Cramer-Rao bound of each point. A row "
            "without a sweep says why an extractor is not measured on a feature.",
            shape=Sweeps,
            build=build_sweeps,
            parameters=of_sweeps,
            example_arguments="series=disc&sweep=noise&extractor=bctm&limit=1",
        ),
        Endpoint(
            path="/v1/assessment",
            name="assessment",
            summary="The survey's assessment beside the measured one",
            description="Scores 2 (provides), 1 (partly), 0 (does not) of 19 methods in 21 "
            "properties: what the survey says, what was measured by the stated definition, and "
            "whether they agree. As CSV: a row a method and property.",
            shape=Assessment,
            build=build_assessment,
            parameters=of_assessment,
            example_arguments="method=BCTM",
        ),
    ]
