"""The OpenAPI document says what the service does: examples are live, answers fit their schemas."""

import csv
import io
import json

import jsonschema
import pytest

from api.server.app import ROUTES

PROBLEM = "application/problem+json"


def operations(document):
    for path, item in document["paths"].items():
        for method, operation in item.items():
            yield path, method, operation


def validator(document, schema):
    whole = {**schema, "components": document["components"]}
    return jsonschema.Draft202012Validator(whole)


@pytest.fixture(scope="module")
def document(atlas):
    return atlas.get("/openapi.json").json()


def test_paths_stand_in_the_order_of_the_documentation(document):
    """Not in that in which they are tried."""
    documented = dict.fromkeys(route.path for route in ROUTES if route.include_in_schema)
    assert list(document["paths"]) == list(documented)


def test_every_endpoint_of_the_contract_is_documented(document):
    assert {(path, method) for path, method, _ in operations(document)} == {
        ("/v1/taxonomy", "get"),
        ("/v1/studies", "get"),
        ("/v1/editions", "get"),
        ("/v1/studies/{key}", "get"),
        ("/v1/flows/{chart}", "get"),
        ("/v1/figures", "get"),
        ("/v1/figures/matrix", "get"),
        ("/v1/figures/{figure}", "get"),
        ("/v1/recommendations", "get"),
        ("/v1/recommendations", "post"),
        ("/v1/calibrations", "post"),
        ("/v1/algorithms", "get"),
        ("/v1/datasets", "get"),
        ("/v1/datasets/{name}", "get"),
        ("/v1/datasets/{name}/preview.png", "get"),
        ("/v1/datasets/{name}/errors", "get"),
        ("/v1/datasets/{name}/errors.parquet", "get"),
        ("/v1/datasets/{name}/directions.parquet", "get"),
        ("/v1/realism", "get"),
        ("/v1/leaderboard", "get"),
        ("/v1/leaderboard/architectures", "get"),
        ("/v1/leaderboard/overview", "get"),
        ("/v1/leaderboard/{dataset}", "get"),
        ("/v1/sweeps", "get"),
        ("/v1/curves", "get"),
        ("/v1/assessment", "get"),
        ("/v1/claims", "get"),
        ("/v1/claims/{id}", "get"),
        ("/v1/compare", "get"),
        ("/v1/search", "get"),
        ("/v1/advice", "get"),
        ("/v1/protocol", "get"),
        ("/v1/results", "get"),
        ("/healthz", "get"),
        ("/v1/datasets/{name}/croissant.json", "get"),
        ("/v1/datasets/{name}/linkset.json", "get"),
        ("/v1/leaderboard/croissant.json", "get"),
        ("/v1/leaderboard/linkset.json", "get"),
    }


def begins(example, answer):
    """Whether an example is what is answered but for the length of lists and texts."""
    if isinstance(answer, dict):
        return example.keys() == answer.keys() and all(
            begins(example[k], answer[k]) for k in answer
        )
    if isinstance(answer, list):
        kept = answer[: len(example)]
        return bool(example) == bool(answer) and all(map(begins, example, kept))
    if isinstance(answer, str) and example != answer:
        return example.endswith("…") and answer.startswith(example[:-1]) and len(example) > 100
    return example == answer


def test_the_document_is_short(atlas):
    assert len(atlas.get("/openapi.json").content) < 400_000


def test_every_member_and_parameter_is_described(document):
    schemas = document["components"]["schemas"]
    members = [(n, m, of) for n, s in schemas.items() for m, of in s.get("properties", {}).items()]
    assert len(members) > 700
    assert [(name, member) for name, member, of in members if not of.get("description")] == []
    for path, _, operation in operations(document):
        for parameter in operation.get("parameters", ()):
            assert parameter.get("description"), (path, parameter["name"])


def test_every_example_validates_against_its_schema(document):
    checked = 0
    for path, _, operation in operations(document):
        places = [p for p in operation.get("parameters", ()) if "example" in p]
        places += operation.get("requestBody", {}).get("content", {}).values()
        for response in operation["responses"].values():
            places += [c for c in response.get("content", {}).values() if "example" in c]
        for place in places:
            validator(document, place["schema"]).validate(place["example"])
            checked += 1
        answers = operation["responses"]["200"].get("content", {})
        files = {"image/png", "application/vnd.apache.parquet"}
        files |= {"application/ld+json", "application/linkset+json"}
        assert (
            path == "/healthz" or files & set(answers) or "example" in answers["application/json"]
        )
    assert checked > 100


