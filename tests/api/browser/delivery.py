"""Pages that come in pieces, as they do over a network."""

from __future__ import annotations

import asyncio

from starlette.types import ASGIApp, Message, Receive, Scope, Send

#: Short for a person, long for a test that looks before the whole page is there.
PAUSE_S = 0.3


class InPieces:
    """The service, with a pause after the first tenth of every HTML page.

    On loopback a page arrives at once, but on a busy machine: a test that judges what has not come
    yet would pass here and fail there. So no page comes at once anywhere.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        page = False

        async def halting(message: Message) -> None:
            nonlocal page
            if message["type"] == "http.response.start":
                kind = dict(message["headers"]).get(b"content-type", b"")
                page = kind.startswith(b"text/html")
            elif page and message["type"] == "http.response.body":
                body = bytes(message.get("body", b""))
                head = len(body) // 10
                await send({**message, "body": body[:head], "more_body": True})
                await asyncio.sleep(PAUSE_S)
                message = {**message, "body": body[head:]}
            await send(message)

        await self.app(scope, receive, halting)
