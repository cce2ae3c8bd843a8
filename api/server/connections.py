"""What one client may take of a server: connections, requests at once, and time to ask.

A proxy in front knows clients better (deploy/Caddyfile); this is for servers without one.
"""

from __future__ import annotations

from asyncio import Transport
from collections import Counter
from http import HTTPStatus
from typing import Any

import h11
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

#: Of one address, in a process of the server.
MOST_CONNECTIONS, MOST_REQUESTS = 100, 100
#: Within which a head has to arrive, and part of an answer to be taken.
PATIENCE_S = 10.0
#: Within which who has just connected may still ask a server that ends.
_LAST_S = 0.5
_NO_LENGTH = "Expected a body with Content-Length; got Transfer-Encoding."
_TOO_MANY = "Too many connections or requests of this address at once.\n"


class _Connection(h11.Connection):
    """Refuses bodies in chunks: a chunk of one byte costs as much as one of 10 kB."""

    asked = unmeasured = False

    def next_event(self) -> Any:
        """Return the next event, as h11 does."""
        event = super().next_event()
        if isinstance(event, h11.Request):
            self.asked = True
            self.unmeasured = any(name == b"transfer-encoding" for name, _ in event.headers)
            if self.unmeasured:
                raise h11.RemoteProtocolError(_NO_LENGTH)
        return event


class BoundedProtocol(H11Protocol):
    """HTTP as Uvicorn speaks it, to clients that ask in time and keep few connections.

    A proxy may keep any number: an address that Uvicorn trusts to forward those of clients, by
    default 127.0.0.1 (`FORWARDED_ALLOW_IPS`).
    """

    def __init__(self, *args: Any, **named: Any) -> None:
        super().__init__(*args, **named)
        self.conn = self._bounded = _Connection(h11.SERVER)
        self._seen: tuple[Any, int] = (None, 0)

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Take a connection, or close it where the address has too many."""
        super().connection_made(transport)
        host = self.client[0] if self.client else ""
        proxies = getattr(self.app, "trusted_hosts", ())  # of the middleware that trusts them
        clients = [getattr(one, "client", None) or ("", 0) for one in self.connections]
        count = sum(client[0] == host for client in clients)
        if count > MOST_CONNECTIONS and host not in proxies:
            head = f"HTTP/1.1 429 Too Many Requests\r\nContent-Length: {len(_TOO_MANY)}\r\n"
            transport.write(f"{head}Connection: close\r\n\r\n{_TOO_MANY}".encode())
            transport.close()
            # It counts no more among those beyond which Uvicorn answers 503, to others too.
            self.connections.discard(self)
        else:
            self.loop.call_later(PATIENCE_S, self._look)

    def shutdown(self) -> None:
        """End with the server; a first question may be on its way, which a reset would answer."""
        if not self._bounded.asked:
            self.loop.call_later(_LAST_S, super().shutdown)
        else:
            super().shutdown()

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no request, or one whose length is not stated."""
        super().send_400_response(_NO_LENGTH if self._bounded.unmeasured else msg)

    def _look(self) -> None:
        """Close a connection on which nothing is asked, or nothing of an answer taken."""
        if self.transport.is_closing():
            return
        before, self._seen = self._seen, (self.cycle, self.transport.get_write_buffer_size())
        waits = self.conn.their_state is h11.IDLE and self.cycle is before[0]
        if waits or 0 < self._seen[1] == before[1]:
            self.transport.abort()
        else:
            self.loop.call_later(PATIENCE_S, self._look)


class FewAtOnce:
    """ASGI middleware: of one client so many requests at once, beyond which 429 is answered."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._counts = Counter[str]()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        client = (scope.get("client") or ("",))[0]
        if scope["type"] == "http" and self._counts[client] >= MOST_REQUESTS:
            again = {"Retry-After": "5"}
            refusal = PlainTextResponse(_TOO_MANY, HTTPStatus.TOO_MANY_REQUESTS, again)
            await refusal(scope, receive, send)
            return
        self._counts[client] += 1
        try:
            await self.app(scope, receive, send)
        finally:
            self._counts[client] -= 1
            if not self._counts[client]:
                del self._counts[client]
