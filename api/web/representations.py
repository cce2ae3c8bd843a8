"""Bytes ready to send: body, gzip and ETag each computed once, and answers by 304."""

from __future__ import annotations

import gzip
import hashlib
import re
from collections import OrderedDict
from collections.abc import Hashable, Mapping
from functools import cached_property

from fastapi import Request, Response

from api.web.negotiation import accepts_gzip
from files.csv_writing import escape_formulas

WORTH_COMPRESSING = 512  # bytes; below, the gzip frame eats what it saves
REVALIDATE = (
    "no-cache"  # may be stored, must be revalidated: facts and scores change with a release
)

_ENTITY_TAG = re.compile(r'(?:W/)?"([\x21\x23-\x7e\x80-\xff]*)"')


def digest_of(body: bytes) -> str:
    """Return a digest of a body for its ETag."""
    # Processors have instructions for SHA-256: it takes half the time of BLAKE2 and less.
    return hashlib.sha256(body).hexdigest()[:32]


class Representation:
    """A body as it is sent, with what HTTP needs to know about it.

    Parameters
    ----------
    body : the bytes without content coding
    content_type : value of the header
    headers : further headers, such as `Link`
    compressible : whether gzip is worth trying
    digest : digest that identifies the body, if making it gave one; computed when it is needed
        otherwise
    """

    def __init__(
        self,
        body: bytes,
        content_type: str,
        headers: Mapping[str, str] | None = None,
        *,
        compressible: bool = True,
        digest: str | None = None,
    ) -> None:
        self.body = body
        if digest is not None:
            self.digest = digest
        self.compressible = compressible and len(body) >= WORTH_COMPRESSING
        self._common = {
            "Content-Type": content_type,
            "Cache-Control": REVALIDATE,
            "Vary": "Accept, Accept-Encoding",
            **(headers or {}),
        }

    @cached_property
    def digest(self) -> str:
        """Digest of the body: the opaque part of its ETag."""
        return digest_of(self.body)

    @cached_property
    def gzip_body(self) -> bytes:
        """The body in gzip, without a time stamp: same body, same bytes."""
        return gzip.compress(self.body, compresslevel=6, mtime=0)

    @cached_property
    def _plain_headers(self) -> dict[str, str]:
        return {**self._common, "ETag": f'"{self.digest}"'}

    @cached_property
    def _gzip_headers(self) -> dict[str, str]:
        # A strong validator names bytes, and these are others.
        return {**self._common, "ETag": f'"{self.digest}-gzip"', "Content-Encoding": "gzip"}

    def link(self, *links: str) -> Representation:
        """Return the same bytes with further values of the Link header."""
        if not links:
            return self
        before = [self._common["Link"]] if "Link" in self._common else []
        made = self._of(self.body, {**self._common, "Link": ", ".join((*before, *links))})
        if "digest" in vars(self):
            made.digest = self.digest
        return made

    def for_spreadsheets(self) -> Representation:
        """Return a CSV of which a spreadsheet runs no cell (`csv_writing.escape_formulas`)."""
        return self._of(escape_formulas(self.body.decode()).encode(), self._common)

    def _of(self, body: bytes, headers: Mapping[str, str]) -> Representation:
        return Representation(
            body, headers["Content-Type"], headers, compressible=self.compressible
        )

    def respond(self, request: Request, *, conditional: bool = True) -> Response:
        """Return the response to `request`: 304 where the client has these bytes already.

        `conditional` is false for methods other than GET and HEAD, which have no 304.
        """
        zipped = self.compressible and accepts_gzip(request.headers.get("accept-encoding"))
        headers = self._gzip_headers if zipped else self._plain_headers
        if_none_match = request.headers.get("if-none-match") if conditional else None
        if if_none_match is not None and matches(if_none_match, headers["ETag"]):
            kept = {
                name: value
                for name, value in headers.items()
                if name not in {"Content-Type", "Content-Encoding"}
            }
            return Response(status_code=304, headers=kept)
        return Response(self.gzip_body if zipped else self.body, headers=headers)

    def __len__(self) -> int:
        return len(self.body)


def matches(if_none_match: str, etag: str) -> bool:
    """Compare weakly (RFC 9110, 13.1.2) an If-None-Match header, a list or `*`, with an ETag."""
    if if_none_match.strip() == "*":
        return True
    return etag.strip('"') in _ENTITY_TAG.findall(if_none_match)


class RepresentationCache:
    """Least-recently-used representations, bounded by number and by bytes.

    Parameters
    ----------
    most : how many are kept
    most_bytes : how many bytes of bodies are kept together
    """

    def __init__(self, most: int = 1024, most_bytes: int = 64 * 2**20) -> None:
        self.most = most
        self.most_bytes = most_bytes
        self.bytes = 0
        self._kept: OrderedDict[Hashable, Representation] = OrderedDict()

    def get(self, key: Hashable) -> Representation | None:
        """Return what is kept under `key`, now the most recently used; None if nothing is."""
        found = self._kept.get(key)
        if found is not None:
            self._kept.move_to_end(key)
        return found

    def put(self, key: Hashable, representation: Representation) -> None:
        """Keep `representation`, dropping the least recently used beyond the bounds."""
        old = self._kept.pop(key, None)
        if old is not None:
            self.bytes -= len(old)
        self._kept[key] = representation
        self.bytes += len(representation)
        while len(self._kept) > 1 and (len(self._kept) > self.most or self.bytes > self.most_bytes):
            _, dropped = self._kept.popitem(last=False)
            self.bytes -= len(dropped)

    def __len__(self) -> int:
        return len(self._kept)
