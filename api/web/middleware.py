"""What holds for every response: security, who may read, ETag and 304, parts, HEAD as GET."""

from __future__ import annotations

import hashlib
import re
import time

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.web.observation import count
from api.web.ranges import parted

CONTENT_SECURITY_POLICY = (
    # Documentation beside the pages carries style attributes; downloads are made in the page.
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; manifest-src 'self'; "
    "base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
)
SECURITY_HEADERS = {
    "content-security-policy": CONTENT_SECURITY_POLICY,
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=()",
}
#: What a page of any other site may read: all there is to read, as nothing here is secret and
#: nobody logs in. The page itself is for this site alone.
SHARED_HEADERS = {
    "access-control-allow-origin": "*",
    "access-control-expose-headers": "Accept-Ranges, Content-Range, ETag, Link, Retry-After",
    "cross-origin-resource-policy": "cross-origin",
}
OWN_HEADERS = {"cross-origin-resource-policy": "same-origin"}
PREFLIGHT_HEADERS = {
    "access-control-allow-methods": "GET, HEAD, POST",
    "access-control-allow-headers": "Accept, Content-Type, If-None-Match, If-Range, Range",
    "access-control-max-age": "86400",
    "vary": "Origin, Access-Control-Request-Method",
}


#: An Accept-Encoding that Starlette, which looks for the word, would take for a yes.
_NO_GZIP = re.compile(rb"gzip\s*;\s*q=0(\.0*)?\s*(,|\Z)", re.IGNORECASE)


def is_shared(path: str) -> bool:
    """Say whether pages of other sites may read what stands at a path."""
    return path.startswith("/v1/") or path.endswith((".json", ".csv")) or path == "/healthz"


class EveryResponse:
    """ASGI middleware, the outermost: headers, validators, HEAD as GET, and counts.

    An answer without `Cache-Control` may be stored and has to be revalidated: facts and scores
    change with a release. Its strong ETag is a digest of the bytes that travel, so this stands
    outside the compression. A failure counts as 500. A browser's question whether another site may
    ask (a preflight) is answered here.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a connection on, changing what comes back."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        asked, method, shared = Headers(scope=scope), scope["method"], is_shared(scope["path"])
        more = {**SECURITY_HEADERS, **(SHARED_HEADERS if shared else OWN_HEADERS)}
        preflight = method == "OPTIONS" and "access-control-request-method" in asked
        if shared and preflight and "origin" in asked:
            await Response(None, 204, {**more, **PREFLIGHT_HEADERS})(scope, receive, send)
            return
        taken = [
            (name, value)
            for name, value in scope["headers"]
            # a range counts the bytes of the content, not of its compression
            if not (name == b"accept-encoding" and ("range" in asked or _NO_GZIP.search(value)))
        ]
        inner = {**scope, "headers": taken, "method": "GET" if method == "HEAD" else method}
        begin: Message = {"status": 500}
        body = b""
        start = time.perf_counter()

        async def decorated(message: Message) -> None:
            nonlocal begin, body
            if message["type"] == "http.response.start":
                begin = message  # sent with its body, whose digest it carries
                return
            body += message.get("body", b"")
            if message.get("more_body"):
                return
            headers = MutableHeaders(raw=begin["headers"])
            headers.update(more)
            if begin["status"] == 200 and headers.get("cache-control") != "no-store":
                headers.setdefault("cache-control", "no-cache")
                headers["etag"] = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
                if inner["method"] == "GET" and _matches(asked, headers["etag"]):
                    begin["status"], body = 304, b""
                    for name in ("content-type", "content-length", "content-encoding"):
                        del headers[name]
                elif inner["method"] == "GET":
                    whole = Headers() if method == "HEAD" else asked
                    begin["status"], body = parted(whole, headers, body)
            await send(begin)
            await send({"type": message["type"], "body": b"" if method == "HEAD" else body})

        try:
            await self.app(inner, receive, decorated)
        finally:
            count(inner, begin["status"], time.perf_counter() - start)


def _matches(asked: Headers, etag: str) -> bool:
    """Compare If-None-Match, a list or `*`, weakly with an ETag (RFC 9110, 13.1.2)."""
    known = asked.get("if-none-match", "").split(",")
    return any(one.strip() in {"*", etag, f"W/{etag}"} for one in known)
