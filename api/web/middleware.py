"""What holds for every response: security headers, who may read, HEAD as GET without a body."""

from __future__ import annotations

import time

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.web.observation import keep

_POLICY = {
    "default-src": "'none'",
    "script-src": "'self'",
    # Documentation that is served beside the pages carries style attributes.
    "style-src": "'self' 'unsafe-inline'",
    # Downloads are made in the page.
    "img-src": "'self' data: blob:",
    "font-src": "'self'",
    "connect-src": "'self'",
    "manifest-src": "'self'",
    "base-uri": "'none'",
    "form-action": "'self'",
    "frame-ancestors": "'none'",
}
CONTENT_SECURITY_POLICY = "; ".join(f"{name} {sources}" for name, sources in _POLICY.items())
SECURITY_HEADERS = [
    (b"content-security-policy", CONTENT_SECURITY_POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"permissions-policy", b"camera=(), geolocation=(), microphone=()"),
]


#: What a page of any other site may read: all there is to read, as nothing here is secret and
#: nobody logs in. The page itself is for this site alone.
SHARED_HEADERS = [
    (b"access-control-allow-origin", b"*"),
    (b"access-control-expose-headers", b"ETag, Link, Retry-After"),
    (b"cross-origin-resource-policy", b"cross-origin"),
]
OWN_HEADERS = [(b"cross-origin-resource-policy", b"same-origin")]
PREFLIGHT_HEADERS = [
    (b"access-control-allow-methods", b"GET, HEAD, POST"),
    (b"access-control-allow-headers", b"Accept, Content-Type, If-None-Match"),
    (b"access-control-max-age", b"86400"),
    (b"content-length", b"0"),
    (b"vary", b"Origin, Access-Control-Request-Method"),
]


def is_shared(path: str) -> bool:
    """Say whether pages of other sites may read what stands at a path."""
    return path.startswith("/v1/") or path.endswith((".json", ".csv")) or path == "/healthz"


class EveryResponse:
    """ASGI middleware: adds the headers and answers HEAD by GET without its body.

    What is answered is counted, timed and logged (`api.web.observation`); a failure counts as 500.
    A browser's question whether another site may ask (a preflight) is answered here.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a connection on, changing what comes back."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        shared = is_shared(scope["path"])
        more = [*SECURITY_HEADERS, *(SHARED_HEADERS if shared else OWN_HEADERS)]
        if shared and scope["method"] == "OPTIONS" and _is_preflight(scope):
            headers = [*more, *PREFLIGHT_HEADERS]
            await send({"type": "http.response.start", "status": 204, "headers": headers})
            await send({"type": "http.response.body", "body": b""})
            return
        head = scope["method"] == "HEAD"
        inner = {**scope, "method": "GET"} if head else scope
        status, length = 500, 0
        start = time.perf_counter()

        async def decorated(message: Message) -> None:
            nonlocal status, length
            if message["type"] == "http.response.start":
                status = message["status"]
                message["headers"] = [*message["headers"], *more]
            elif message["type"] == "http.response.body":
                if head:
                    message["body"] = b""
                length += len(message.get("body", b""))
            await send(message)

        try:
            await self.app(inner, receive, decorated)
        finally:
            keep(inner, status, length, time.perf_counter() - start)


def _is_preflight(scope: Scope) -> bool:
    names = {name for name, _ in scope["headers"]}
    return {b"origin", b"access-control-request-method"} <= names
