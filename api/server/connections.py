"""What one client may take of a server: connections, requests, and time to ask.

A proxy in front knows clients better (deploy/Caddyfile); this is for servers without one.
"""

from __future__ import annotations

import asyncio
from asyncio import Transport
from collections import Counter
from collections.abc import Callable, Container
from functools import partial
from http import HTTPStatus
from typing import Any, ClassVar

import h11
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

#: Of one address, in a process of the server.
MOST_CONNECTIONS, MOST_REQUESTS = 100, 100
#: Requests, and connections, of one address a second, after the first so many, as of some pages
#: with their parts: what comes faster waits for its turn.
MOST_PER_S, AT_ONCE = 20.0, 100
#: Who is refused hears so after a while, and cannot come again at once; so many wait at most.
REFUSED_AFTER_S, MOST_REFUSED = 1.0, 1000
#: Addresses remembered, beyond which those are forgotten that have not asked for a while.
MOST_KNOWN = 1000
#: Within which a head has to arrive, and part of an answer to be taken.
PATIENCE_S = 10.0
#: Within which who has just connected may still ask a server that ends.
_LAST_S = 0.5
#: How long a client may send on that has its answer.
_LINGER_S = 30.0
#: Bytes that are read at once: asyncio's own 256 KiB cost a millisecond to parse.
_READ = 2**16
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


class _Turns:
    """When those who come too often have their turns, by address."""

    def __init__(self) -> None:
        #: When what each has asked would be through, were it answered evenly; of the loop's clock.
        self._through: dict[str, float] = {}

    def wait_s(self, host: str, now: float) -> float:
        """Return how long one more of this address waits."""
        rested = now - AT_ONCE / MOST_PER_S
        if len(self._through) > MOST_KNOWN:
            self._through = {name: at for name, at in self._through.items() if at > rested}
        through = max(self._through.get(host, rested), rested) + 1 / MOST_PER_S
        self._through[host] = through
        return max(0.0, through - now)


class BoundedProtocol(H11Protocol):
    """HTTP as Uvicorn speaks it, to clients that ask in time and keep few connections.

    A proxy may keep any number: an address that Uvicorn trusts to forward those of clients, by
    default 127.0.0.1 (`FORWARDED_ALLOW_IPS`).
    """

    _refused: ClassVar[set[BoundedProtocol]] = set()
    _turns: ClassVar = _Turns()

    def __init__(self, *args: Any, **named: Any) -> None:
        super().__init__(*args, **named)
        self.conn = self._bounded = _Connection(h11.SERVER)
        self._seen: tuple[Any, int] = (None, 0)
        self._is_over = False

    def connection_made(self, transport: Transport) -> None:  # type: ignore[override]
        """Take a connection in its turn, or refuse it where the address has too many."""
        super().connection_made(transport)
        transport.max_size = _READ  # type: ignore[attr-defined]  # of asyncio's
        host = self.client[0] if self.client else ""
        proxies = getattr(self.app, "trusted_hosts", ())  # of the middleware that trusts them
        clients = [getattr(one, "client", None) or ("", 0) for one in self.connections]
        count = sum(client[0] == host for client in clients)
        if count > MOST_CONNECTIONS and host not in proxies:
            # It counts no more among those beyond which Uvicorn answers 503, to others too.
            self.connections.discard(self)
            self._refuse(self._say_too_many)
            return
        wait_s = 0.0 if host in proxies else self._turns.wait_s(host, self.loop.time())
        if wait_s:
            transport.pause_reading()
            self.loop.call_later(wait_s, self._begin)
        self.loop.call_later(wait_s + PATIENCE_S, self._look)

    def _begin(self) -> None:
        if not self.transport.is_closing():
            self.transport.resume_reading()

    def _say_too_many(self) -> None:
        head = f"HTTP/1.1 429 Too Many Requests\r\nContent-Length: {len(_TOO_MANY)}\r\n"
        self.transport.write(f"{head}Connection: close\r\n\r\n{_TOO_MANY}".encode())
        self.transport.close()

    def shutdown(self) -> None:
        """End with the server; a first question may be on its way, which a reset would answer."""
        if not self._bounded.asked:
            self.loop.call_later(_LAST_S, super().shutdown)
        else:
            super().shutdown()

    def data_received(self, data: bytes) -> None:
        """Take what comes; nothing more of a request that is answered, such as a refused one."""
        if not self._is_over:
            super().data_received(data)

    def on_response_complete(self) -> None:
        """Go on with the next request, or end where the client is still sending this one.

        It may send on for a while, unheard: were it cut off, it might never read the answer.
        """
        if self.conn.their_state is not h11.SEND_BODY:
            super().on_response_complete()
        elif not self.transport.is_closing():
            self._is_over = True
            self.transport.write_eof()
            self.loop.call_later(_LINGER_S, self.transport.abort)

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no request, or one whose length is not stated."""
        said = _NO_LENGTH if self._bounded.unmeasured else msg
        self._refuse(partial(super().send_400_response, said))

    def _refuse(self, say: Callable[[], object]) -> None:
        """Say no, after a while, and read nothing of this connection meanwhile."""
        if len(self._refused) >= MOST_REFUSED:
            self.transport.abort()
            return

        def late() -> None:
            self._refused.discard(self)
            if not self.transport.is_closing():
                say()

        self._refused.add(self)
        self.transport.pause_reading()
        self.loop.call_later(REFUSED_AFTER_S, late)

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
    """ASGI middleware: what one client may ask at once, beyond which 429 is answered, and a second.

    Parameters
    ----------
    app : the service
    proxies : addresses that ask for many clients
    """

    def __init__(self, app: ASGIApp, proxies: Container[str] = ()) -> None:
        self.app = app
        self.proxies = proxies
        self._counts = Counter[str]()
        self._turns = _Turns()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on in its turn, or refuse it."""
        client = (scope.get("client") or ("",))[0]
        if scope["type"] == "http" and self._counts[client] >= MOST_REQUESTS:
            again = {"Retry-After": "5"}
            refusal = PlainTextResponse(_TOO_MANY, HTTPStatus.TOO_MANY_REQUESTS, again)
            await refusal(scope, receive, send)
            return
        self._counts[client] += 1
        try:
            if client not in self.proxies:
                now = asyncio.get_running_loop().time()
                if wait_s := self._turns.wait_s(client, now):
                    await asyncio.sleep(wait_s)
            await self.app(scope, receive, send)
        finally:
            self._counts[client] -= 1
            if not self._counts[client]:
                del self._counts[client]
