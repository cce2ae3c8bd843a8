"""Static files of the pages: those of `api/static/`."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import Path

from api.service.problems import Problem, Violation
from api.web.representations import Representation
from survey_data.nearest import nearest_name

CONTENT_TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".ico": "image/x-icon",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".webmanifest": "application/manifest+json",
    ".woff2": "font/woff2",
}
ALREADY_COMPRESSED = {".png", ".woff2", ".ico"}


@cache
def page_files() -> dict[str, Path]:
    """Return the files of the page by the name they are served under: the only ones there are."""
    directory = Path(str(files("api") / "static"))
    return {
        path.relative_to(directory).as_posix(): path
        for path in sorted(directory.rglob("*"))
        if path.is_file() and path.suffix in CONTENT_TYPES
    }


@cache
def page_file(name: str) -> Representation:
    """Return a file of the page, read (and compressed) once.

    Raises
    ------
    Problem
        404 where the page has no such file.
    """
    served = page_files()
    if name not in served:
        error = Violation("file", name, "a file of the page", nearest_name(name, served, cutoff=0))
        raise Problem(404, "unknown-file", errors=[error])
    path = served[name]
    return Representation(
        path.read_bytes(),
        CONTENT_TYPES[path.suffix],
        {"Vary": "Accept-Encoding"},
        compressible=path.suffix not in ALREADY_COMPRESSED,
    )
