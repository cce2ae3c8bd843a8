"""From a request to bytes: parameters, media type, the cache, and only then the computing."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fastapi import Request, Response
from pydantic_core import to_json

from api.http.negotiation import CONTENT_TYPES, CSV, JSON, media_type
from api.http.parameters import Arguments, Parameters
from api.http.representations import Representation, RepresentationCache
from api.http.tables import to_csv

OFFERED = (JSON, CSV)
MOST_SPELLINGS = 4096  # of requests whose meaning is remembered


@dataclass(frozen=True)
class Answer:
    """What an endpoint says, before it is bytes.

    Attributes
    ----------
    document : the JSON object
    columns : columns of the CSV that stand even without rows
    rows : rows of the CSV
    link : value of the Link header, if any
    """

    document: Mapping[str, Any]
    columns: Sequence[str]
    rows: Callable[[], Sequence[Mapping[str, Any]]]
    link: str | None = None

    def represent(self, wanted: str) -> Representation:
        """Return the answer in a media type. NaN and infinities are null in JSON."""
        if wanted == CSV:
            body = to_csv(self.columns, self.rows())
        else:
            body = to_json(self.document, inf_nan_mode="null")
        headers = {} if self.link is None else {"Link": self.link}
        return Representation(body, CONTENT_TYPES[wanted], headers)


Build = Callable[[Arguments], Answer]


class Answers:
    """Answers of one application: each computed once for all requests that mean the same.

    Two steps of memory: how a request is spelt -> what it means (canonical parameters and media
    type) -> bytes. The first saves parsing, the second computing. Facts do not change while the
    service runs, so nothing here ever goes stale.
    """

    def __init__(self, cache: RepresentationCache | None = None) -> None:
        self.cache = RepresentationCache() if cache is None else cache
        self._meanings: OrderedDict[tuple[str, bytes, str | None], tuple[str, str, str]] = (
            OrderedDict()
        )

    def get(self, request: Request, parameters: Parameters, build: Build) -> Response:
        """Answer a GET whose parameters stand in the query."""
        path: str = request.scope["path"]
        spelling = (path, request.scope["query_string"], request.headers.get("accept"))
        meaning = self._meanings.get(spelling)
        if meaning is not None:
            found = self.cache.get(meaning)
            if found is not None:
                return found.respond(request)
        wanted = media_type(spelling[2], OFFERED)
        arguments = parameters.from_query(spelling[1])
        meaning = (path, parameters.canonical(arguments), wanted)
        response = self._meant(request, meaning, arguments, build)
        self._meanings[spelling] = meaning
        if len(self._meanings) > MOST_SPELLINGS:
            self._meanings.popitem(last=False)
        return response

    def post(
        self, request: Request, body: object, parameters: Parameters, build: Build
    ) -> Response:
        """Answer a POST whose parameters stand in its JSON `body`: same meaning, same bytes."""
        wanted = media_type(request.headers.get("accept"), OFFERED)
        arguments = parameters.from_body(body)
        meaning = (request.scope["path"], parameters.canonical(arguments), wanted)
        return self._meant(request, meaning, arguments, build, conditional=False)

    def _meant(
        self,
        request: Request,
        meaning: tuple[str, str, str],
        arguments: Arguments,
        build: Build,
        *,
        conditional: bool = True,
    ) -> Response:
        representation = self.cache.get(meaning)
        if representation is None:
            representation = build(arguments).represent(meaning[2])
            self.cache.put(meaning, representation)
        return representation.respond(request, conditional=conditional)
