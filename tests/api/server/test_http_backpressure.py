"""A connection whose client does not read, or of which there are far too many, costs little."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState

from api.server.connections import BoundedProtocol, bounds

WHOLE = b"GET /x HTTP/1.1\r\nHost: a\r\n\r\n"


class Line(asyncio.Transport):
    """A connection whose other side takes as much as a test says."""

    def __init__(self) -> None:
        super().__init__()
        self.sent = b""
        self.unread = 0
        self.aborted = False
        self.closed = False
        self.reading = True

    def get_write_buffer_size(self) -> int:
        return self.unread

    def write(self, data: bytes | bytearray | memoryview) -> None:
        self.sent += bytes(data)

    def abort(self) -> None:
        self.aborted = True

    def close(self) -> None:
        self.closed = True

    def is_closing(self) -> bool:
        return self.closed or self.aborted

    def pause_reading(self) -> None:
        self.reading = False

    def resume_reading(self) -> None:
        self.reading = True


class Quick(BoundedProtocol):
    arrives_s = 0.01
    reads_s = 0.02
    most_connections = 2


async def answered(scope: Scope, receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": scope["path"].encode()})


def connect(state: ServerState, kind: type[BoundedProtocol] = Quick) -> tuple[Any, Line]:
    """Open a connection to the service; its protocol and its transport."""
    config = uvicorn.Config(answered, log_config=None, access_log=False, **bounds())
    protocol, line = kind(config, state, {}), Line()
    protocol.connection_made(line)
    return protocol, line


async def until(condition: Callable[[], bool]) -> None:
    for _ in range(5000):
        if condition():
            return
        await asyncio.sleep(0.002)
    pytest.fail("it did not happen")


def test_of_far_too_many_connections_the_last_is_closed_unheard() -> None:
    async def run() -> list[bool]:
        state = ServerState()
        lines = [connect(state)[1] for _ in range(2 * Quick.most_connections + 1)]
        return [line.aborted for line in lines]

    assert asyncio.run(run()) == [False] * 4 + [True]


def test_a_request_waits_until_the_answers_before_it_are_read() -> None:
    async def run() -> None:
        protocol, line = connect(ServerState())
        line.unread = 1000  # bytes of earlier answers
        protocol.pause_writing()
        protocol.data_received(WHOLE)
        await asyncio.sleep(0)
        assert (line.sent, line.reading) == (b"", False)
        line.unread = 0
        protocol.resume_writing()
        assert line.reading
        await until(lambda: line.sent.endswith(b"/x\r\n0\r\n\r\n"))
        assert line.sent.startswith(b"HTTP/1.1 200 ")
        protocol.connection_lost(None)

    asyncio.run(run())


def test_a_client_that_reads_again_and_asks_nothing_is_sent_nothing() -> None:
    async def run() -> None:
        protocol, line = connect(ServerState())
        protocol.pause_writing()
        protocol.resume_writing()
        assert line.reading
        assert line.sent == b""
        protocol.connection_lost(None)

    asyncio.run(run())


@pytest.mark.parametrize("taken", [0, 1])
def test_an_answer_of_which_nothing_is_read_for_too_long_ends_the_connection(taken: int) -> None:
    """`taken`: bytes that the client takes between two looks."""

    async def run() -> bool:
        protocol, line = connect(ServerState())
        line.unread = 10
        protocol.pause_writing()
        while line.unread and not line.aborted:
            look = protocol._look
            await until(lambda look=look: protocol._look is not look)  # type: ignore[misc]
            line.unread -= taken
        protocol.connection_lost(None)
        return line.aborted

    assert asyncio.run(run()) is (taken == 0)


def test_a_connection_that_is_lost_is_looked_at_no_more() -> None:
    async def run() -> Line:
        protocol, line = connect(ServerState())
        line.unread = 10
        protocol.pause_writing()
        protocol.connection_lost(None)
        line.closed = False
        await asyncio.sleep(3 * Quick.reads_s)
        return line

    line = asyncio.run(run())
    assert (line.aborted, line.closed) == (False, False)


def test_a_connection_that_is_closing_is_sent_no_refusal_when_its_time_is_over() -> None:
    async def run(closing: bool) -> bytes:
        protocol, line = connect(ServerState())
        line.closed = closing
        await until(lambda: protocol._due is None)
        sent = line.sent
        protocol.connection_lost(None)
        return sent

    assert asyncio.run(run(closing=True)) == b""
    assert asyncio.run(run(closing=False)).startswith(b"HTTP/1.1 408 ")
