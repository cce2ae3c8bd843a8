"""Files that are served as they are: those of the pages, and of the guide."""

from __future__ import annotations

import gzip
import hashlib
import mimetypes
from functools import cache
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from fastapi import Response
from starlette.staticfiles import StaticFiles

from api.service.problems import Problem, Violation

mimetypes.add_type("font/woff2", ".woff2")  # not known to every system
#: The pages' own files, and those of Swagger UI.
PAGE = StaticFiles(directory=str(files("api") / "static"), packages=[("fastapi_offline", "static")])


def file_of(place: StaticFiles, name: str, what: str) -> Response:
    """Return a file of a directory; a `Problem` (404) where it has none of this name.

    Parameters
    ----------
    place : the directory
    name : path of the file in it
    what : the directory, in words
    """
    try:
        path = Path(place.lookup_path(name)[0])
        return Response(path.read_bytes(), media_type=mimetypes.guess_type(path.name)[0])
    except (OSError, ValueError) as error:  # no such file, a directory, or no name of one
        wrong = Violation("file", name, f"a file of the {what}")
        raise Problem(404, "unknown-file", errors=[wrong]) from error


@cache
def _plotly() -> Path:
    """Return the file of plotly.js in the installed package, which is not imported for it."""
    found = find_spec("plotly")
    if found is None or found.origin is None:
        raise ModuleNotFoundError("figures are drawn by plotly.js of the package plotly")
    return Path(found.origin).parent / "package_data" / "plotly.min.js"


@cache
def plotly_name() -> str:
    """Return the name of plotly.js below /page, which changes with its content."""
    return f"plotly-{hashlib.sha256(_plotly().read_bytes()).hexdigest()[:12]}.min.js"


@cache
def _plotly_packed() -> bytes:
    """Return plotly.js packed by gzip, once in a fifth of a second: 1.5 of its 4.8 MB."""
    return gzip.compress(_plotly().read_bytes(), 9, mtime=0)


def plotly_file(accept_encoding: str) -> Response:
    """Return plotly.js, packed where the client takes it so. It may be kept for a year."""
    headers = {"Cache-Control": "public, max-age=31536000, immutable", "Vary": "Accept-Encoding"}
    if "gzip" not in accept_encoding:
        return Response(_plotly().read_bytes(), 200, headers, "text/javascript")
    headers["Content-Encoding"] = "gzip"
    return Response(_plotly_packed(), 200, headers, "text/javascript")
