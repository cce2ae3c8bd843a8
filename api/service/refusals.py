"""What Pydantic finds wrong with a request, as a problem that names what would be right.

What is expected is read from the JSON Schema of the parameter: a refusal cannot say other than
the documentation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from pydantic import BaseModel, TypeAdapter

from api.service.problems import Problem, Violation
from survey_data.nearest import nearest_name

MOST_LISTED = 20  # words for a part of a path that a refusal lists

Schema = Mapping[str, Any]


def refusal(errors: Sequence[Mapping[str, Any]], endpoint: Callable[..., Any]) -> Problem:
    """Return the problem of a request that does not fit a function.

    Parameters
    ----------
    errors : as FastAPI lists Pydantic's; their `loc` begins with "path", "query" or "body"
    endpoint : a path function, or one of the service

    Returns
    -------
    Problem
        404 for a part of the path; else 400 for names that are not declared; else 422 for values.
    """
    declared = schemas(endpoint)
    for error in errors:
        if error["loc"][0] == "path":
            name, text = error["loc"][1], error["input"]
            schema = declared["path"][name]
            words = schema["enum"]
            expected = "one of those listed" if len(words) > MOST_LISTED else _expected(schema)
            violation = Violation(name, text, expected, nearest_name(text, words, cutoff=0))
            return Problem(404, f"unknown-{name}", errors=[violation])
    unknown = [error["loc"] for error in errors if error["type"] == "extra_forbidden"]
    if unknown:
        names = sorted(declared[unknown[0][0]])
        expected = f"one of {', '.join(names)}" if names else "no parameters"
        expected = f"a parameter name, {expected}"
        wrong = [
            Violation(name, None, expected, nearest_name(name, names, cutoff=0))
            for _, name in unknown
        ]
        return Problem(400, "unknown-parameter", errors=wrong)
    wrong = [_violation(error, declared) for error in errors]
    return Problem(422, "invalid-value", errors=wrong)


@cache
def schemas(endpoint: Callable[..., Any]) -> Mapping[str, Mapping[str, Schema]]:
    """Return the JSON Schema of every parameter of a function, by place and name.

    Arguments whose type is a model are called after the place they come from.
    """
    found: dict[str, dict[str, Schema]] = {"path": {}, "query": {}}
    for name, model in asked_models(endpoint).items():
        members = model.model_json_schema().get("properties", {})
        found[name] = {member: of_list(schema) for member, schema in members.items()}
    for name, hint in get_type_hints(endpoint, include_extras=True).items():
        if _kind(hint) is str:
            found["path"][name] = TypeAdapter(hint).json_schema()
    return found


def of_list(schema: Mapping[str, Any]) -> dict[str, Any]:
    """Return the schema of a parameter, of one that may be given several times as a list."""
    one = dict(schema)
    for kind in schema.get("anyOf", ()):
        if kind.get("type") == "array":
            one = {**kind, **one}
            del one["anyOf"]
    return one


def asked_models(endpoint: Callable[..., Any]) -> Mapping[str, type[BaseModel]]:
    """Return the models that a function is asked by, by the name of the argument."""
    hints = get_type_hints(endpoint, include_extras=True)
    kinds = {name: _kind(hint) for name, hint in hints.items()}
    return {n: k for n, k in kinds.items() if isinstance(k, type) and issubclass(k, BaseModel)}


def _kind(hint: Any) -> Any:
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint


def _violation(error: Mapping[str, Any], declared: Mapping[str, Mapping[str, Schema]]) -> Violation:
    """Return an error of Pydantic's as a violation."""
    place, *where = error["loc"]
    given = error["input"]
    if not where:
        return Violation(place, _show(given), "a JSON object")
    name = where[0]
    schema = declared[place][name]
    if error["type"] == "too_long":
        expected = f"at most {schema['maxItems']} values"
        return Violation(name, f"{len(given)} values", expected)
    if schema["type"] == "array" and len(where) == 1:
        return Violation(
            name, _show(given), f"a value or a list of values, each {_expected(schema['items'])}"
        )
    if place == "query" and isinstance(given, list):
        return Violation(name, ", ".join(given), "one value, given once")
    valid = schema.get("items", schema)
    near = nearest_name(given, _words(valid), cutoff=0) if isinstance(given, str) else None
    return Violation(name, _show(given), _expected(valid), near)


def _words(schema: Schema) -> Sequence[str]:
    return ("true", "false") if schema["type"] == "boolean" else schema.get("enum", ())


def _expected(schema: Schema) -> str:
    """Say in words what a schema takes."""
    if "enum" in schema:
        return f"one of {', '.join(schema['enum'])}"
    match schema["type"]:
        case "boolean":
            return "true or false"
        case "integer":
            return f"an integer from {schema['minimum']} to {schema['maximum']}"
        case "number":
            above = "above" if "exclusiveMinimum" in schema else "of at least"
            least = schema.get("exclusiveMinimum", schema.get("minimum"))
            return f"a number {above} {least}, at most {schema['maximum']:g}"
    if not schema.get("maxLength", 1):
        return "nothing: there is no valid value"
    form = schema.get("pattern")
    return "text of " + (form or f"{schema['minLength']} to {schema['maxLength']} characters")


def _show(value: object) -> str:
    """Return a value as the refusal repeats it."""
    match value:
        case str():
            return value
        case Mapping() | list():
            kind = "an object" if isinstance(value, Mapping) else "a list"
            return f"{kind} of {len(value)} items"
        case None:
            return "null"
        case bool():
            return str(value).lower()
        case int() if value.bit_length() > 256:  # str() of it may raise
            return "a very long integer"
    return str(value)
