"""/v1/recommendations: ranked paths from a task to a calibrated sensor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.http.answers import Answer
from api.http.endpoint import Endpoint
from api.http.endpoints.attributes import values_of
from api.http.knowledge import Knowledge
from api.http.pagination import LARGEST_PAGE
from api.http.parameters import Arguments, Parameter, Parameters
from api.http.shapes import Recommendations
from api.http.values import Choice, Integer, PositiveNumber
from registry.recommendation import Recommendation, recommend
from registry.requirements import EXCLUDE, LIMITS
from registry.taxonomy import ATTRIBUTES

PATH = "/v1/recommendations"
COLUMNS = ("rank", "task", "detector", "mask", "model", "extractor", "studies", "pareto")
DEFAULT_PATHS = 20
NOMINAL = "nominal"

# What no requirement goes beyond: directions, a full turn, and 11 days.
MAXIMA = {"max_error_deg": 180.0, "min_fov_deg": 360.0, "max_latency_us": 1e12}
DESCRIPTIONS = {
    "max_error_deg": "RMS error at most this, in degrees: measured in the condition, or stated.",
    "min_fov_deg": "Full field of view at least this, in degrees: measured, or stated.",
    "max_latency_us": "Extraction and prediction of one sample at most this, in microseconds.",
}


def _parameters(knowledge: Knowledge) -> Parameters:
    """Return the parameters of a recommendation, in a query and in a body."""
    wanted = [
        Parameter(
            attribute,
            Choice(values_of(knowledge, attribute)),
            f"Only paths with one of these values of {attribute}.",
            repeatable=True,
        )
        for attribute in ATTRIBUTES
    ]
    unwanted = [
        Parameter(
            EXCLUDE + attribute,
            Choice(values_of(knowledge, attribute)),
            f"No path with one of these values of {attribute}.",
            repeatable=True,
        )
        for attribute in ATTRIBUTES
    ]
    limits = [Parameter(name, PositiveNumber(MAXIMA[name]), DESCRIPTIONS[name]) for name in LIMITS]
    return Parameters(
        [
            *wanted,
            *unwanted,
            *limits,
            Parameter(
                "condition",
                Choice(knowledge.conditions),
                "Condition of the data sets in which measured performance is read.",
                default=NOMINAL,
            ),
            Parameter(
                "limit",
                Integer(1, LARGEST_PAGE),
                "Paths to return; `count`, nodes and links tell of all.",
                default=DEFAULT_PATHS,
            ),
        ]
    )


def endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return the endpoints of recommendations."""
    parameters = _parameters(knowledge)

    def build(_parts: Mapping[str, str], arguments: Arguments) -> Answer:
        asked = dict(arguments)
        limit, condition = asked.pop("limit"), asked.pop("condition")
        found = recommend(
            asked, knowledge.measured_in(condition), limit=limit, facts=knowledge.facts
        )
        return Answer(found.to_dict(), COLUMNS, lambda: _rows(found))

    description = (
        "Paths task > detector > mask > model > extractor that studies took and that meet the "
        "requirements, best backed first, with the measured performance beside. Values of one "
        "attribute are alternatives; different attributes must all hold. An empty answer names "
        "the constraint that blocks it and the relaxations that would help. As CSV: the paths."
    )
    return [
        Endpoint(
            path=PATH,
            name="recommendations",
            summary="Which sensor, which calibration",
            description=description,
            shape=Recommendations,
            build=build,
            parameters=parameters,
            example_arguments="task=Accuracy&detector=CMOS&mask=Encoded&limit=1",
        ),
        Endpoint(
            path=PATH,
            name="recommend",
            summary="Which sensor, which calibration (requirements in a body)",
            description=description,
            shape=Recommendations,
            build=build,
            parameters=parameters,
            method="POST",
            example_arguments={
                "task": ["Accuracy"],
                "mask": ["Encoded"],
                "exclude_detector": ["CCD"],
                "limit": 1,
            },
        ),
    ]


def _rows(found: Recommendation) -> Sequence[Mapping[str, Any]]:
    """Return the paths as rows; a path that is not measured has empty measured cells."""
    nothing: dict[str, Any] = {}
    rows = [path.to_dict() for path in found.paths]
    return [{**row, "measured": row["measured"] or nothing} for row in rows]
