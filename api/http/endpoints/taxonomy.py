"""/v1/taxonomy: the vocabulary."""

from __future__ import annotations

from collections.abc import Mapping

from api.http.answers import Answer
from api.http.endpoint import Endpoint
from api.http.knowledge import Knowledge
from api.http.parameters import Arguments
from api.http.shapes import Taxonomy

COLUMNS = ("attribute", "value", "name", "category", "section")


def endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return the endpoints of the taxonomy."""

    def build(_parts: Mapping[str, str], _arguments: Arguments) -> Answer:
        attributes = knowledge.taxonomy.to_dict()
        return Answer(
            {"attributes": attributes},
            COLUMNS,
            lambda: [
                {"attribute": attribute, **entry}
                for attribute, entries in attributes.items()
                for entry in entries
            ],
        )

    return [
        Endpoint(
            path="/v1/taxonomy",
            name="taxonomy",
            summary="The vocabulary",
            description="Every value an attribute of a study may take, with its name, category "
            "and section of the survey. Other endpoints take these values as filters.",
            shape=Taxonomy,
            build=build,
        )
    ]
