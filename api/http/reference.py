"""The API reference at /docs: made of the OpenAPI document, with no script and no network."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from api.http.openapi_sharing import inlined
from api.web.negotiation import CSV, JSON

METHODS = ("get", "post")
FEW = 6  # words that are listed; of more, as many and how many there are


def reference(document: Mapping[str, Any]) -> str:
    """Return the reference as HTML; `document` is the OpenAPI document."""
    operations = list(_operations(document))
    template = _environment().get_template("reference.html")
    return template.render(info=document["info"], operations=operations)


def target(path: str, operation: Mapping[str, Any]) -> tuple[str, Any]:
    """Return the path with query, and the JSON body (None for none), of an operation's example."""
    query = []
    for parameter in operation.get("parameters", ()):
        if "example" not in parameter:
            continue
        given = parameter["example"]
        if parameter["in"] == "path":
            path = path.replace(f"{{{parameter['name']}}}", quote(str(given), safe=""))
        elif parameter["in"] == "query":
            values = given if isinstance(given, list) else [given]
            query += [f"{parameter['name']}={quote(str(value), safe='')}" for value in values]
    content = operation.get("requestBody", {}).get("content", {})
    body = content.get(JSON, {}).get("example")
    return path + ("?" + "&".join(query) if query else ""), body


def words(schema: Mapping[str, Any]) -> tuple[list[str], int, str]:
    """Return some words that a parameter takes, how many there are, and else what it takes."""
    if schema.get("type") == "array":
        some, count, said = words(schema["items"])
        return some, count, f"{said}; repeatable" if said else "repeatable"
    if "enum" in schema:
        return list(schema["enum"][:FEW]), len(schema["enum"]), ""
    default = f", {schema['default']} by default" if "default" in schema else ""
    limits = [
        f"{said} {schema[key]:g}"
        for key, said in (("minimum", "from"), ("exclusiveMinimum", "above"), ("maximum", "to"))
        if key in schema
    ]
    return [], 0, " ".join([str(schema.get("type", "any")), *limits]) + default


def columns(operation: Mapping[str, Any]) -> str:
    """Return what an operation's CSV has as columns, as a sentence; empty where it has no CSV.

    They are the words of its `fields`, or stand in its example.
    """
    content = operation["responses"]["200"].get("content", {})
    if CSV not in content:
        return ""
    names = content[CSV].get("example", "").strip().split(",")
    for parameter in operation.get("parameters", ()):
        if parameter["name"] == "fields":
            names = parameter["schema"]["items"]["enum"]
    return f"Columns: {', '.join(names)}." if any(names) else ""


def _operations(document: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for path, item in inlined(document).items():
        for method in METHODS:
            if method not in item:
                continue
            operation = item[method]
            address, body = target(path, operation)
            success = operation["responses"]["200"].get("content", {}).get(JSON, {})
            yield {
                "id": operation["operationId"],
                "method": method.upper(),
                "path": path,
                "summary": operation["summary"],
                "description": operation.get("description", ""),
                "parameters": [
                    {**parameter, "words": words(parameter["schema"])}
                    for parameter in operation.get("parameters", ())
                    if parameter["in"] in {"path", "query"}
                ],
                "address": address,
                "body": None if body is None else json.dumps(body, ensure_ascii=False),
                "columns": columns(operation),
                "example": _pretty(success["example"]) if "example" in success else None,
                "refusals": {
                    status: response["description"]
                    for status, response in operation["responses"].items()
                    if status.startswith(("4", "5"))
                },
            }


def _pretty(value: Any) -> str:
    return json.dumps(value, indent=2, ensure_ascii=False)


def _coded(text: str) -> Markup:
    """Return a text of the document, what stands in backticks as code."""
    parts = text.split("`")
    return Markup("").join(
        Markup("<code>{}</code>").format(part) if k % 2 else Markup.escape(part)
        for k, part in enumerate(parts)
    )


@cache
def _environment() -> Environment:
    made = Environment(
        loader=PackageLoader("api.http"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["coded"] = _coded
    return made
