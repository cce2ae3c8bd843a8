"""The service under a prefix that a proxy removes, such as /atlas: links hold as they are sent.

Whatever makes an answer knows addresses from "/"; one place puts the prefix before them.
"""

from __future__ import annotations

import csv
import io
import re

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from files.csv_writing import csv_text

#: Of a prefix: parts of unreserved characters (RFC 3986), which need no escaping anywhere.
PREFIX = re.compile(r"(?:/[A-Za-z0-9_~-][A-Za-z0-9._~-]*)+")
#: Where it stands in the scope; Starlette has it in `request.base_url`.
KEY = "app_root_path"
#: Members of JSON and columns of CSV whose values are addresses. Other texts may start with "/".
_NAMED = (
    *("address", "board", "csv", "flow", "href", "instance"),
    *("leads_to", "page", "preview", "studies", "url"),
)
_IN_JSON = re.compile(rb'("(?:%s)"\s*:\s*")(?=/(?!/))' % "|".join(_NAMED).encode())
_IN_HTML = re.compile(rb'(\s(?:action|data-plotly|data-spec|href|src)=")(?=/(?!/))')
#: Metadata of a page, whose every value that starts with "/" is an address.
_LINKED_DATA = re.compile(rb'<script type="application/ld\+json">.*?</script>', re.DOTALL)
_IN_LINKED_DATA = re.compile(rb'([:\[,]\s*")(?=/(?!/))')
_IN_HEADERS = {"location": re.compile(r"\A()(?=/(?!/))"), "link": re.compile(r"(<)(?=/(?!/))")}


class ForwardedPrefix(ProxyHeadersMiddleware):
    """ASGI middleware, the outermost: what a trusted proxy says, with `X-Forwarded-Prefix`.

    Uvicorn puts its `root_path` before the path that came, which the proxy had stripped; here it is
    stripped again, and kept beside. The header, of a trusted proxy alone, stands above it.
    """

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # type: ignore[override]
        """Pass a connection on."""
        if scope["type"] == "http":
            own, client = scope.get("root_path", ""), (scope.get("client") or (None,))[0]
            said = Headers(scope=scope).get("x-forwarded-prefix", "").rstrip("/")
            trusted = client in self.trusted_hosts and PREFIX.fullmatch(said)
            scope = {
                **scope,
                "path": scope["path"].removeprefix(own),
                "raw_path": scope["raw_path"].removeprefix(own.encode()),
                "root_path": "",
                KEY: said if trusted else own,
            }
        await super().__call__(scope, receive, send)  # type: ignore[arg-type]


class UnderPrefix:
    """ASGI middleware: puts the prefix before the addresses in pages, documents and headers.

    It stands within the compression and the digest of what travels, so that ETags of a document
    under two prefixes differ, and outside all caches, whose entries have no prefix.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a connection on, changing what comes back where there is a prefix."""
        prefix = scope.get(KEY)
        if scope["type"] != "http" or not prefix:
            await self.app(scope, receive, send)
            return
        begin: Message = {}
        body = b""

        async def prefixed(message: Message) -> None:
            nonlocal begin, body
            if message["type"] == "http.response.start":
                begin = message
                return
            body += message.get("body", b"")
            if message.get("more_body"):
                return
            headers = MutableHeaders(raw=begin["headers"])
            for name, places in _IN_HEADERS.items():
                if name in headers:
                    headers[name] = places.sub(rf"\1{prefix}", headers[name])
            if "content-encoding" not in headers:
                body = under(prefix, body, headers.get("content-type", ""))
                headers["content-length"] = str(len(body))
            await send(begin)
            await send({"type": "http.response.body", "body": body})

        await self.app(scope, receive, prefixed)


def under(prefix: str, body: bytes, content_type: str) -> bytes:
    """Return a body with a prefix before the addresses on this service that it holds.

    Parameters
    ----------
    prefix : such as "/atlas"
    body : in UTF-8, where it is a text
    content_type : of the body; what is no HTML, JSON or CSV stays as it is
    """
    before = rb"\1" + prefix.encode()
    kind = content_type.partition(";")[0]
    if kind == "text/html":
        body = _IN_HTML.sub(before, body)
        return _LINKED_DATA.sub(lambda found: _IN_LINKED_DATA.sub(before, found[0]), body)
    if kind.endswith("json"):
        return _IN_JSON.sub(before, body)
    header = body.partition(b"\n")[0].decode().split(",") if kind == "text/csv" else []
    if set(_NAMED).isdisjoint(header):
        return body
    _, *rows = csv.reader(io.StringIO(body.decode(), newline=""))
    return csv_text(
        header,
        (
            [
                prefix + cell if name in _NAMED and cell.startswith("/") else cell
                for name, cell in zip(header, row, strict=True)
            ]
            for row in rows
        ),
    ).encode()
