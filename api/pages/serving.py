"""Pages over HTTP: an address, the same address with `.json` and `.csv`, refusals as pages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

from fastapi import APIRouter, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse
from pydantic_core import to_json

from api.figures.figure import Figure
from api.figures.picture import picture, png
from api.metadata.signposting import LandingPage, headers
from api.pages.rendering import render
from api.service.documents import Document
from api.service.problems import Problem, Violation
from api.service.refusals import refusal
from api.web.answers import (
    Answer,
    Drawing,
    Handler,
    Picture,
    Specification,
    StrictRoute,
    as_asked,
    link,
)
from api.web.negotiation import BIBTEX, CSV, JSON, PLOTLY, PNG, SVG, for_spreadsheets, media_type

HTML = "text/html"
OFFERED = (HTML, JSON, CSV)
TWINS: Mapping[str, str] = {".json": JSON, ".csv": CSV}
DRAWN: Mapping[str, str] = {".svg": SVG, ".png": PNG, ".plotly.json": PLOTLY}
"""Twins of figures: of the first of a page, or with its name before the suffix of any."""
FILES: Mapping[str, str] = {".bib": BIBTEX}
"""Twins that only some pages have."""

Endpoint = Callable[..., Any]


class View(Response):
    """A page from a template, with its document as JSON and CSV at the same address.

    Parameters
    ----------
    template : file name in `templates/`
    found : the document, `document` in the template; JSON and CSV are made of it
    answer : class that makes them
    landing : links for machines; None for a page without metadata of its own
    entity : description of the page's subject in schema.org's terms, with `landing`
    figures : those of the page, which have addresses where the page is registered with `figures`
    context : further variables of the template
    """

    media_type = HTML
    media_types: ClassVar = OFFERED

    def __init__(
        self,
        template: str,
        found: Document,
        /,
        *,
        answer: type[Answer] = Answer,
        landing: LandingPage | None = None,
        entity: Mapping[str, Any] | None = None,
        figures: Sequence[Figure] = (),
        **context: Any,
    ) -> None:
        super().__init__()
        self.template = template
        self.found = found
        self.answer = answer
        self.landing = landing
        self.figures = figures
        self.context = {"entity": entity, **context}

    def representation(self, wanted: str, path: str = "/", query: str = "") -> Response:
        """Return the page in a media type; `path` and `query` are what was asked for."""
        if wanted != HTML:
            links = self.landing.links_of_metadata() if self.landing else ()
            return link(self.answer(self.found).representation(wanted), *headers(links))
        context = {"document": self.found.document, "path": path, "query": query, **self.context}
        links = self.landing.links() if self.landing else ()
        page = HTMLResponse(render(self.template, context), self.status_code)
        return link(page, *headers(links))

    def figure(self, name: str | None, wanted: str) -> Response:
        """Return a figure of the page, the first without a name, for Plotly or as a picture.

        Raises
        ------
        Problem
            404 where the page has no figure of this name.
        """
        found = next((one for one in self.figures if name in (None, one.name)), None)
        if found is None:
            known = ", ".join(one.name for one in self.figures) or "none"
            raise Problem(404, "unknown-figure", errors=[Violation("figure", name, known)])
        if wanted == PLOTLY:
            return Specification(to_json(found.plotly))
        if wanted == PNG:
            return Picture(png(found.plotly))
        return Drawing(picture(found.plotly, found.title, found.description))


def refusal_page(request: Request, problem: Problem) -> Response:
    """Return the page that tells a person of a refusal."""
    path: str = request.scope["path"]
    context = {"path": path, "query": "", "problem": problem.document(path)}
    headers = {"Cache-Control": "no-store", "Vary": "Accept"}
    return HTMLResponse(render("problem.html", context), problem.status_code, headers)


class PageRoute(StrictRoute):
    """A route of a page. Its path settles the representation where it ends in a twin's suffix."""

    def get_route_handler(self) -> Handler:
        """Return what handles a request."""
        compute = super().get_route_handler()
        twin = next(
            (
                kind
                for suffix, kind in {**DRAWN, **TWINS, **FILES}.items()
                if self.path.endswith(suffix)
            ),
            None,
        )

        async def answer(request: Request) -> Response:
            path, query = request.scope["path"], _fill(request.scope["query_string"])
            wanted = twin or media_type(request.headers.get("accept"), OFFERED)
            # How a table is written, which is settled here, is no question to a page.
            request.scope["query_string"] = _without_safe(query) if wanted == CSV else query
            try:
                made: View = await compute(request)  # type: ignore[assignment]
                if wanted in DRAWN.values():
                    return made.figure(request.path_params.get("drawn"), wanted)
                found = made.representation(wanted, path, query.decode("latin-1"))
                request.scope["query_string"] = query
                return as_asked(found, wanted, request)
            except (Problem, RequestValidationError) as error:
                if wanted != HTML:
                    raise
                return refusal_page(request, _problem(error, request))

        return answer


def _fill(query: bytes) -> bytes:
    """Return a query without its empty fields: a form sends those that nobody filled in."""
    return b"&".join(field for field in query.split(b"&") if field.partition(b"=")[2])


def _without_safe(query: bytes) -> bytes:
    """Return a query without `safe`, which has to be yes or no."""
    for_spreadsheets(query)
    return b"&".join(field for field in query.split(b"&") if field.partition(b"=")[0] != b"safe")


def _problem(error: Problem | RequestValidationError, request: Request) -> Problem:
    if isinstance(error, Problem):
        return error
    return refusal(error.errors(), request.scope["endpoint"])


class PageRouter(APIRouter):
    """A router whose pages have twins."""

    def __init__(self) -> None:
        super().__init__(route_class=PageRoute, include_in_schema=False)

    def page(
        self,
        path: str,
        twin: str | None = None,
        files: Sequence[str] = (),
        *,
        figures: bool = False,
    ) -> Callable[[Endpoint], Endpoint]:
        """Offer a page at `path`, its twins at the same path with `.json` and `.csv`.

        Parameters
        ----------
        path : as FastAPI takes it, such as "/studies/{key}"
        twin : the twins' path without suffix, where `path` ("/") can take none
        files : suffixes of further twins, of `FILES`
        figures : whether the page has figures, each at the twins' path with its name and a suffix
            of `DRAWN`, such as /datasets/NAME.field.svg; the first also without its name
        """

        def register(endpoint: Endpoint) -> Endpoint:
            # The twins first: a part of a path would take their suffix for its own.
            drawn = [f"{name}{s}" for name in (".{drawn}", "") for s in DRAWN] if figures else []
            for suffix in (*drawn, *TWINS, *files):
                self.add_api_route((twin or path) + suffix, endpoint, response_class=View)
            self.add_api_route(path, endpoint, response_class=View)
            return endpoint

        return register
