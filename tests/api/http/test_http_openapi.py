"""The OpenAPI document says what the service does: answers to its examples fit their schemas."""

from functools import partial

import jsonschema
import pytest

PROBLEM = "application/problem+json"


def resolved(document, value):
    """Return what a reference refers to, with what stands beside it."""
    if "$ref" not in value:
        return value
    found = document
    for part in value["$ref"].removeprefix("#/").split("/"):
        found = found[part]
    beside = {name: member for name, member in value.items() if name != "$ref"}
    return {**resolved(document, found), **beside}


def operations(document):
    """Yield path, method and operation, with its parameters and responses in place."""
    for path, item in document["paths"].items():
        for method, operation in item.items():
            parameters = [resolved(document, one) for one in operation.get("parameters", ())]
            responses = {
                status: resolved(document, one) for status, one in operation["responses"].items()
            }
            yield path, method, {**operation, "parameters": parameters, "responses": responses}


def operation_of(document, path, method="get"):
    return next(one for p, m, one in operations(document) if (p, m) == (path, method))


def references(value):
    if isinstance(value, dict):
        if isinstance(value.get("$ref"), str):
            yield value["$ref"]
        value = list(value.values())
    if isinstance(value, list):
        for member in value:
            yield from references(member)


def validator(document, schema):
    whole = {**schema, "components": document["components"]}
    return jsonschema.Draft202012Validator(whole)


@pytest.fixture(scope="module")
def document(atlas):
    return atlas.get("/openapi.json").json()


def test_every_reference_leads_somewhere_and_every_component_is_used(document):
    used = set(references(document))
    for reference in used:
        assert resolved(document, {"$ref": reference})
    components = {
        f"#/components/{kind}/{name}" for kind, of in document["components"].items() for name in of
    }
    assert components - used == set()


def test_columns_are_listed_once_and_sort_takes_them(document):
    for path, _, operation in operations(document):
        parameters = {p["name"]: p["schema"] for p in operation["parameters"]}
        if "fields" in parameters:
            columns = resolved(document, parameters["fields"]["items"])["enum"]
            assert len(columns) > 3
            if "sort" in parameters:  # by a column of one value, either way
                order = validator(document, parameters["sort"])
                taken = [name for name in columns if order.is_valid(name)]
                assert len(taken) > 3, path
                assert all(order.is_valid(f"-{name}") for name in taken), path
                assert not any(map(order.is_valid, ("", "-", "x", "--" + taken[0]))), path


def test_every_member_and_parameter_is_described(document):
    schemas = document["components"]["schemas"]
    members = [
        (name, member, resolved(document, of))
        for name, schema in schemas.items()
        for member, of in schema.get("properties", {}).items()
    ]
    assert len(members) > 700
    # a member that is described by itself, or by the one model that it is
    models = [
        (n, m, [of, *map(partial(resolved, document), of.get("anyOf", ()))]) for n, m, of in members
    ]
    assert [(n, m) for n, m, said in models if not any(s.get("description") for s in said)] == []
    for path, _, operation in operations(document):
        for parameter in operation.get("parameters", ()):
            assert parameter.get("description"), (path, parameter["name"])


def test_every_example_validates_against_its_schema(document):
    checked = 0
    for _, _, operation in operations(document):
        places = [p for p in operation.get("parameters", ()) if "example" in p]
        places += operation.get("requestBody", {}).get("content", {}).values()
        for response in operation["responses"].values():
            places += [c for c in response.get("content", {}).values() if "example" in c]
        for place in places:
            validator(document, place["schema"]).validate(place["example"])
            checked += 1
    assert checked > 50


def test_examples_are_answered_and_answers_fit_their_schemas(atlas, document):
    checked = 0
    for template, method, operation in operations(document):
        content = operation["responses"]["200"]["content"]
        if "text/csv" not in content:
            continue
        given = [p for p in operation["parameters"] if "example" in p]
        parts = {p["name"]: p["example"] for p in given if p["in"] == "path"}
        query = {p["name"]: p["example"] for p in given if p["in"] == "query"}
        path = template.format(**parts)
        if method == "post":
            body = operation["requestBody"]["content"]["application/json"]["example"]
            answer = atlas.post(path, json=body)
        else:
            answer = atlas.get(path, params=query)
        assert answer.status_code == 200, path
        validator(document, content["application/json"]["schema"]).validate(answer.json())
        checked += 1
    assert checked == 37


def test_every_refusal_is_documented_as_the_problem_that_it_is(atlas, document):
    problem = {"$ref": "#/components/schemas/ProblemDocument"}
    for path, _, operation in operations(document):
        for status, response in operation["responses"].items():
            if status.startswith("4"):
                assert response["content"][PROBLEM]["schema"] == problem, path
    for address in ("/v1/studies?limt=1", "/v1/studies/Nobody1900", "/v1/studies?limit=0"):
        refused = atlas.get(address)
        assert str(refused.status_code) in operation_of(document, "/v1/studies/{key}")["responses"]
        validator(document, problem).validate(refused.json())


def test_documented_words_are_the_vocabulary(atlas, document):
    taxonomy = atlas.get("/v1/taxonomy").json()["attributes"]
    parameters = {
        p["name"]: p["schema"] for p in operation_of(document, "/v1/recommendations")["parameters"]
    }
    body = document["paths"]["/v1/recommendations"]["post"]["requestBody"]["content"]
    reference = body["application/json"]["schema"]["$ref"]
    described = document["components"]["schemas"][reference.rpartition("/")[2]]
    properties = described["properties"]
    assert described["additionalProperties"] is False
    assert {*properties, "format", "safe"} == set(parameters)
    for attribute, entries in taxonomy.items():
        words = [entry["value"] for entry in entries]
        for name in (attribute, f"exclude_{attribute}"):
            one, several = (resolved(document, kind) for kind in properties[name]["anyOf"])
            assert one["enum"] == words
            for schema in (parameters[name], several):
                items = resolved(document, schema)["items"]
                assert resolved(document, items)["enum"] == words
