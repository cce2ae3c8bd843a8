"""The same over a real socket: what a server makes of HEAD, 304 and refused bodies."""

import json
from http.client import HTTPConnection

import pytest


@pytest.fixture(scope="module")
def connection(atlas, serve):
    with serve(atlas.app) as opened:
        yield opened


def ask(connection: HTTPConnection, method, path, headers=None, body=None):
    connection.request(method, path, body, headers or {})
    response = connection.getresponse()
    return response, response.read()


def test_one_connection_serves_head_conditions_and_refusals(connection):
    whole, body = ask(connection, "GET", "/v1/taxonomy")
    assert whole.status == 200
    head, nothing = ask(connection, "HEAD", "/v1/taxonomy")
    assert (head.status, nothing) == (200, b"")
    assert head.headers["Content-Length"] == str(len(body))
    assert head.headers["ETag"] == whole.headers["ETag"]
    same, nothing = ask(connection, "GET", "/v1/taxonomy", {"If-None-Match": whole.headers["ETag"]})
    assert (same.status, nothing) == (304, b"")
    refused, document = ask(connection, "GET", "/v1/nothing")
    assert refused.status == 404
    assert json.loads(document)["status"] == 404
    again, body_again = ask(connection, "GET", "/v1/taxonomy")
    assert (again.status, body_again) == (200, body)


def test_a_body_longer_than_allowed_is_refused_before_it_is_read(connection):
    headers = {"Content-Type": "application/json"}
    response, document = ask(connection, "POST", "/v1/recommendations", headers, b" " * 1_000_000)
    assert response.status == 413
    assert json.loads(document)["type"].endswith(":content-too-large")
