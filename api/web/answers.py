"""Answers of path functions, and the route that makes them bytes once and keeps those."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Mapping, Sequence
from typing import Any, ClassVar, Protocol, Self, cast
from urllib.parse import quote

from fastapi import Request, Response
from fastapi.responses import JSONResponse
from fastapi.routing import APIRoute
from pydantic_core import to_json

from api import citations
from api.schema.table import csv_of
from api.service.documents import Document, Row
from api.service.problems import Problem, Violation
from api.web.negotiation import (
    CITATIONS,
    CONTENT_TYPES,
    CSV,
    JSON,
    PARQUET,
    PNG,
    for_spreadsheets,
    wanted_type,
)
from api.web.representations import Representation, RepresentationCache
from api.web.requests import StrictRequest


class Answer(JSONResponse):
    """A document that can be a table too. NaN and infinities are null in JSON.

    Parameters
    ----------
    document : the JSON object
    columns : of the CSV, as `api.schema.table.columns_of` names them
    rows : gives the rows of the CSV
    link : value of the Link header, if any
    status_code : which FastAPI documents by its default
    """

    media_types: ClassVar[tuple[str, ...]] = (JSON, CSV)
    digest: str | None = None
    """Digest of the JSON, if making it gave one."""

    def __init__(
        self,
        document: Mapping[str, Any],
        columns: Sequence[str],
        rows: Callable[[], Sequence[Row]],
        link: str | None = None,
        status_code: int = 200,
    ) -> None:
        self.document = document
        self.columns = columns
        self.rows = rows
        self.links = {} if link is None else {"Link": link}
        super().__init__(document, status_code, self.links)

    @classmethod
    def of(cls, found: Document) -> Self:
        """Return a document of the service as an answer."""
        link = ", ".join(found.links) or None
        return cls(found.document, found.columns, found.rows, link)

    def render(self, content: Any) -> bytes:
        """Return the JSON."""
        return to_json(content, inf_nan_mode="null")

    def table(self) -> str:
        """Return the CSV."""
        return csv_of(self.columns, self.rows())

    def representation(self, wanted: str) -> Representation:
        """Return the answer in a media type."""
        if wanted == CSV:
            return Representation(self.table().encode(), CONTENT_TYPES[CSV], self.links)
        return Representation(bytes(self.body), CONTENT_TYPES[JSON], self.links, digest=self.digest)


class CitedAnswer(Answer):
    """An answer whose studies can be had as references, too.

    Parameters
    ----------
    found : the document and the table
    studies : that are cited
    name : file name without suffix that a client saves references under
    status_code : which FastAPI documents by its default
    narrowed : whether the answer was narrowed to columns, which references cannot be
    """

    media_types: ClassVar[tuple[str, ...]] = (JSON, CSV, *CITATIONS.values())

    def __init__(
        self,
        found: Document,
        studies: Sequence[Row],
        name: str = "studies",
        status_code: int = 200,
        *,
        narrowed: bool = False,
    ) -> None:
        link = ", ".join(found.links) or None
        super().__init__(found.document, found.columns, found.rows, link, status_code)
        self.studies = studies
        self.name = name
        self.narrowed = narrowed

    def representation(self, wanted: str) -> Representation:
        """Return the answer in a media type."""
        form = next((name for name, kind in CITATIONS.items() if kind == wanted), None)
        if form is None:
            return super().representation(wanted)
        if self.narrowed:
            error = Violation("fields", form, "no columns beside references; leave out fields")
            raise Problem(400, "not-combinable", errors=[error])
        saved = f'attachment; filename="{self.name}.{citations.SUFFIXES[form]}"'
        headers = {"Content-Disposition": saved, **self.links}
        body = citations.FORMS[form](self.studies).encode()
        return Representation(body, CONTENT_TYPES[wanted], headers)


class Picture(Response):
    """A PNG."""

    media_type = PNG
    media_types: ClassVar = (PNG,)

    def representation(self, wanted: str) -> Representation:
        """Return the picture."""
        return Representation(bytes(self.body), wanted, {"Vary": "Accept"}, compressible=False)


class Columns(Response):
    """A Parquet file, to be saved under a name.

    Parameters
    ----------
    content : the file's bytes
    name : under which a client saves it
    links : values of the Link header
    status_code : which FastAPI documents by its default
    """

    media_type = PARQUET
    media_types: ClassVar = (PARQUET,)

    def __init__(
        self, content: bytes, name: str, links: Sequence[str] = (), status_code: int = 200
    ) -> None:
        self.saved_as = {"Content-Disposition": f'attachment; filename="{name}"'}
        if links:
            self.saved_as["Link"] = ", ".join(links)
        super().__init__(content, status_code, self.saved_as)

    def representation(self, wanted: str) -> Representation:
        """Return the file."""
        headers = {"Vary": "Accept", **self.saved_as}
        return Representation(bytes(self.body), wanted, headers, compressible=False)


class LinkDocument(JSONResponse):
    """A document of links, which names addresses whole and so is another at each of a service.

    Parameters
    ----------
    document : the JSON object
    links : values of the Link header
    status_code : which FastAPI documents by its default
    """

    def __init_subclass__(cls) -> None:
        """Offer the document by its own media type and as JSON."""
        cls.media_types = (str(cls.media_type), JSON)

    media_types: ClassVar[tuple[str, ...]] = (JSON,)

    def __init__(
        self, document: Mapping[str, Any], links: Sequence[str] = (), status_code: int = 200
    ) -> None:
        self.links = {"Link": ", ".join(links)} if links else {}
        super().__init__(document, status_code, self.links)

    def representation(self, wanted: str) -> Representation:
        """Return the document."""
        return Representation(bytes(self.body), wanted, self.links)


class CacheableResponse(Protocol):
    """A response that `AnswerRoute` can keep, and the media types it can be had in."""

    media_types: ClassVar[tuple[str, ...]]

    def representation(self, wanted: str) -> Representation:
        """Return the response in a media type."""
        ...


def as_asked(made: Representation, wanted: str, request: Request) -> Representation:
    """Return what was made as it is sent: of CSV, for a spreadsheet or with a link to that.

    Parameters
    ----------
    made : in the media type `wanted`
    request : whose query says which
    """
    query: bytes = request.scope["query_string"]
    if wanted != CSV:
        return made
    if for_spreadsheets(query):
        return made.for_spreadsheets()
    if request.method != "GET":
        return made
    asked = query.decode("latin-1").split("&") if query else []
    path = quote(request.scope["path"])
    if not path.endswith(".csv") and not any(one.startswith("format=") for one in asked):
        asked.append("format=csv")
    asked = [one for one in asked if not one.startswith("safe=")]
    return made.link(
        f'<{path}?{"&".join([*asked, "safe=true"])}>; rel="alternate"; type="text/csv"; '
        'title="CSV for spreadsheets"'
    )


Handler = Callable[[Request], Coroutine[Any, Any, Response]]


class StrictRoute(APIRoute):
    """A route whose requests are read to the letter."""

    def get_route_handler(self) -> Handler:
        """Return what handles a request."""
        handle = super().get_route_handler()

        async def strictly(request: Request) -> Response:
            return await handle(StrictRequest(request.scope, request.receive))

        return strictly


class AnswerRoute(StrictRoute):
    """A route that computes each answer once, and gives it in the media type asked for.

    What is asked by GET is kept by its path, query and media type, and where it names addresses
    whole by that of the service. Facts do not change while the
    service runs, so nothing that is kept goes stale. The path function returns a
    `CacheableResponse`.
    """

    def computing(self) -> Handler:
        """Return what computes an answer that is not kept."""
        return super().get_route_handler()

    def get_route_handler(self) -> Handler:
        """Return what handles a request."""
        compute = self.computing()
        offered = cast("type[CacheableResponse]", self.response_class).media_types
        whole = issubclass(cast("type[CacheableResponse]", self.response_class), LinkDocument)

        async def answer(request: Request) -> Response:
            kept: RepresentationCache = request.app.state.kept
            query: bytes = request.scope["query_string"]
            wanted = wanted_type(query, request.headers.get("accept"), offered)
            if request.method != "GET":
                posted = cast("CacheableResponse", await compute(request))
                response = as_asked(posted.representation(wanted), wanted, request)
                return response.respond(request, conditional=False)
            asked = (request.scope["path"], query, wanted, str(request.base_url) if whole else "")
            found = kept.get(asked)
            if found is None:
                made = cast("CacheableResponse", await compute(request))
                found = as_asked(made.representation(wanted), wanted, request)
                kept.put(asked, found)
            return found.respond(request)

        return answer
