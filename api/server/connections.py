"""Connections within bounds: how long a request may take to arrive, an answer to be read, how many.

Uvicorn bounds none of them: a client that opens a connection and sends half a request, or reads no
answer, keeps it for good. A request that is sent before the answers to those before it have been
read waits for that, and takes no part of what is answered at once.
"""

from __future__ import annotations

import asyncio
import json
from typing import Any

import h11
from starlette.types import Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from api.service.problems import MEDIA_TYPE, Problem

ARRIVES_S = 10.0  # from the first byte, or the opening of the connection, to the request's last
READS_S = 20.0  # without a byte being taken of an answer that waits
LOOKS = 20  # how often that is looked at meanwhile
MOST_CONNECTIONS = 400  # beyond: 503; beyond twice as many: closed unheard
MOST_AT_ONCE = 400  # requests that are being answered, some of which are only ending
RETRY_AFTER_S = 2


class BoundedProtocol(H11Protocol):
    """HTTP/1.1 as Uvicorn speaks it, within the bounds of this module."""

    arrives_s = ARRIVES_S
    reads_s = READS_S
    most_connections = MOST_CONNECTIONS
    most_at_once = MOST_AT_ONCE
    _due: asyncio.TimerHandle | None = None
    _look: asyncio.TimerHandle | None = None
    _waiting = 0  # bytes that nobody has taken yet, when they were last looked at
    _idle = 0  # how often they were not fewer
    _held = False  # whether a request waits for the answers before it to be read

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request; close at once where there are far too many."""
        super().connection_made(transport)
        if len(self.connections) > 2 * self.most_connections:
            transport.abort()
        else:
            self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """End waiting."""
        self._stop_waiting()
        if self._look is not None:
            self._look.cancel()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read on, and wait for the rest where there is one."""
        many = len(self.connections) > self.most_connections or len(self.tasks) >= self.most_at_once
        self.app = overload_response if many else self.config.loaded_app
        super().data_received(data)
        if self.conn.their_state in (h11.IDLE, h11.SEND_BODY):
            self._wait()
        else:
            self._stop_waiting()

    def pause_writing(self) -> None:
        """Begin to look whether the client reads."""
        super().pause_writing()
        self._watch()

    def resume_writing(self) -> None:
        """Go on with requests that waited for it."""
        self._idle = 0
        super().resume_writing()
        if self._held:
            self._held = False
            self.flow.resume_reading()
            self.handle_events()

    def handle_events(self) -> None:
        """Handle what has been received, once the client reads what has been answered."""
        if self.flow.write_paused:
            self._held = True
            self._unset_keepalive_if_required()
            self.flow.pause_reading()
        else:
            super().handle_events()

    def on_response_complete(self) -> None:
        """Go on; look whether the client reads, where not all of the answer has left."""
        super().on_response_complete()
        self._watch()

    def _watch(self) -> None:
        if self._look is None and self.transport.get_write_buffer_size():
            self._waiting, self._idle = self.transport.get_write_buffer_size(), 0
            self._look = self.loop.call_later(self.reads_s / LOOKS, self._close_unread)

    def _close_unread(self) -> None:
        """Close a connection of whose answer nothing was read for too long."""
        self._look = None
        waiting = self.transport.get_write_buffer_size()
        self._idle = self._idle + 1 if waiting >= self._waiting else 0
        self._waiting = waiting
        if self._idle >= LOOKS:
            self.transport.abort()
        elif waiting:
            self._look = self.loop.call_later(self.reads_s / LOOKS, self._close_unread)

    def eof_received(self) -> bool:  # type: ignore[override]
        """Keep the other half open for an answer that is on its way."""
        return self.cycle is not None and not self.cycle.response_complete

    def _wait(self) -> None:
        if self._due is None:
            self._due = self.loop.call_later(self.arrives_s, self._expire)

    def _stop_waiting(self) -> None:
        if self._due is not None:
            self._due.cancel()
            self._due = None

    def _expire(self) -> None:
        """Close a connection whose request did not arrive; say so where nothing is being said."""
        self._due = None
        if self.transport.is_closing():
            return
        if self.conn.our_state is h11.IDLE and self.conn.their_state is h11.IDLE:
            problem = Problem(408, "request-timeout", f"No request within {self.arrives_s:g} s.")
            body = json.dumps(problem.document("")).encode()
            headers = [
                ("Content-Type", MEDIA_TYPE),
                ("Content-Length", str(len(body))),
                ("Connection", "close"),
            ]
            response = h11.Response(status_code=408, headers=headers, reason=b"Request Timeout")
            for event in (response, h11.Data(data=body), h11.EndOfMessage()):
                self.transport.write(self.conn.send(event) or b"")
        self.transport.close()
        self._watch()


async def overload_response(scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG001 - ASGI
    """Answer that there is too much to do now, and when to ask again."""
    detail = f"Too many requests are being answered; ask again in {RETRY_AFTER_S} s."
    body = json.dumps(Problem(503, "overloaded", detail).document(scope["path"])).encode()
    headers = [
        (b"content-type", MEDIA_TYPE.encode()),
        (b"content-length", str(len(body)).encode()),
        (b"retry-after", str(RETRY_AFTER_S).encode()),
        (b"cache-control", b"no-store"),
        (b"access-control-allow-origin", b"*"),
        (b"connection", b"close"),
    ]
    await send({"type": "http.response.start", "status": 503, "headers": headers})
    await send({"type": "http.response.body", "body": body})


def bounds() -> dict[str, Any]:
    """Return the arguments of `uvicorn.Config` that keep the bounds."""
    return {
        "http": BoundedProtocol,
        "ws": "none",
        "timeout_keep_alive": 5,
        "timeout_graceful_shutdown": 1,
        "loop": "asyncio",
    }
