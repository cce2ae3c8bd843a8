"""FastAPI's OpenAPI document with what FastAPI cannot know: answers to the examples, refusals."""

from __future__ import annotations

import inspect
import json
from collections.abc import Sequence
from typing import Any

from fastapi import FastAPI, Request
from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute

from api.http.asking import ask
from api.http.openapi_sharing import share
from api.schema.service import ProblemDocument
from api.service.knowledge import Knowledge
from api.service.problems import MEDIA_TYPE, Problem
from api.service.refusals import asked_models, of_list, refusal, schemas
from api.web.answers import Answer, AnswerRoute, CitedAnswer
from api.web.negotiation import CITATIONS, CSL, CSV, JSON

LARGEST_EXAMPLE = 600  # bytes; a larger answer has no example of its JSON
LONGEST_TEXT = 80  # characters of a text in an example
REFUSALS = {
    400: "Unknown parameter, contradictory parameters, or malformed request.",
    404: "Not found; the nearest name is given.",
    406: "None of the accepted media types is available.",
    413: "Request body too long.",
    415: "Content-Type is not JSON.",
    422: "Invalid value; the nearest valid value is given.",
}
#: Groups of operations: what each is about, and the first parts of its addresses.
TAGS: dict[str, tuple[str, frozenset[str]]] = {
    "Answer": (
        "Sensors and calibrations for your requirements, and comparisons.",
        frozenset({"recommendations", "advice", "compare", "calibrations", "processors"}),
    ),
    "Literature": (
        "Studies of the survey, its vocabulary, figures and claims.",
        frozenset({"studies", "taxonomy", "flows", "figures", "claims", "protocol", "editions"}),
    ),
    "Measurements": (
        "Algorithms, data sets, scores, leaderboards and experiments.",
        frozenset(
            {"algorithms", "datasets", "leaderboard", "results", "realism"}
            | {"curves", "sweeps", "assessment"}
        ),
    ),
    "Service": ("Search, state and description of the service.", frozenset()),
}
ETAG = {"schema": {"type": "string"}, "description": "Strong validator of the bytes."}
LINK = {"schema": {"type": "string"}, "description": "Link to the next page."}
NOT_MODIFIED = {"description": "Not modified: the ETag in If-None-Match is current."}


def describe(app: FastAPI, routes: Sequence[APIRoute]) -> dict[str, Any]:
    """Return the OpenAPI document of `app`, which serves `routes`, in their order.

    The examples are what is answered and refused now.
    """
    document = get_openapi(
        title=app.title,
        version=app.version,
        description=f"{app.description} Data: CC BY 4.0.",
        routes=app.routes,
        license_info={"name": "MIT", "identifier": "MIT"},
        servers=[{"url": "/", "description": "This service."}],
        tags=[{"name": name, "description": said} for name, (said, _) in TAGS.items()],
    )
    paths = document["paths"]
    document["paths"] = {r.path: paths[r.path] for r in routes if r.path in paths}
    components = document["components"]["schemas"]
    for replaced in ("HTTPValidationError", "ValidationError"):
        components.pop(replaced, None)
    own = ProblemDocument.model_json_schema(ref_template="#/components/schemas/{model}")
    document["components"]["headers"] = {"ETag": ETAG, "Link": LINK}
    components |= {**own.pop("$defs"), "ProblemDocument": own}
    for route in routes:
        if isinstance(route, AnswerRoute) and route.include_in_schema:
            for method in route.methods or ():
                operation = document["paths"][route.path][method.lower()]
                _complete(operation, route, app.state.knowledge)
    for path, operations in document["paths"].items():
        part = path.removeprefix("/v1/").partition("/")[0].strip("/")
        tag = next((name for name, (_, parts) in TAGS.items() if part in parts), "Service")
        for operation in operations.values():
            operation["tags"] = [tag]
    return share(document)


