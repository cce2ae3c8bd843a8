"""Parts of a response (RFC 9110, 14), for who was cut off or needs a column of a file alone."""

from __future__ import annotations

import re
from http import HTTPStatus

from starlette.datastructures import Headers, MutableHeaders

#: More ranges than a reader of Parquet asks for at once.
MOST_RANGES = 100
_RANGES = re.compile(r"bytes\s*=\s*(.+)", re.IGNORECASE | re.ASCII)
_RANGE = re.compile(r"\s*(\d{0,18})-(\d{0,18})\s*", re.ASCII)


def ranges(asked: str, size: int) -> list[range] | None:
    """Return the satisfiable byte ranges of a `Range` header, or None where it is to be ignored.

    It is where it is malformed, of another unit, of more than `MOST_RANGES`, or where its ranges
    together are longer than the content.
    """
    match = _RANGES.fullmatch(asked.strip())
    pairs = [_RANGE.fullmatch(one) for one in match[1].split(",")] if match else []
    found = []
    for pair in pairs:
        first, last = pair.groups() if pair else ("", "")
        if not first + last or (first and last and int(last) < int(first)):
            return None
        start = int(first) if first else max(0, size - int(last))
        stop = min(int(last) + 1, size) if first and last else size
        found += [range(start, stop)] if start < stop else []
    if not 0 < len(pairs) <= MOST_RANGES or sum(map(len, found)) > size:
        return None
    return found


def parted(asked: Headers, headers: MutableHeaders, body: bytes) -> tuple[int, bytes]:
    """Return status and body of the answer to a request for a part; its headers are changed.

    Parameters
    ----------
    asked : headers of the request
    headers : of the whole answer, with its ETag
    body : the whole of it
    """
    headers["accept-ranges"] = "bytes"
    known = asked.get("if-range", headers["etag"]) == headers["etag"]
    found = ranges(asked.get("range", ""), len(body)) if known else None
    if found is None:
        return HTTPStatus.OK, body
    if not found:
        headers["content-range"], headers["content-length"] = f"bytes */{len(body)}", "0"
        del headers["content-type"]
        return HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE, b""
    stated = [f"bytes {one.start}-{one.stop - 1}/{len(body)}" for one in found]
    parts = [body[one.start : one.stop] for one in found]
    if len(parts) == 1:
        headers["content-range"], part = stated[0], parts[0]
    else:
        boundary, kind = headers["etag"].strip('"'), headers["content-type"]
        heads = [
            f"--{boundary}\r\nContent-Type: {kind}\r\nContent-Range: {one}\r\n\r\n".encode()
            for one in stated
        ]
        part = b"".join(b"%s%s\r\n" % both for both in zip(heads, parts, strict=True))
        part += f"--{boundary}--\r\n".encode()
        headers["content-type"] = f"multipart/byteranges; boundary={boundary}"
    headers["content-length"] = str(len(part))
    return HTTPStatus.PARTIAL_CONTENT, part
