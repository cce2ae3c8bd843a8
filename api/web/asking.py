"""Asking the service in its own process: for `sunatlas get`, and before the first visitor does."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any
from urllib.parse import unquote

from starlette.types import ASGIApp

_PICTURE = re.compile(r'<img [^>]*src="(?P<path>[^"#]+\.svg)"')


async def visit_start_page(service: ASGIApp) -> None:
    """Ask for the start page and its pictures, so that no visitor waits for what draws to load."""
    _, page = await fetch_answer(service, "/", "", b"text/html")
    for path in sorted(set(_PICTURE.findall(page.decode()))):
        await fetch_answer(service, path, "", b"image/svg+xml")


async def fetch_answer(service: ASGIApp, path: str, query: str, accept: bytes) -> tuple[int, bytes]:
    """Return status and body of a GET that an ASGI application answers."""
    scope = {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": "GET",
        "scheme": "http",
        "path": unquote(path),
        "raw_path": path.encode(),
        "query_string": query.encode(),
        "root_path": "",
        "headers": [(b"host", b"localhost"), (b"accept", accept)],
        "client": ("127.0.0.1", 0),
        "server": ("localhost", 80),
    }
    status, body = 500, bytearray()

    async def receive() -> Mapping[str, Any]:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Mapping[str, Any]) -> None:
        nonlocal status
        if message["type"] == "http.response.start":
            status = message["status"]
        else:
            body.extend(message.get("body", b""))

    await service(scope, receive, send)  # type: ignore[arg-type]  # ASGI's messages are mappings
    return status, bytes(body)
