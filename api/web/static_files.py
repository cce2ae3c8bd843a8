"""Files that are served as they are: those of the pages, and of the guide."""

from __future__ import annotations

import mimetypes
from importlib.resources import files
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
