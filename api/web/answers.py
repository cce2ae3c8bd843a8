"""Answers of path functions, and the route that gives them in the media type asked for."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any, ClassVar
from urllib.parse import quote

from fastapi import Request, Response
from fastapi.responses import JSONResponse
from fastapi.routing import APIRoute
from pydantic_core import to_json

from api import citations
from api.schema.former_names import with_former_names
from api.service.documents import Document
from api.service.problems import Problem, Violation
from api.web.negotiation import (
    CITATIONS,
    CONTENT_TYPES,
    CSV,
    JSON,
    PARQUET,
    PLOTLY,
    PNG,
    SVG,
    for_spreadsheets,
    wanted_type,
)
from api.web.requests import StrictRequest
from files.csv_writing import escape_formulas

Handler = Callable[[Request], Coroutine[Any, Any, Response]]


class Answer(JSONResponse):
    """A document of the service; in its other media types where it has them.

    Parameters
    ----------
    found : the document; NaN and infinities are null in its JSON
    status_code : of HTTP; FastAPI documents its default
    """

    media_types: ClassVar[tuple[str, ...]] = (JSON, CSV)

    def __init__(self, found: Document, status_code: int = 200) -> None:
        super().__init__(found.document, status_code)
        self.found = found
        link(self, *found.links)

    def render(self, content: Any) -> bytes:
        """Return the JSON."""
        return to_json(with_former_names(content), inf_nan_mode="null")

    def representation(self, wanted: str) -> Response:
        """Return the answer in a media type."""
        if wanted == CSV:
            return self.written(self.found.table(), CSV)
        if wanted == PLOTLY:
            return Specification(to_json(self.found.plotly))
        form = next((name for name, kind in CITATIONS.items() if kind == wanted), None)
        return self if form is None else self._cited(form)

    def _cited(self, form: str) -> Response:
        """Return references to the studies."""
        if self.found.cited is None:
            error = Violation("fields", form, "no columns beside references; leave out fields")
            raise Problem(400, "not-combinable", errors=[error])
        saved = f'attachment; filename="{self.found.saved_as}.{citations.SUFFIXES[form]}"'
        text = citations.FORMS[form](self.found.cited)
        return self.written(text, CITATIONS[form], **{"Content-Disposition": saved})

    def written(self, text: str, wanted: str, **headers: str) -> Response:
        """Return another representation of the answer, with its links."""
        made = Response(text, headers=headers, media_type=CONTENT_TYPES[wanted])
        return link(made, *([self.headers["link"]] if "link" in self.headers else []))


class CitedAnswer(Answer):
    """An answer whose studies can be had as references, too."""

    media_types: ClassVar[tuple[str, ...]] = (JSON, CSV, *CITATIONS.values())


class FigureAnswer(Answer):
    """An answer that Plotly can draw, too."""

    media_types: ClassVar[tuple[str, ...]] = (JSON, CSV, PLOTLY)


class Specification(Response):
    """A figure for Plotly."""

    media_type = PLOTLY


class Drawing(Response):
    """An SVG."""

    media_type = f"{SVG}; charset=utf-8"


class Picture(Response):
    """A PNG."""

    media_type = PNG


class Columns(Response):
    """A Parquet file."""

    media_type = PARQUET


class LinkDocument(JSONResponse):
    """A document of links, by its own media type and as JSON."""

    def __init_subclass__(cls) -> None:
        """Offer it so."""
        cls.media_types = (str(cls.media_type), JSON)

    media_types: ClassVar[tuple[str, ...]] = (JSON,)


def link(made: Response, *links: str) -> Response:
    """Return a response with further values of its Link header."""
    before = [made.headers["link"]] if "link" in made.headers else []
    if links:
        made.headers["link"] = ", ".join((*before, *links))
    return made


def as_asked(made: Response, wanted: str, request: Request) -> Response:
    """Return what was made as it is sent: of CSV, for a spreadsheet or with a link to that.

    Parameters
    ----------
    made : in the media type `wanted`
    wanted : media type that the request asks for
    request : its query says whether a CSV is for a spreadsheet
    """
    made.headers.setdefault("vary", "Accept")
    query: bytes = request.scope["query_string"]
    if wanted != CSV:
        return made
    if for_spreadsheets(query):
        made.body = escape_formulas(bytes(made.body).decode()).encode()
        made.headers["content-length"] = str(len(made.body))
        return made
    if request.method != "GET":
        return made
    asked = query.decode("latin-1").split("&") if query else []
    path = quote(request.scope["path"])
    if not path.endswith(".csv") and not any(one.startswith("format=") for one in asked):
        asked.append("format=csv")
    asked = [one for one in asked if not one.startswith("safe=")]
    return link(
        made,
        f'<{path}?{"&".join([*asked, "safe=true"])}>; rel="alternate"; type="text/csv"; '
        'title="CSV for spreadsheets"',
    )


class StrictRoute(APIRoute):
    """A route whose requests are read to the letter."""

    def get_route_handler(self) -> Handler:
        """Return what handles a request."""
        handle = super().get_route_handler()

        async def strictly(request: Request) -> Response:
            return await handle(StrictRequest(request.scope, request.receive))

        return strictly


class AnswerRoute(StrictRoute):
    """A route that gives an answer in the media type asked for, of those of its response class."""

    def get_route_handler(self) -> Handler:
        """Return what handles a request."""
        compute = super().get_route_handler()
        kind: Any = self.response_class
        offered = getattr(kind, "media_types", (kind.media_type,))

        async def answer(request: Request) -> Response:
            accept = request.headers.get("accept")
            wanted = wanted_type(request.scope["query_string"], accept, offered)
            made = await compute(request)
            if isinstance(made, Answer):
                made = made.representation(wanted)
            elif isinstance(made, LinkDocument):
                made.headers["content-type"] = wanted
            return as_asked(made, wanted, request)

        return answer
