"""One client cannot take all of a server: connections, time to ask, bodies in tiny chunks."""

import asyncio
import socket
import time
from contextlib import suppress
from unittest.mock import Mock

import pytest
import uvicorn
from uvicorn.server import ServerState

from api.server import connections
from api.server.connections import BoundedProtocol, FewAtOnce


@pytest.fixture
def place(atlas, serve):
    with serve(atlas.app, http=BoundedProtocol) as opened:
        yield opened.host, opened.port


def opened_from(place, source):
    return socket.create_connection(place, timeout=60, source_address=(source, 0))


def answer(plug, asked=b"GET /healthz HTTP/1.1\r\nHost: a\r\n\r\n"):
    plug.sendall(asked)
    return plug.recv(65536)


def test_an_address_keeps_few_connections_and_others_are_answered(place, monkeypatch):
    monkeypatch.setattr(connections, "MOST_CONNECTIONS", 3)
    kept = [opened_from(place, "127.0.0.2") for _ in range(3)]
    assert all(answer(plug).startswith(b"HTTP/1.1 200 ") for plug in kept)
    with opened_from(place, "127.0.0.2") as fourth:
        assert fourth.recv(65536).startswith(b"HTTP/1.1 429 ")
    for source in ["127.0.0.3", *["127.0.0.1"] * 5]:  # a proxy, which Uvicorn trusts, keeps more
        kept.append(opened_from(place, source))
        assert answer(kept[-1]).startswith(b"HTTP/1.1 200 ")
    for plug in kept:
        plug.close()


def test_a_connection_that_is_refused_takes_no_place_of_others(atlas, monkeypatch):
    """Hundreds at once filled the places of all until they were closed: others heard 503."""
    monkeypatch.setattr(connections, "MOST_CONNECTIONS", 3)
    monkeypatch.setattr(BoundedProtocol, "_refused", set())
    monkeypatch.setattr(BoundedProtocol, "_turns", connections._Turns())
    state, config = ServerState(), uvicorn.Config(atlas.app)
    known = {"sockname": ("127.0.0.1", 80), "peername": ("127.0.0.2", 1)}
    plugs = [Mock(get_extra_info=known.get) for _ in range(5)]
    for plug in plugs:
        protocol = BoundedProtocol(config, state, {}, Mock(time=lambda: 0.0))
        protocol.connection_made(plug)
    assert [plug.pause_reading.called for plug in plugs] == [False] * 3 + [True] * 2
    assert len(state.connections) == 3


def test_who_is_refused_hears_so_after_a_while_and_few_wait_for_it(place, monkeypatch):
    """450 connections of a client that came again at once kept others waiting for 36 ms."""
    monkeypatch.setattr(connections, "MOST_CONNECTIONS", 0)
    monkeypatch.setattr(connections, "REFUSED_AFTER_S", 0.3)
    monkeypatch.setattr(connections, "MOST_REFUSED", 2)
    begun = time.monotonic()
    with opened_from(place, "127.0.0.2") as first, opened_from(place, "127.0.0.2") as second:
        time.sleep(0.1)
        with opened_from(place, "127.0.0.2") as third, suppress(ConnectionResetError):
            assert third.recv(65536) == b""
        assert time.monotonic() - begun < 0.3
        assert first.recv(65536).startswith(b"HTTP/1.1 429 ")
        assert second.recv(65536).startswith(b"HTTP/1.1 429 ")
    assert time.monotonic() - begun > 0.3


def test_an_address_that_connects_too_often_waits_and_a_proxy_does_not(place, monkeypatch):
    """20 senders that cut their uploads and came again kept others waiting for 374 ms."""
    monkeypatch.setattr(connections, "AT_ONCE", 1)
    monkeypatch.setattr(connections, "MOST_PER_S", 2.0)

    def took_s(source):
        begun = time.monotonic()
        with opened_from(place, source) as plug:
            assert answer(plug).startswith(b"HTTP/1.1 200 ")
        return time.monotonic() - begun

    assert took_s("127.0.0.9") < 0.4
    assert took_s("127.0.0.9") > 0.4
    assert took_s("127.0.0.10") < 0.4
    assert max(took_s("127.0.0.1") for _ in range(3)) < 0.4