def _complete(operation: dict[str, Any], route: APIRoute, known: Knowledge) -> None:
    """Add the example, its answer, and the refusals to an operation."""
    declared = schemas(route.endpoint)
    example = _example(route)
    for parameter in operation.get("parameters", ()):
        parameter["schema"] = of_list(parameter["schema"])  # given once or several times
        if parameter["name"] == "sort" and "fields" in declared["query"]:
            parameter["schema"] = _either_way(parameter["schema"])
        given = example if parameter["in"] == "path" else example.get("query", {})
        if parameter["name"] in given:
            parameter["example"] = given[parameter["name"]]
    statuses = {400, 406, *([404] if declared["path"] else [])}
    success = operation["responses"]["200"] | {"description": "OK."}
    success["headers"] = {"ETag": {"$ref": "#/components/headers/ETag"}}
    if "body" in declared:
        operation["requestBody"]["content"][JSON]["example"] = example["body"]
        statuses |= {413, 415, 422}
    elif declared["query"]:
        statuses |= {422}
    if route.response_class in (Answer, CitedAnswer):
        if "cursor" in declared["query"]:
            success["headers"]["Link"] = {"$ref": "#/components/headers/Link"}
        answer = _answered(route, known, example)
        if answer is None:  # what it compares has not been measured
            success["content"][CSV] = {"schema": {"type": "string"}}
        else:
            _give_example(success["content"], answer, columns="fields" not in declared["query"])
    refused = {str(status): _refuse(status, route, example, known) for status in sorted(statuses)}
    same = {"304": NOT_MODIFIED} if "body" not in declared else {}
    operation["responses"] = {"200": success, **same, **refused}


def _either_way(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of an order as a pattern, which has each column once."""
    columns = [word for word in schema["enum"] if not word.startswith("-")]
    return {"type": "string", "pattern": f"^-?({'|'.join(columns)})$"}


def _answered(route: APIRoute, known: Knowledge, example: dict[str, Any]) -> Answer | None:
    try:
        return ask(route.endpoint, known, **example)
    except Problem:
        return None


def _give_example(content: dict[str, Any], answer: Answer, *, columns: bool) -> None:
    """Add what is answered, shortened, and the columns of the table where nothing lists them."""
    # Through bytes and back: the example is what travels, NaN as null included.
    whole = json.loads(answer.representation(JSON).body)
    example = shorten(whole)
    if len(json.dumps(example)) <= LARGEST_EXAMPLE:
        content[JSON]["example"] = example
    content[CSV] = {"schema": {"type": "string"}}
    if columns:
        header = answer.representation(CSV).body.decode().partition("\n")[0]
        content[CSV]["example"] = f"{header}\n"
    if isinstance(answer, CitedAnswer):
        for kind in CITATIONS.values():
            text = answer.representation(kind).body.decode()
            content[kind] = {"schema": {"type": "string"}, "example": text}
        items = {"type": "array", "items": {"type": "object"}}
        content[CSL] = {"schema": items, "example": json.loads(content[CSL]["example"])}


def shorten(value: Any) -> Any:
    """Return a document that keeps its shape and loses its length.

    Of a list the first item stays, of a text as much as a line holds.
    """
    if isinstance(value, dict):
        return {name: shorten(member) for name, member in value.items()}
    if isinstance(value, list):
        return [shorten(member) for member in value[:1]]
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        return value[: LONGEST_TEXT - 1] + "…"
    return value


def _example(route: APIRoute) -> dict[str, Any]:
    """Return the arguments of a path function in the documented example."""
    found: dict[str, Any] = {}
    for parameter in route.dependant.path_params:
        found[parameter.name] = (parameter.field_info.examples or [None])[0]
    for name, model in asked_models(route.endpoint).items():
        described: Any = model.model_config
        found[name] = described["json_schema_extra"]["examples"][0]
    return found


def _refuse(
    status: int, route: APIRoute, example: dict[str, Any], known: Knowledge
) -> dict[str, Any]:
    """Return a refusal, with an example where a slightly wrong request makes it."""
    declared = schemas(route.endpoint)
    place = "body" if "body" in declared else "query"
    name, schema = next(iter(declared[place].items()), ("limit", {}))
    problem = None
    if status == 400:
        wrong = {"type": "extra_forbidden", "loc": (place, f"{name}s")}
        problem = refusal([wrong], route.endpoint)
    elif status == 404:
        part = next(iter(declared["path"]))
        problem = _problem(route, known, {**example, part: f"{example[part]}x"})
    elif status == 422:
        value = ["0"] if schema["type"] == "array" else "0"
        problem = _problem(route, known, {**example, place: {name: value}})
    content: dict[str, Any] = {"schema": {"$ref": "#/components/schemas/ProblemDocument"}}
    if problem is not None:
        content["example"] = problem.document(route.path.format(**example))
    return {"description": REFUSALS[status], "content": {MEDIA_TYPE: content}}


def _problem(route: APIRoute, known: Knowledge, arguments: dict[str, Any]) -> Problem | None:
    if "request" in inspect.signature(route.endpoint).parameters:
        arguments = {**arguments, "request": Request({"type": "http", "headers": []})}
    try:
        ask(route.endpoint, known, **arguments)
    except Problem as problem:
        return problem
    return None
