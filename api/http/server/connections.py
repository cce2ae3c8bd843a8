"""Connections within bounds: how long a request may take to arrive, and how many there may be.

Uvicorn bounds neither: a client that opens a connection and sends half a request keeps it for good.
"""

from __future__ import annotations

import asyncio
import json
from typing import Any

import h11
from starlette.types import Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from api.http.problems import MEDIA_TYPE, Problem

ARRIVES_S = 10.0  # from the first byte, or the opening of the connection, to the request's last
MOST_CONNECTIONS = 400  # beyond: 503; beyond twice as many: closed unheard
MOST_AT_ONCE = 300  # requests that are being answered
RETRY_AFTER_S = 2


class BoundedProtocol(H11Protocol):
    """HTTP/1.1 as Uvicorn speaks it, within the bounds of this module."""

    arrives_s = ARRIVES_S
    most_connections = MOST_CONNECTIONS
    most_at_once = MOST_AT_ONCE
    _due: asyncio.TimerHandle | None = None

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
    return {"http": BoundedProtocol, "ws": "none", "timeout_keep_alive": 5, "loop": "asyncio"}
