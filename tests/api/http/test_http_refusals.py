"""Every refusal is a problem document that names what would have been right."""

import json
import math

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
    "/v1/flows/error",
    "/v1/figures",
    "/v1/figures/matrix",
    "/v1/figures/publications",
    "/v1/recommendations",
    "/v1/leaderboard",
    "/v1/leaderboard/overview",
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
    ("path", "nearest"),
    [
        ("/v1/study", "/v1/studies"),
        ("/v1/studies/", "/v1/studies"),
        ("/V1/Taxonomy", "/v1/taxonomy"),
        ("/health", "/healthz"),
        ("/v2", "/v1/flows/{chart}"),
    ],
)
def test_an_unknown_path_is_a_404_with_the_nearest(atlas, path, nearest):
    found = first(problem(atlas.get(path), 404))["nearest"]
    assert found == nearest or path == "/v2"


@pytest.mark.parametrize(
    ("path", "parameter", "nearest"),
    [
        ("/v1/studies/Chang208", "key", "Chang2008"),
        ("/v1/studies/liebe2001", "key", "Liebe2001"),
        ("/v1/flows/errors", "chart", "error"),
        ("/v1/flows/sunburst", "chart", "model-sunburst"),
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


def test_recommendations_allow_post_too(atlas):
    response = atlas.request("DELETE", "/v1/recommendations")
    problem(response, 405)
    assert response.headers["allow"] == "GET, HEAD, POST"


@pytest.mark.parametrize("path", TABLES)
def test_other_media_types_are_a_406(atlas, path):
    error = first(problem(atlas.get(path, accept="text/html, image/*"), 406))
    assert error["parameter"] == "Accept"
    assert "text/csv" in error["expected"]


@pytest.mark.parametrize(
    ("query", "parameter", "nearest"),
    [
        ("detector=CMO", "detector", "CMOS"),
        ("mask=multi-ap", "mask", "Multi-Ap."),
        ("task=&limit=3", "task", None),
        ("state=completed", "state", "complete"),
        ("year_min=two", "year_min", None),
        ("limit=501", "limit", None),
        ("limit=NaN", "limit", None),
        ("limit=1&limit=2", "limit", None),
    ],
)
def test_values_that_are_not_valid_are_a_422_with_the_nearest(atlas, query, parameter, nearest):
    error = first(problem(atlas.get(f"/v1/studies?{query}"), 422))
    assert (error["parameter"], error["nearest"]) == (parameter, nearest)


def test_every_violation_is_named(atlas):
    document = problem(atlas.get("/v1/studies?detector=x1&mask=x2&limit=0"), 422)
    assert [error["parameter"] for error in document["errors"]] == ["detector", "mask", "limit"]


@pytest.mark.parametrize("name", ["max_error_deg", "min_fov_deg", "max_latency_us"])
@pytest.mark.parametrize("value", ["nan", "-1", "1e999", ""])
def test_numbers_must_be_finite_and_not_negative(atlas, name, value):
    error = first(problem(atlas.get(f"/v1/recommendations?{name}={value}"), 422))
    assert (error["parameter"], error["value"]) == (name, value)


@pytest.mark.parametrize("cursor", ["x", "bm9uZQ", "WzEsImEiXQ", "%00", "W10"])
def test_a_made_up_cursor_is_a_400(atlas, cursor):
    assert first(problem(atlas.get(f"/v1/studies?cursor={cursor}"), 400))["parameter"] == "cursor"


def test_a_cursor_of_another_question_is_a_400(atlas):
    cursor = atlas.get("/v1/studies?limit=3").json()["next"]
    assert atlas.get(f"/v1/studies?limit=5&cursor={cursor}").json()["total"] == 129
    problem(atlas.get(f"/v1/studies?detector=CMOS&cursor={cursor}"), 400)
    problem(atlas.get(f"/v1/algorithms?cursor={cursor}"), 400)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"\xff\xfe",
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
        {"max_error_deg": -1},
        {"survive": ["nominal"]},
        {"sort": "best"},
        {"calibrations": 0},
        {"task": ["\ud800"]},
    ],
)
def test_a_body_of_another_shape_is_a_422(atlas, body):
    headers = {"Content-Type": "application/json"}
    content = json.dumps(body).encode()
    problem(atlas.post("/v1/recommendations", content=content, headers=headers), 422)


def test_unknown_members_of_a_body_are_refused_with_the_nearest(atlas):
    error = first(problem(atlas.post("/v1/recommendations", json={"exclude_mas": []}), 400))
    assert error["nearest"] == "exclude_mask"


def test_a_query_beside_a_body_is_refused(atlas):
    problem(atlas.post("/v1/recommendations?task=Accuracy", json={}), 400)


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Content-Type": "text/plain"},
        {"Content-Type": "application/x-www-form-urlencoded"},
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


def test_refusals_are_not_stored_and_carry_the_security_headers(atlas):
    response = atlas.get("/v1/studies?x=1")
    assert response.headers["cache-control"] == "no-store"
    assert "default-src 'none'" in response.headers["content-security-policy"]
    assert "etag" not in response.headers


def test_json_answers_hold_no_nan(atlas):
    def refuse(name):
        raise AssertionError(name)

    for path in TABLES:
        document = json.loads(atlas.get(path).content, parse_constant=refuse)
        assert not (isinstance(document, float) and math.isnan(document))


def test_a_failure_is_a_problem_that_tells_nothing_of_the_inside(client_of):
    class Broken(Knowledge):
        @property
        def taxonomy(self):
            raise RuntimeError("secret of the inside")

    response = client_of(create_app(Broken())).get("/v1/taxonomy")
    document = problem(response, 500)
    assert "secret" not in response.text
    assert document["errors"] == []
