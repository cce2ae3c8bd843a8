"""The OpenAPI document: parameters as they are checked, examples as they are answered."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic_core import to_json

from api.http.endpoint import Endpoint
from api.http.negotiation import CSV, JSON
from api.http.pictures import Picture
from api.http.problems import MEDIA_TYPE, Problem
from api.http.shapes import ProblemDocument

MOST_EXAMPLE_ITEMS = 50
PROBLEM_REFERENCE = {"$ref": "#/components/schemas/ProblemDocument"}
REFUSALS = {
    400: "A parameter that is not declared, or a request that cannot be read.",
    404: "No such thing; the nearest is named.",
    405: "The path does not offer this method.",
    406: "None of the accepted media types is offered.",
    413: "The body is too long.",
    415: "The body is not said to be JSON.",
    422: "A value that is not valid; the nearest is named.",
}
ETAG = {"schema": {"type": "string"}, "description": "Strong validator of the bytes."}
NOT_MODIFIED = "The bytes of the ETag in If-None-Match are still the answer."
ALWAYS_POSSIBLE = (400, 405, 406)
OF_A_BODY = (413, 415, 422)


def describe(
    app: FastAPI, endpoints: Sequence[Endpoint], pictures: Sequence[Picture] = ()
) -> dict[str, Any]:
    """Return the OpenAPI document of `app`, whose routes of facts are `endpoints`.

    The examples are the answers the endpoints give now.
    """
    document = get_openapi(
        title=app.title,
        version=app.version,
        description=app.description,
        routes=app.routes,
    )
    schemas = document["components"]["schemas"]
    own = ProblemDocument.model_json_schema(ref_template="#/components/schemas/{model}")
    schemas.update(own.pop("$defs"))
    schemas["ProblemDocument"] = own
    for endpoint in endpoints:
        _complete(document["paths"][endpoint.path][endpoint.method.lower()], endpoint)
    for picture in pictures:
        _complete_picture(document["paths"][picture.path]["get"], picture)
    return document


def _complete_picture(operation: dict[str, Any], picture: Picture) -> None:
    operation["parameters"] = _path_parameters(picture)
    operation["responses"] = {
        "200": {
            "description": "The picture.",
            "content": picture.content(),
            "headers": {"ETag": ETAG},
        },
        "304": {"description": NOT_MODIFIED},
        **{str(status): _refusal(status, picture) for status in (400, 404, 405, 406)},
    }


def _path_parameters(endpoint: Endpoint | Picture) -> list[dict[str, Any]]:
    return [
        {
            "name": part.name,
            "in": "path",
            "required": True,
            "description": part.description,
            "schema": {"type": "string", "enum": list(part.words())},
            "example": endpoint.example[part.name],
        }
        for part in endpoint.parts
    ]


def _complete(operation: dict[str, Any], endpoint: Endpoint) -> None:
    """Add to FastAPI's description of an operation what it cannot know."""
    parameters = _path_parameters(endpoint)
    statuses = set(ALWAYS_POSSIBLE)
    if endpoint.parts:
        statuses.add(404)
    if endpoint.method == "POST":
        statuses.update(OF_A_BODY)
        operation["requestBody"] = {
            "required": True,
            "content": {
                JSON: {
                    "schema": endpoint.parameters.body_schema(),
                    "example": endpoint.example_arguments,
                }
            },
        }
    else:
        parameters += endpoint.parameters.openapi()
        statuses.add(304)
        if endpoint.parameters.declared:
            statuses.add(422)
    if parameters:
        operation["parameters"] = parameters
    answer = endpoint.example_answer()
    # Through bytes and back: the example is what travels, NaN as null included.
    content = operation["responses"]["200"]["content"]
    content[JSON]["example"] = json.loads(answer.represent(JSON).body)
    content[CSV] = {
        "schema": {"type": "string"},
        "example": answer.represent(CSV).body.decode(),
    }
    operation["responses"]["200"]["headers"] = {
        "ETag": ETAG,
        "Link": {"schema": {"type": "string"}, "description": "The next page, where there is one."},
    }
    for status in sorted(statuses):
        operation["responses"][str(status)] = (
            {"description": NOT_MODIFIED} if status == 304 else _refusal(status, endpoint)
        )


def _refusal(status: int, endpoint: Endpoint | Picture) -> dict[str, Any]:
    content: dict[str, Any] = {"schema": PROBLEM_REFERENCE}
    example = _example_refusal(status, endpoint)
    if example is not None:
        content["example"] = example
    return {"description": REFUSALS[status], "content": {MEDIA_TYPE: content}}


def _example_refusal(status: int, endpoint: Endpoint | Picture) -> dict[str, Any] | None:
    """Return a problem that the endpoint raises, by making its example slightly wrong."""
    path = endpoint.path.format(**endpoint.example)
    try:
        if status == 400:
            names = [parameter.name for parameter in endpoint.parameters.declared] or ["limit"]
            endpoint.parameters.from_query(f"{names[0]}s=1".encode())
        elif status == 404:
            part = endpoint.parts[0]
            part.check(endpoint.example[part.name] + "x")
        elif status == 422 and endpoint.method == "POST":
            endpoint.parameters.from_body({"limit": 0})
        elif status == 422:
            endpoint.parameters.from_query(f"{endpoint.parameters.declared[0].name}=0".encode())
    except Problem as problem:
        example: dict[str, Any] = json.loads(to_json(problem.document(path)))
        return example
    return None
