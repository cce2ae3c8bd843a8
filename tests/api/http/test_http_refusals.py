"""Every refusal is a problem document that names what would have been right."""

import json

import pytest

from api.server.app import create_app
from api.service.knowledge import Knowledge

LISTS = [
    "/v1/studies",
    "/v1/algorithms",
    "/v1/datasets",
    "/v1/results",
    "/v1/leaderboard/architectures",
    "/v1/leaderboard/cmos-single-aperture",
]
TABLES = [
    *LISTS,
    "/v1/taxonomy",
    "/v1/studies/Chang2008",
    "/v1/figures",
    "/v1/figures/publications",
    "/v1/recommendations",
]


def problem(response, status):
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert set(document) == {"type", "title", "status", "detail", "instance", "errors"}
    assert document["status"] == status
    assert document["type"].startswith("urn:problem-type:sun-sensor-atlas:")
    assert document["instance"] == response.request.url.path
    assert document["detail"]
    for error in document["errors"]:
        assert set(error) == {"parameter", "value", "expected", "nearest"}
    return document


def first(document):
    return document["errors"][0]


@pytest.mark.parametrize(
    ("path", "nearest"), [("/v1/study", "/v1/studies"), ("/v1/studies/", "/v1/studies")]
)
def test_an_unknown_path_is_a_404_with_the_nearest(atlas, path, nearest):
    assert first(problem(atlas.get(path), 404))["nearest"] == nearest


@pytest.mark.parametrize(
    ("path", "parameter", "nearest"),
    [
        ("/v1/studies/Chang208", "key", "Chang2008"),
        ("/v1/flows/errors", "chart", "error"),
        ("/v1/leaderboard/cmos-single-apertures", "dataset", "cmos-single-aperture"),
        ("/page/pgae.js", "file", None),
    ],
)
def test_an_unknown_part_of_a_path_is_a_404_with_the_nearest(atlas, path, parameter, nearest):
    error = first(problem(atlas.get(path), 404))
    assert (error["parameter"], error["nearest"]) == (parameter, nearest)


@pytest.mark.parametrize(
    "path",
    ["/page/../service.py", "/page/..%2fservice.py", "/page//etc/x", "/page/styles", "/page/%00"],
)
def test_only_files_of_the_page_are_served(atlas, path):
    problem(atlas.get(path), 404)


@pytest.mark.parametrize("path", [*TABLES, "/healthz", "/openapi.json"])
def test_unknown_parameters_are_refused_everywhere(atlas, path):
    error = first(problem(atlas.get(f"{path}?limt=3"), 400))
    assert error["parameter"] == "limt"
    if path in LISTS:
        assert error["nearest"] == "limit"


@pytest.mark.parametrize("path", [p for p in TABLES if p != "/v1/recommendations"])
def test_other_methods_are_a_405_with_allow(atlas, path):
    for method in ("DELETE", "POST"):
        response = atlas.request(method, path)
        problem(response, 405)
        assert response.headers["allow"] == "GET, HEAD"


@pytest.mark.parametrize("path", TABLES)
def test_other_media_types_are_a_406(atlas, path):
    error = first(problem(atlas.get(path, accept="text/html, image/*"), 406))
    assert error["parameter"] == "Accept"
    assert "text/csv" in error["expected"]


@pytest.mark.parametrize(
    ("query", "parameter", "nearest"),
    [
        ("detector=CMO", "detector", "CMOS"),
        ("task=&limit=3", "task", None),
        ("state=completed", "state", "complete"),
        ("limit=NaN", "limit", None),
    ],
)
def test_values_that_are_not_valid_are_a_422_with_the_nearest(atlas, query, parameter, nearest):
    error = first(problem(atlas.get(f"/v1/studies?{query}"), 422))
    assert (error["parameter"], error["nearest"]) == (parameter, nearest)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"[1,]",
        b'{"max_error_deg": NaN}',
        b'{"limit": 1, "limit": 2}',
        b"[" * 50_000,
        b'{"limit": ' + b"9" * 5000 + b"}",
    ],
)
def test_a_body_that_is_not_json_is_a_400(atlas, content):
    headers = {"Content-Type": "application/json"}
    problem(atlas.post("/v1/recommendations", content=content, headers=headers), 400)


@pytest.mark.parametrize(
    "body",
    [
        [],
        {"task": ["Acuracy"]},
        {"task": [["Accuracy"]]},
        {"calibrations": 0},
        {"task": ["\ud800"]},
    ],
)
def test_a_body_of_another_shape_is_a_422(atlas, body):
    headers = {"Content-Type": "application/json"}
    content = json.dumps(body).encode()
    problem(atlas.post("/v1/recommendations", content=content, headers=headers), 422)


def test_a_query_beside_a_body_is_refused(atlas):
    problem(atlas.post("/v1/recommendations?task=Accuracy", json={}), 400)


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Content-Type": "application/json; charset=latin-1"},
        {"Content-Type": "application/json", "Content-Encoding": "gzip"},
    ],
)
def test_another_content_type_is_a_415(atlas, headers):
    problem(atlas.post("/v1/recommendations", content=b"{}", headers=headers), 415)


def test_a_long_body_is_a_413(atlas):
    content = b'{"task": [' + b" " * 70_000 + b"]}"
    headers = {"Content-Type": "application/json; charset=UTF-8"}
    problem(atlas.post("/v1/recommendations", content=content, headers=headers), 413)


def test_what_is_echoed_is_short(atlas):
    response = atlas.get("/v1/studies?detector=" + "x" * 5000)
    assert len(response.content) < 1500
    problem(response, 422)


def test_a_failure_is_a_problem_that_tells_nothing_of_the_inside(client_of):
    class Broken(Knowledge):
        @property
        def taxonomy(self):
            raise RuntimeError("secret of the inside")

    response = client_of(create_app(Broken())).get("/v1/taxonomy")
    document = problem(response, 500)
    assert "secret" not in response.text
    assert document["errors"] == []


def test_refusals_are_not_stored_and_carry_the_security_headers(atlas):
    response = atlas.get("/v1/studies?x=1")
    assert response.headers["cache-control"] == "no-store"
    assert "default-src 'none'" in response.headers["content-security-policy"]
    assert "etag" not in response.headers


def test_json_answers_hold_no_nan(atlas):
    def refuse(name):
        raise AssertionError(name)

    for path in TABLES:
        json.loads(atlas.get(path).content, parse_constant=refuse)