def test_of_a_request_that_is_answered_nothing_more_is_parsed(place, monkeypatch):
    """It may be sent to its end, so that the answer is read; then the connection ends."""
    parsed = []
    take = connections._Connection.receive_data
    monkeypatch.setattr(
        connections._Connection,
        "receive_data",
        lambda held, data: (parsed.append(len(data)), take(held, data))[1],
    )
    head = b"POST /v1/calibrations HTTP/1.1\r\nHost: a\r\nContent-Length: 9000000\r\n\r\n"
    with opened_from(place, "127.0.0.1") as plug:
        plug.sendall(head)
        assert plug.recv(65536).startswith(b"HTTP/1.1 415 ")
        plug.sendall(bytes(9_000_000))
        while plug.recv(65536):
            pass
    assert sum(parsed) == len(head)


def test_a_connection_on_which_nothing_is_asked_is_closed(place, monkeypatch):
    monkeypatch.setattr(connections, "PATIENCE_S", 0.1)
    with opened_from(place, "127.0.0.1") as idle, opened_from(place, "127.0.0.1") as half:
        half.sendall(b"GET / HTTP/1.1\r\nHos")
        for plug in (idle, half):
            with suppress(ConnectionResetError):
                assert plug.recv(1) == b""


def test_a_body_in_chunks_is_refused_before_any_is_read(place):
    head = b"POST /v1/calibrations HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"
    with opened_from(place, "127.0.0.1") as plug:
        said = answer(plug, head + b"1\r\nx\r\n" * 30_000)
    assert said.startswith(b"HTTP/1.1 400 ")
    with opened_from(place, "127.0.0.1") as plug:
        plug.sendall(head)
        time.sleep(0.1)
        said = plug.recv(65536) + plug.recv(65536)
    assert b"Expected a body with Content-Length; got Transfer-Encoding." in said


def test_an_address_that_asks_too_often_waits_and_others_do_not(monkeypatch):
    monkeypatch.setattr(connections, "AT_ONCE", 2)
    monkeypatch.setattr(connections, "MOST_PER_S", 0.1)
    monkeypatch.setattr(connections, "MOST_KNOWN", 0)  # who waits is not forgotten
    waited = []

    async def sleep(seconds):
        waited.append(round(seconds))

    async def app(scope, *_):
        waited.append(scope["client"][0])

    async def ask():
        bounded = FewAtOnce(app, {"proxy"})
        for host in "a", "a", "a", "b", "a", *["proxy"] * 4:
            await bounded({"type": "http", "client": (host, 1)}, None, None)

    monkeypatch.setattr(asyncio, "sleep", sleep)
    asyncio.run(ask())
    assert waited == ["a", "a", 10, "a", "b", 20, "a", *["proxy"] * 4]


def test_so_many_requests_of_a_client_are_answered_at_once(monkeypatch):
    monkeypatch.setattr(connections, "MOST_REQUESTS", 2)

    async def ask():
        may_end, statuses = asyncio.Event(), []

        async def app(_scope, _receive, send):
            await may_end.wait()
            await send({"type": "http.response.start", "status": 200, "headers": []})

        async def send(message):
            statuses.extend([message["status"]] if "status" in message else [])

        bounded = FewAtOnce(app)
        scopes = [{"type": "http", "client": (host, 1)} for host in "aaab"]
        asked = [asyncio.create_task(bounded(scope, None, send)) for scope in scopes]
        await asyncio.sleep(0)
        may_end.set()
        await asyncio.gather(*asked)
        await bounded(scopes[0], None, send)
        return statuses

    assert asyncio.run(ask()) == [429, 200, 200, 200, 200]
