"""Answers that no archive should give, byte for byte, and in words what each of them is.

The first four are those that a review of the client found (`archive-replies.json`), the others are
made up in their manner.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

#: Where a reply is bytes they are sent and the connection is closed.
Reply = bytes | Callable[[Callable[[bytes], Any]], None]


def reply(
    status: int = 200, body: bytes = b"{}", length: int | None = None, **headers: str
) -> bytes:
    """Return an answer; `length` where it is not that of the body."""
    sent = {
        "Content-Type": "application/json",
        "Content-Length": str(len(body) if length is None else length),
        **{name.replace("_", "-"): value for name, value in headers.items()},
        "Connection": "close",
    }
    lines = [f"HTTP/1.1 {status} Whatever", *(f"{n}: {v}" for n, v in sent.items() if v)]
    return "\r\n".join(lines).encode("latin-1") + b"\r\n\r\n" + body


def of(document: Any, status: int = 200, **headers: str) -> bytes:
    """Return an answer that holds a document."""
    return reply(status, json.dumps(document).encode(), **headers)


@cache
def bomb(megabytes: int = 300) -> bytes:
    """Return so many zeros, compressed; cut before the checksum, which nobody is to reach."""
    packer = zlib.compressobj(9, wbits=31)
    head, next_one = (
        packer.compress(bytes(1 << 20)) + packer.flush(zlib.Z_FULL_FLUSH) for _ in range(2)
    )
    return head + (megabytes - 1) * next_one


def drip(send: Callable[[bytes], Any]) -> None:
    """Send a header now and then a space every moment, for as long as somebody reads."""
    import time

    send(reply(length=1_000_000, body=b""))
    for _ in range(2000):
        send(b" ")
        time.sleep(0.05)


def replies() -> Mapping[str, Reply]:
    """Return the answers by what they are."""
    record = {"id": "ab001-c0de", "links": {}, "metadata": {}}
    return {
        "errors is a number": of({"errors": 5}, 400),
        "Retry-After is a superscript": of({}, 429, Retry_After="²"),
        "200,000 arrays deep": reply(body=b"[" * 200_000 + b"]" * 200_000),
        "300 MB of zeros in gzip": reply(body=bomb(), Content_Encoding="gzip"),
        "a page for people": reply(body=b"<html>log in</html>", Content_Type="text/html"),
        "no member at all": of({}),
        "a list": of([record]),
        "an identifier that is a list": of({**record, "id": [1]}),
        "an identifier of 5,000 digits": reply(body=b'{"id": ' + b"9" * 5000 + b"}"),
        "nothing": reply(body=b""),
        "cut in the middle": reply(body=json.dumps(record).encode()[:-9]),
        "shorter than it says": reply(body=b'{"id": "a', length=500),
        "chunks that are none": reply(
            body=b"zz\r\n{}\r\n0\r\n\r\n", Content_Length="", Transfer_Encoding="chunked"
        ),
        "UTF-16": reply(
            body=json.dumps(record).encode("utf-16"),
            Content_Type="application/json; charset=utf-16",
        ),
        "50 MB of spaces": reply(body=b" " * (50 << 20)),
        "a byte every moment": drip,
        "creators that are numbers": of({**record, "metadata": {"creators": [5]}}),
        "gzip that is none": reply(body=b"not packed", Content_Encoding="gzip"),
    }


def more_replies() -> Mapping[str, Reply]:
    """Return further ones."""
    record = {"id": "ab001-c0de", "links": {}, "metadata": {}}
    whole = gzip.compress(json.dumps(record).encode())
    return {
        "gzip cut short": reply(body=whole[:-9], Content_Encoding="gzip"),
        "gzip with more behind it": reply(body=whole + whole, Content_Encoding="gzip"),
        "a packing of its own": reply(body=b"{}", Content_Encoding="br"),
        "packed twice": reply(body=gzip.compress(whole), Content_Encoding="gzip, gzip"),
        "Latin-1": reply(body='{"id": "é"}'.encode("latin-1")),
        "an unknown charset": of(record, Content_Type="application/json; charset=klingon"),
        "no content type": of(record, Content_Type=""),
        "NaN": reply(body=b'{"id": NaN}'),
        "a truth value": of(True),
        "null": of(None),
        "a bucket whose address is none": of({**record, "links": {"bucket": "http://[::1"}}),
        "a bucket that is a number": of({**record, "links": {"bucket": 5}}),
        "an identifier with a path in it": of({**record, "id": "../../users"}),
        "an identifier with escape codes": of({**record, "id": "\x1b[2J"}),
        "metadata that are text": of({**record, "metadata": "none"}),
        "orcid that is a number": of(
            {
                **record,
                "metadata": {
                    "creators": [
                        {
                            "name": "A, B",
                            "orcid": 5,
                            "person_or_org": {"type": "personal", "identifiers": [7]},
                        }
                    ]
                },
            }
        ),
        "links that are a list": of({**record, "links": ["a"]}),
        "a redirect to nowhere": of({}, 302, Location="http://[::1"),
        "a redirect to itself": of({}, 302, Location="/api/records"),
        "a status of its own": of({}, 299),
        "no change": of({}, 304),
        "a refusal in escape codes": of({"message": "\x1b]0;owned\x07\u202e" + "x" * 5000}, 400),
        "a refusal that is a list": of([1, 2], 403),
        "a refusal 200,000 deep": reply(400, b"[" * 200_000),
        "a refusal of 50 MB": reply(500, b'"' + b"x" * (50 << 20) + b'"'),
        "reasons without a field": of({"errors": [{}, 5, {"messages": {}}]}, 400),
        "Retry-After without an end": of({}, 429, Retry_After="9" * 400),
        "Retry-After in the past": of({}, 429, Retry_After="Thu, 01 Jan 1970 00:00:00 GMT"),
        "Retry-After that is no date": of({}, 503, Retry_After="Thu, 99 Foo 99999 00:00:00 GMT"),
        "X-RateLimit-Reset that is no number": of({}, 429, X_RateLimit_Reset="nan"),
        "X-RateLimit-Reset without an end": of({}, 429, X_RateLimit_Reset="inf"),
        "no HTTP": b"SSH-2.0-OpenSSH_9.6\r\n",
        "nothing at all": b"",
        "a header without an end": b"HTTP/1.1 200 OK\r\nX: " + b"x" * 300_000,
        "headers that are none": b"HTTP/1.1 200 OK\r\n\x00\xff: \r\n\r\n{}",
    }
