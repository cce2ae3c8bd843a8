"""The OpenAPI document made short: what operations have in common stands once, in components."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

Node = dict[str, Any]

#: Closed lists of at least so many words are components where they stand more than once.
_MANY_WORDS = 4


def share(document: Node) -> Node:
    """Return the document with shared parameters, word lists and responses, without titles.

    What it says stays the same; an example of a refusal stands once for each status.
    """
    for schema in document["components"]["schemas"].values():
        _plain(schema)
    operations = [one for path in document["paths"].values() for one in path.values()]
    for operation in operations:
        for parameter in operation.get("parameters", ()):
            _plain(parameter["schema"])
            if not parameter.get("required"):
                parameter.pop("required", None)  # as where it is not said
            if parameter["schema"].get("description") == parameter.get("description"):
                parameter["schema"].pop("description", None)
        for place in (operation.get("requestBody", {}), *operation["responses"].values()):
            for content in place.get("content", {}).values():
                _plain(content.get("schema", {}))
    _share_schemas(document, operations)
    _share_parameters(document, operations)
    _share_responses(document, operations)
    return document


def inlined(document: Mapping[str, Any]) -> dict[str, Node]:
    """Return the paths of a shared document with references replaced by what they refer to.

    Schemas of bodies and answers keep theirs, those of parameters do not.
    """
    components = document["components"]

    def whole(value: Any) -> Any:
        if isinstance(value, list):
            return [whole(member) for member in value]
        if not isinstance(value, dict):
            return value
        found = {name: whole(member) for name, member in value.items() if name != "$ref"}
        return {**whole(_target(components, value)), **found} if "$ref" in value else found

    def operation(shared: Node) -> Node:
        responses = {
            status: _target(components, one) if "$ref" in one else one
            for status, one in shared["responses"].items()
        }
        found = {**shared, "responses": responses}
        if "parameters" in shared:
            found["parameters"] = whole(shared["parameters"])
        return found

    return {
        path: {method: operation(one) for method, one in operations.items()}
        for path, operations in document["paths"].items()
    }


def _target(components: Node, reference: Node) -> Node:
    _, _, kind, name = reference["$ref"].split("/")
    found: Node = components[kind][name]
    return found


def _plain(schema: Node) -> None:
    """Drop generated titles, and write a value that may be null in the short form."""
    if isinstance(schema.get("title"), str):
        del schema["title"]
    kinds = schema.get("anyOf", ())
    bare = [one for one in kinds if one != {"type": "null"}]
    if len(kinds) == 2 and len(bare) == 1 and isinstance(bare[0].get("type"), str):
        del schema["anyOf"]
        schema |= {**bare[0], "type": [bare[0]["type"], "null"]}
        if "enum" in schema:
            schema["enum"] = [*schema["enum"], None]
    for member in _inner(schema):
        _plain(member)


def _inner(schema: Node) -> Iterator[Node]:
    """Yield the schemas that a schema is made of."""
    yield from schema.get("properties", {}).values()
    for name in ("anyOf", "allOf", "oneOf", "prefixItems"):
        yield from schema.get(name, ())
    for name in ("items", "additionalProperties"):
        if isinstance(schema.get(name), dict):
            yield schema[name]


def _share_schemas(document: Node, operations: list[Node]) -> None:
    """Refer to closed lists of words, and to members, that stand more than once."""
    places: list[tuple[str, Node]] = []
    for operation in operations:
        for parameter in operation.get("parameters", ()):
            places += _named(parameter["name"], parameter["schema"])
    components = document["components"]["schemas"]
    for name, schema in components.items():
        places += _named(name, schema)
    words = [(name, one) for name, one in places if len(one.get("enum", ())) >= _MANY_WORDS]
    _refer(words, ("type", "enum"), components)
    members = [(name, one) for name, one in places if "properties" not in one and len(one) > 1]
    _refer(members, None, components)


def _named(name: str, schema: Node) -> Iterator[tuple[str, Node]]:
    """Yield a schema and those of its members and items, by name."""
    yield name, schema
    for member, inner in schema.get("properties", {}).items():
        yield from _named(member, inner)
    for inner in (*schema.get("anyOf", ()), schema.get("items")):
        if isinstance(inner, dict):
            yield from _named(name, inner)


def _refer(
    places: list[tuple[str, Node]], shared: tuple[str, ...] | None, components: Node
) -> None:
    """Replace what is alike in several places by a reference to a component.

    Parameters
    ----------
    places : names and schemas
    shared : members of these that must be alike; None for all
    components : where what is shared goes
    """
    alike: dict[str, list[tuple[str, Node]]] = {}
    for name, schema in places:
        whole = {one: schema.get(one) for one in shared or sorted(schema)}
        alike.setdefault(json.dumps(whole), []).append((name, schema))
    for text, group in alike.items():
        whole = json.loads(text)
        names = Counter(name.removeprefix("exclude_") for name, _ in group)
        name = _free_name(names.most_common(1)[0][0], components)
        reference = {"$ref": f"#/components/schemas/{name}"}
        if len(group) * (_bytes(whole) - _bytes(reference)) <= _bytes({name: whole}):
            continue
        components[name] = whole
        for _, schema in group:
            for one in whole:
                del schema[one]
            schema.update(reference)


def _share_parameters(document: Node, operations: list[Node]) -> None:
    """Refer to parameters that several operations take alike."""
    every = [p for operation in operations for p in operation.get("parameters", ())]
    counts = Counter(json.dumps(parameter, sort_keys=True) for parameter in every)
    components = document["components"].setdefault("parameters", {})
    names: dict[str, str] = {}
    for operation in operations:
        for at, parameter in enumerate(operation.get("parameters", ())):
            text = json.dumps(parameter, sort_keys=True)
            if counts[text] < 2:
                continue
            if text not in names:
                names[text] = _free_name(parameter["name"], components)
                components[names[text]] = parameter
            operation["parameters"][at] = {"$ref": f"#/components/parameters/{names[text]}"}


def _share_responses(document: Node, operations: list[Node]) -> None:
    """Refer to one response for each status but 200, with the first example there is.

    Answers of status 200 that several operations give alike are shared too.
    """
    components = document["components"].setdefault("responses", {})
    alike: dict[str, list[Node]] = {}
    for operation in operations:
        answer = operation["responses"]["200"]
        alike.setdefault(json.dumps(answer, sort_keys=True), []).append(operation)
    for group in alike.values():
        if len(group) > 1:
            name = _free_name("Answer", components)
            components[name] = group[0]["responses"]["200"]
            for operation in group:
                operation["responses"]["200"] = {"$ref": f"#/components/responses/{name}"}
    for operation in operations:
        for status, response in operation["responses"].items():
            if status.startswith("2"):
                continue
            known = components.setdefault(status, response)
            for kind, content in response.get("content", {}).items():
                if "example" in content:
                    known["content"][kind].setdefault("example", content["example"])
            operation["responses"][status] = {"$ref": f"#/components/responses/{status}"}


def _bytes(value: Node) -> int:
    return len(json.dumps(value, separators=(",", ":"), ensure_ascii=False).encode())


def _free_name(name: str, taken: Node) -> str:
    """Return a name that no component has."""
    found, number = name, 2
    while found in taken:
        found, number = f"{name}{number}", number + 1
    return found
