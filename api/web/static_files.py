"""Files that are served as they are: those of the pages, and of the guide.

plotly.js is one of the pages' own, with the traces of our figures alone (`tools/plotly`): a third
of the file in the package plotly, which took 7 s at 1.6 Mbit/s.
"""

from __future__ import annotations

import hashlib
import mimetypes
from functools import cache
from importlib.resources import files
from pathlib import Path

from fastapi import Response
from starlette.staticfiles import StaticFiles

from api.service.problems import Problem, Violation

mimetypes.add_type("font/woff2", ".woff2")  # not known to every system
#: The pages' own files, and those of Swagger UI.
PAGE = StaticFiles(directory=str(files("api") / "static"), packages=[("fastapi_offline", "static")])

_STYLES = ("base", "parts", "masthead", "tables", "architectures", "pages", "figures")


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
def page_address() -> str:
    """Return the address below which the pages' files can be kept for a year.

    It ends with a digest of all of them, as they import each other.
    """
    digest = hashlib.sha256(styles())
    for path in sorted((files("api") / "static").iterdir(), key=lambda path: path.name):
        if path.is_file():
            digest.update(path.read_bytes())
    return f"/page/{digest.hexdigest()[:12]}"


@cache
def styles() -> bytes:
    """Return the styles of the pages as one file: they are read before anything is shown."""
    place = files("api") / "static" / "styles"
    return b"\n".join((place / f"{name}.css").read_bytes() for name in _STYLES)


def kept(response: Response) -> Response:
    """Return a response that may be kept for a year."""
    response.headers["Cache-Control"] = "public, max-age=31536000, immutable"
    return response
