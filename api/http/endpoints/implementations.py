"""/v1/algorithms: the implementations of extractors and models."""

from __future__ import annotations

from collections.abc import Mapping

from api.http.answers import Answer
from api.http.endpoint import Endpoint
from api.http.knowledge import Knowledge
from api.http.pagination import CURSOR, LIMIT, page
from api.http.parameters import Arguments, Parameter, Parameters
from api.http.shapes import Algorithm, Algorithms
from api.http.values import Choice

ROLES = ("extractor", "model")


def endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return the endpoint of implementations."""
    parameters = Parameters(
        [
            Parameter("role", Choice(lambda: ROLES), "Only extractors, or only models."),
            LIMIT,
            CURSOR,
        ]
    )

    def build(_parts: Mapping[str, str], arguments: Arguments) -> Answer:
        found = knowledge.catalogue.listing(arguments["role"])
        shown = page(found, "/v1/algorithms", parameters, arguments)
        items = [implementation.to_dict() for implementation in shown.items]
        return Answer(
            {"items": items, "total": shown.total, "next": shown.next},
            tuple(Algorithm.model_fields),
            lambda: items,
            shown.link,
        )

    return [
        Endpoint(
            path="/v1/algorithms",
            name="algorithms",
            summary="The implementations",
            description="Extractors and models, each with the taxonomy value it implements and "
            "the studies it follows.",
            shape=Algorithms,
            build=build,
            parameters=parameters,
            example_arguments="role=extractor&limit=1",
        )
    ]