@pytest.mark.slow
def test_examples_are_what_is_answered(atlas, document):
    """The example's question is asked over HTTP; its answer begins as the example does."""
    checked = 0
    for template, method, operation in operations(document):
        content = operation["responses"]["200"]["content"]
        if "text/csv" not in content:
            continue
        given = [p for p in operation.get("parameters", ()) if "example" in p]
        parts = {p["name"]: p["example"] for p in given if p["in"] == "path"}
        query = {p["name"]: p["example"] for p in given if p["in"] == "query"}
        path = template.format(**parts)
        for accept in ("application/json", "text/csv"):
            if method == "post":
                body = operation["requestBody"]["content"]["application/json"]["example"]
                answer = atlas.post(path, json=body, headers={"Accept": accept})
            else:
                answer = atlas.get(path, accept, params=query)
            assert answer.status_code == 200
            example = content[accept]["example"]
            if accept == "text/csv":
                assert answer.text.startswith(example)
                shown, whole = (
                    list(csv.reader(io.StringIO(t), strict=True)) for t in (example, answer.text)
                )
                assert len(shown) == min(2, len(whole))
            else:
                assert begins(example, answer.json()), path
                validator(document, content[accept]["schema"]).validate(answer.json())
            checked += 1
    assert checked >= 40


def test_examples_of_refusals_are_what_is_refused(atlas, document):
    problem = validator(document, {"$ref": "#/components/schemas/ProblemDocument"})
    checked = 0
    for path, method, operation in operations(document):
        for status, response in operation["responses"].items():
            if not status.startswith("4"):
                continue
            content = response["content"][PROBLEM]
            assert content["schema"] == {"$ref": "#/components/schemas/ProblemDocument"}
            example = content.get("example")
            if example is None:
                continue
            problem.validate(example)
            assert example["status"] == int(status)
            checked += 1
            if method == "get" and status == "400":
                wrong = example["errors"][0]["parameter"]
                live = atlas.get(f"{example['instance']}?{wrong}=1").json()
                assert live == example, path
    assert checked == 77


@pytest.mark.slow
@pytest.mark.parametrize(
    "path",
    [
        "/v1/taxonomy",
        "/v1/studies",
        "/v1/studies/Liebe2001",
        "/v1/flows/model-sunburst?counting=fractional",
        "/v1/flows/cross-analysis?grouped=true",
        "/v1/figures",
        "/v1/figures/matrix",
        "/v1/figures/aggregate",
        "/v1/figures/coordinates",
        "/v1/figures/models",
        "/v1/figures/publications",
        "/v1/recommendations",
        "/v1/recommendations?max_error_deg=0.000001",
        "/v1/recommendations?task=Accuracy&exclude_task=Accuracy",
        "/v1/algorithms",
        "/v1/datasets",
        "/v1/datasets/pd-orbit",
        "/v1/realism",
        "/v1/leaderboard",
        "/v1/leaderboard/architectures",
        "/v1/leaderboard/overview?role=model&detector=PD",
        "/v1/leaderboard/qpd-single-aperture",
        "/v1/results",
        "/v1/sweeps",
        "/v1/curves",
        "/v1/assessment",
        "/v1/claims",
        "/v1/claims/C04",
        "/v1/compare?architecture=CMOS:Encoded&architecture=PD:Slit",
        "/v1/search?q=albedo",
        "/v1/advice",
        "/v1/protocol",
        "/healthz",
    ],
)
def test_whole_answers_fit_their_schemas(atlas, document, path):
    plain = path.partition("?")[0]
    template = {
        "/v1/studies/Liebe2001": "/v1/studies/{key}",
        "/v1/datasets/pd-orbit": "/v1/datasets/{name}",
        "/v1/claims/C04": "/v1/claims/{id}",
        "/v1/leaderboard/qpd-single-aperture": "/v1/leaderboard/{dataset}",
        "/v1/flows/model-sunburst": "/v1/flows/{chart}",
        "/v1/flows/cross-analysis": "/v1/flows/{chart}",
        "/v1/figures/aggregate": "/v1/figures/{figure}",
        "/v1/figures/coordinates": "/v1/figures/{figure}",
        "/v1/figures/models": "/v1/figures/{figure}",
        "/v1/figures/publications": "/v1/figures/{figure}",
    }.get(plain, plain)
    content = document["paths"][template]["get"]["responses"]["200"]["content"]
    answer = atlas.get(path)
    assert answer.status_code == 200
    schema = content["application/json"]["schema"]
    # The other one is what `fields` makes of a page.
    validator(document, schema.get("anyOf", [schema])[0]).validate(answer.json())


def test_documented_words_are_the_vocabulary(atlas, document):
    taxonomy = atlas.get("/v1/taxonomy").json()["attributes"]
    parameters = {
        p["name"]: p["schema"]
        for p in document["paths"]["/v1/recommendations"]["get"]["parameters"]
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
            assert parameters[name]["items"]["enum"] == words
            assert properties[name]["items"]["enum"] == words


def test_the_document_is_valid_openapi_without_foreign_addresses(document):
    assert document["openapi"].startswith("3.1")
    identifiers = [operation["operationId"] for _, _, operation in operations(document)]
    assert len(set(identifiers)) == len(identifiers)
    text = json.dumps({k: v for k, v in document.items() if k != "paths"})
    assert "http://" not in text
    for path, method, operation in operations(document):
        assert operation["summary"], (path, method)
