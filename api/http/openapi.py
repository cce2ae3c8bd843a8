"""FastAPI's OpenAPI document with what FastAPI cannot know: media types, examples, refusals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute

from api.schema.service import ProblemDocument
from api.service.problems import MEDIA_TYPE
from api.service.refusals import asked_models, of_list, schemas
from api.web.answers import Answer, AnswerRoute
from api.web.negotiation import CSL, JSON, PLOTLY

REFUSALS = {
    400: "Unknown parameter, contradictory parameters, or malformed request.",
    404: "Not found; the nearest name is given.",
    406: "None of the accepted media types is available.",
    413: "Request body too long.",
    415: "Content-Type is not JSON.",
    422: "Invalid value; the nearest valid value is given.",
}
#: Groups of operations: what each is about, and the first parts of its addresses.
TAGS: dict[str, tuple[str, str]] = {
    "Answer": (
        "Sensors and calibrations for your requirements, and comparisons.",
        "recommendations advice compare calibrations processors",
    ),
    "Literature": (
        "Studies of the survey, its vocabulary, figures and claims.",
        "studies taxonomy flows figures claims directions protocol editions",
    ),
    "Measurements": (
        "Algorithms, data sets, scores, leaderboards and experiments.",
        "algorithms datasets leaderboard results realism curves sweeps assessment",
    ),
    "Service": ("Search, state and description of the service.", "search healthz"),
}
_ETAG = {"schema": {"type": "string"}, "description": "Strong validator of the bytes."}
_LINK = {"schema": {"type": "string"}, "description": "Link to the next page."}
_NOT_MODIFIED = {"description": "Not modified: the ETag in If-None-Match is current."}


def describe(app: FastAPI, routes: Sequence[APIRoute]) -> dict[str, Any]:
    """Return the OpenAPI document of `app`, which serves `routes`."""
    document = get_openapi(
        title=app.title,
        version=app.version,
        description=f"{app.description} Data: CC BY 4.0.",
        routes=app.routes,
        license_info={"name": "MIT", "identifier": "MIT"},
        servers=[{"url": "/", "description": "This service."}],
        tags=[{"name": name, "description": said} for name, (said, _) in TAGS.items()],
    )
    components = document["components"]
    for replaced in ("HTTPValidationError", "ValidationError"):
        components["schemas"].pop(replaced, None)
    own = ProblemDocument.model_json_schema(ref_template="#/components/schemas/{model}")
    components["schemas"] |= {**own.pop("$defs"), "ProblemDocument": own}
    refused = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}}
    components["responses"] = {
        str(status): {"description": said, "content": refused} for status, said in REFUSALS.items()
    }
    for route in routes:
        for operation in document["paths"].get(route.path, {}).values():
            part = route.path.removeprefix("/v1").split("/")[1]
            operation["tags"] = [name for name, (_, parts) in TAGS.items() if part in parts.split()]
        if isinstance(route, AnswerRoute) and route.include_in_schema:
            for method in route.methods or ():
                operation = document["paths"][route.path][method.lower()]
                _complete(operation, route)
    return document


def _complete(operation: dict[str, Any], route: APIRoute) -> None:
    """Add the example of a question, the media types and the refusals to an operation."""
    declared = schemas(route.endpoint)
    example = _example(route)
    for parameter in operation.get("parameters", ()):
        parameter["schema"] = of_list(parameter["schema"])  # given once or several times
        if parameter["name"] == "sort" and "fields" in declared["query"]:
            columns = [word for word in parameter["schema"]["enum"] if not word.startswith("-")]
            parameter["schema"] = {"type": "string", "pattern": f"^-?({'|'.join(columns)})$"}
        given = example if parameter["in"] == "path" else example.get("query", {})
        if parameter["name"] in given:
            parameter["example"] = given[parameter["name"]]
    statuses = {400, 406, *([404] if declared["path"] else [])}
    success = operation["responses"]["200"] | {"description": "OK.", "headers": {"ETag": _ETAG}}
    if "body" in declared:
        operation["requestBody"]["content"][JSON]["example"] = example["body"]
        statuses |= {413, 415, 422}
    elif declared["query"]:
        statuses |= {422}
    if "cursor" in declared["query"]:
        success["headers"] = {"ETag": _ETAG, "Link": _LINK}
    kind: Any = route.response_class
    if issubclass(kind, Answer):
        offered = {wanted: {"schema": {"type": "string"}} for wanted in kind.media_types}
        success["content"] = {**offered, **success["content"]}
        if PLOTLY in offered:
            success["content"][PLOTLY] = {"schema": {"type": "object"}}
        if CSL in offered:
            success["content"][CSL] = {"schema": {"type": "array", "items": {"type": "object"}}}
    same = {"304": _NOT_MODIFIED} if "body" not in declared else {}
    refused = {str(one): {"$ref": f"#/components/responses/{one}"} for one in sorted(statuses)}
    operation["responses"] = {"200": success, **same, **refused}


def _example(route: APIRoute) -> dict[str, Any]:
    """Return the arguments of a path function in the documented example."""
    found: dict[str, Any] = {}
    for parameter in route.dependant.path_params:
        found[parameter.name] = (parameter.field_info.examples or [None])[0]
    for name, model in asked_models(route.endpoint).items():
        described: Any = model.model_config
        found[name] = described["json_schema_extra"]["examples"][0]
    return found
