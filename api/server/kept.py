"""Answers that are computed once: what a process knows does not change as long as it runs."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Mapping
from typing import Any, NamedTuple

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.server.prefix import KEY as PREFIX

#: Bytes of all answers kept, and of the largest: the pages that many ask for are a tenth of it.
MOST, LARGEST = 32_000_000, 1_000_000
#: Files are read anew: it costs little, and the guide may be built meanwhile.
_FILES = ("/guide/", "/page/")


class _Kept(NamedTuple):
    messages: list[Message]
    size: int
    route: Any  # which counts name


class KeptAnswers:
    """ASGI middleware: of equal questions the first is answered below, the others from memory.

    The start page takes 70 ms of the processor, in which its process answers nobody else. Kept are
    answers to GET of status 200 that may be stored (no ``no-store``); those not asked for the
    longest time go first.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._kept = OrderedDict[Hashable, _Kept]()
        self._size = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a question, or pass it on."""
        if scope["type"] != "http" or scope["method"] != "GET" or scope["path"].startswith(_FILES):
            await self.app(scope, receive, send)
            return
        question = _question(scope)
        if question in self._kept:
            self._kept.move_to_end(question)
            kept = self._kept[question]
            scope["route"] = kept.route
            for message in kept.messages:
                await send(_copied(message))
            return
        messages: list[Message] = []

        async def noted(message: Message) -> None:
            messages.append(_copied(message))
            await send(message)

        await self.app(scope, receive, noted)
        self._keep(question, messages, scope.get("route"))

    def _keep(self, question: Hashable, messages: list[Message], route: Any) -> None:
        headers = Headers(raw=messages[0]["headers"]) if messages else {}
        size = sum(len(message.get("body", b"")) for message in messages)
        whole = messages and messages[0]["status"] == 200 and not messages[-1].get("more_body")
        if not whole or "no-store" in headers.get("cache-control", "") or size > LARGEST:
            return
        kept = _Kept(messages, size, route)
        before = self._kept.pop(question, None)  # two may have asked at once
        self._size += size - (before.size if before else 0)
        self._kept[question] = kept
        while self._size > MOST:
            self._size -= self._kept.popitem(last=False)[1].size


def _question(scope: Scope) -> Hashable:
    """Return all of a request that an answer depends on."""
    said = Headers(scope=scope)
    packed = "gzip" in said.get("accept-encoding", "")
    place = (scope["scheme"], said.get("host"), scope.get(PREFIX))
    return (*place, scope["path"], scope["query_string"], said.get("accept"), packed)


def _copied(message: Mapping[str, Any]) -> Message:
    """Return a message whose headers may be changed."""
    headers = {"headers": list(message["headers"])} if "headers" in message else {}
    return {**message, **headers}
