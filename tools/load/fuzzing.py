"""Requests that nobody should send: parameters, bodies, headers and bytes at random."""

from __future__ import annotations

import contextlib
import json
import random
import socket
from collections import Counter
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

METHODS = ("GET",) * 8 + ("POST", "POST", "HEAD", "OPTIONS", "PUT", "DELETE", "BREW")
NASTY = (
    *("", " ", "\x00", "%", "%zz", "%00", "%ff", "../../etc/passwd", "a" * 300, "☀", "\U0001f31e"),
    *("nan", "-1", "1e999", "0x10", "null", "true", "[]", "{}", "'", '"', "<script>", "&&", "=;="),
    *("9" * 400, "-0", "1_0", "+1", "\ud800", "İ", "None", "CMOS"),
)
HEADERS = (
    *("Accept: text/csv", "Accept: */*;q=0", "Accept: \x80", "Accept-Encoding: gzip, identity;q=0"),
    *("If-None-Match: *", 'If-None-Match: W/"', "Range: bytes=0-1", "Expect: 100-continue"),
    *("Content-Type: application/json", "Content-Type: text/plain", "Content-Encoding: gzip"),
    *("Origin: null", "Access-Control-Request-Method: POST", "X: " + "y" * 9000, "Host:"),
)


def request(draw: random.Random, paths: Mapping[str, Any]) -> bytes:
    """Return a request made of what the document's paths declare and of what they do not."""
    template, item = draw.choice(sorted(paths.items()))
    operation = draw.choice(list(item.values()))
    declared = operation.get("parameters", ())
    path = template
    pairs = []
    for parameter in declared:
        if parameter["in"] == "path":
            path = path.replace(f"{{{parameter['name']}}}", _value(draw, parameter["schema"]))
        elif draw.random() < 0.2 or parameter.get("required"):
            count = draw.choice((1, 1, 1, 2, 5))
            pairs += [(parameter["name"], _value(draw, parameter["schema"])) for _ in range(count)]
    if draw.random() < 0.15:
        pairs.append((draw.choice(NASTY), draw.choice(NASTY)))
    query = "&".join(f"{_spelt(draw, name)}={_spelt(draw, value)}" for name, value in pairs)
    if draw.random() < 0.05:
        path += draw.choice(("/", "//", "/..", "/%2e%2e/", "?", "#"))
    method = draw.choice(METHODS)
    target = (_spelt(draw, path, "/") + (f"?{query}" if query else "")).encode("utf-8", "replace")
    lines = [method.encode() + b" " + target.replace(b" ", b"+") + b" HTTP/1.1", b"Host: atlas"]
    lines += [h.encode("latin-1") for h in draw.sample(HEADERS, draw.choice((0, 0, 1, 2)))]
    body = _body(draw) if method == "POST" or draw.random() < 0.05 else b""
    if body:
        lines.append(f"Content-Length: {len(body)}".encode())
        lines.append(b"Content-Type: application/json")
    lines.append(b"Connection: close")
    whole = b"\r\n".join(lines) + b"\r\n\r\n" + body
    if draw.random() < 0.05:  # a byte that is another
        at = draw.randrange(len(whole))
        whole = whole[:at] + bytes([draw.randrange(256)]) + whole[at + 1 :]
    return whole


def fuzz(place: tuple[str, int], paths: Mapping[str, Any], count: int, seed: int) -> Counter[str]:
    """Send `count` requests; return how often each status came ("closed" for none).

    Raises
    ------
    AssertionError
        For a 5xx, with the request that caused it.
    """
    draw = random.Random(seed)
    found: Counter[str] = Counter()
    for _ in range(count):
        whole = request(draw, paths)
        status = _status(place, whole)
        found[status] += 1
        if status.startswith("5"):
            raise AssertionError(f"{status} to {whole[:2000]!r}")
    return found


def _status(place: tuple[str, int], whole: bytes) -> str:
    with socket.create_connection(place, timeout=600) as plug:
        try:
            plug.sendall(whole)
            with contextlib.suppress(OSError):  # it may have closed already, its answer on the way
                plug.shutdown(socket.SHUT_WR)
            head = b""
            while not (b"\r\n" in head and not head.startswith(b"HTTP/1.1 100")):
                data = plug.recv(65536)
                if not data:
                    return "closed"
                head += data
            while plug.recv(65536):
                pass
        except ConnectionError:
            return "closed"
    return head.split(b" ", 2)[1].decode()


def _value(draw: random.Random, schema: Mapping[str, Any]) -> str:
    inner = schema.get("items", schema)
    if "enum" in inner and draw.random() < 0.7:
        return str(draw.choice(inner["enum"]))
    if inner.get("type") in {"number", "integer"} and draw.random() < 0.7:
        return str(draw.choice((0, 1, 2, 0.5, 30, 500, 1e-300, 1e300, -5)))
    return draw.choice(NASTY)


def _spelt(draw: random.Random, text: str, safe: str = "") -> str:
    if draw.random() < 0.1:
        return text.replace("\r", "").replace("\n", "").replace("#", "")
    return quote(text, safe=safe, errors="replace")


def _body(draw: random.Random) -> bytes:
    kind = draw.randrange(6)
    if kind == 0:
        return bytes(draw.randrange(256) for _ in range(draw.randrange(200)))
    if kind == 1:
        return b"[" * draw.choice((10, 5000, 60000))
    if kind == 2:
        return b" " * draw.choice((70_000, 300_000))
    names = ("task", "detector", "mask", "sort", "limit", "max_error_deg", "survive", "x")
    values: tuple[Any, ...] = (*NASTY, None, [], {}, 1, -1.5, True, ["CMOS"], ["Accuracy"], 10**30)
    asked = {draw.choice(names): draw.choice(values) for _ in range(draw.randrange(4))}
    return json.dumps(asked).encode()
