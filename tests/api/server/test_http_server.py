"""The same over a real socket: what a server makes of HEAD, 304, and bodies it does not want."""

import json
import logging
import socket
import time

import pytest

from api.web import requests


@pytest.fixture(scope="module")
def connection(atlas, serve):
    with serve(atlas.app) as opened:
        yield opened


def ask(connection, method, path, headers=None, body=None):
    connection.request(method, path, body, headers or {})
    response = connection.getresponse()
    return response, response.read()


def send(connection, *parts, answered=True):
    """All that is answered to bytes of a connection of their own; nothing where it hangs up."""
    with socket.create_connection((connection.host, connection.port), timeout=60) as plug:
        for part in parts:
            plug.sendall(part)
            time.sleep(0.01)
        received = b""
        while answered and b"}" not in received:
            received += plug.recv(65536)
    return received


def posted(path, kind, length, more=""):
    head = f"POST {path} HTTP/1.1\r\nHost: a\r\nContent-Type: {kind}\r\n{more}"
    return f"{head}Content-Length: {length}\r\n\r\n".encode()


FORM = ("/v1/calibrations", "multipart/form-data; boundary=a")
JSON = ("/v1/recommendations", "application/json")
HEAD = b'--a\r\nContent-Disposition: form-data; name="file"; filename="b.csv"\r\n\r\n'


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


@pytest.mark.parametrize("place", [FORM, JSON])
@pytest.mark.parametrize("sent", [0, 8_000_000])
@pytest.mark.parametrize("more", ["", "Expect: 100-continue\r\n"])
def test_a_body_too_long_is_refused_before_it_is_sent_and_the_refusal_arrives(
    connection, place, sent, more
):
    received = send(connection, posted(*place, 10**9, more), b" " * sent)
    assert received.startswith(b"HTTP/1.1 413 ")
    assert b":content-too-large" in received


@pytest.mark.parametrize(
    "head",
    [b"Content-Disposition: form-data" + b";" * 300_000, b"X: 1\r\n" * 100_000, b"X" * 10**6],
    ids=["parameters", "lines", "name"],
)
def test_a_long_head_of_a_part_is_refused_at_once(connection, head):
    body = b"--a\r\n" + head + b"\r\n\r\n1\r\n--a--\r\n"
    start = time.monotonic()
    received = send(connection, posted(*FORM, len(body)) + body)
    assert received.startswith(b"HTTP/1.1 400 ")
    assert time.monotonic() - start < 5  # it took 113 s once


@pytest.mark.parametrize("place", [FORM, JSON])
def test_who_hangs_up_while_sending_is_no_failure_of_the_service(connection, place, caplog):
    def failures():
        return [
            one for one in ask(connection, "GET", "/metrics")[1].split(b"\n") if b'"500"' in one
        ]

    before = failures()
    with caplog.at_level(logging.WARNING):
        send(connection, posted(*place, 10**4), HEAD, answered=False)
        time.sleep(0.2)
    assert failures() == before
    assert caplog.records == []


def test_an_upload_is_given_up_by_its_rate_and_not_by_its_time(connection, monkeypatch):
    monkeypatch.setattr(requests, "PATIENCE_S", 0.2)
    monkeypatch.setattr(requests, "SLOWEST_PER_S", 1000)
    slow = send(connection, posted(*FORM, 10**6), HEAD)
    assert slow.startswith(b"HTTP/1.1 408 ")
    assert b"at least 1000 bytes/s after 0.2 s" in slow
    rest = [b"1" * 100] * 60  # 0.6 s at the least, three times as long as it may say nothing
    body = [
        HEAD,
        *rest,
        b"\r\n--a\r\n",
        b'Content-Disposition: form-data; name="wrong"',
        b"\r\n\r\n",
    ]
    body.append(b"\r\n--a--\r\n")
    steady = send(connection, posted(*FORM, sum(map(len, body))), *body)
    assert b":unknown-parameter" in steady, "read to its end"
