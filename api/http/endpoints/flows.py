"""/v1/flows/{chart}: the survey's decision flows."""

from __future__ import annotations

from collections.abc import Mapping

from api.http.answers import Answer
from api.http.endpoint import Endpoint, PathPart
from api.http.endpoints.attributes import attribute_filters, wanted_values
from api.http.knowledge import Knowledge
from api.http.parameters import Arguments, Parameter, Parameters
from api.http.shapes import Flows
from api.http.values import Choice, Flag
from registry.flows import CHARTS, COUNTINGS, chart

COLUMNS = ("source", "target", "value", "studies")


def endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return the endpoint of flows."""
    parameters = Parameters(
        [
            *attribute_filters(knowledge),
            Parameter(
                "counting",
                Choice(lambda: COUNTINGS),
                "Distinct studies on a link; or each study as a weight of one, split evenly over "
                "the combinations of its values, so that inflow equals outflow.",
                default=COUNTINGS[0],
            ),
            Parameter(
                "grouped",
                Flag(),
                "Categories instead of models, families instead of extractors.",
                default=False,
            ),
        ]
    )

    def build(parts: Mapping[str, str], arguments: Arguments) -> Answer:
        found = chart(
            parts["chart"],
            wanted_values(arguments),
            arguments["counting"],
            grouped=arguments["grouped"],
            facts=knowledge.facts,
        )
        return Answer(found.to_dict(), COLUMNS, lambda: [link.to_dict() for link in found.links])

    return [
        Endpoint(
            path="/v1/flows/{chart}",
            name="flows",
            summary="A decision flow",
            description="Nodes and links of one of the survey's diagrams, with the studies behind "
            "each. A filter keeps the studies that have one of the values, and of those studies "
            "only these values. As CSV: the links.",
            shape=Flows,
            build=build,
            parameters=parameters,
            parts=(PathPart("chart", "Which diagram.", lambda: tuple(CHARTS)),),
            example={"chart": "error"},
            example_arguments="error=Electrical&detector=CMOS",
        )
    ]
