"""Files that are served as they are: those of the pages, and any by its path."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from pathlib import Path

from fastapi import Response

from api.service.problems import Problem, Violation
from survey_data.nearest import nearest_name

CONTENT_TYPES = {
    ".css": "text/css",
    ".html": "text/html",
    ".ico": "image/x-icon",
    ".js": "text/javascript",
    ".json": "application/json",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain",
    ".webmanifest": "application/manifest+json",
    ".woff2": "font/woff2",
}


@cache
def page_files() -> dict[str, Path]:
    """Return the files of the page by the name they are served under: the only ones there are."""
    own, swagger = (Path(str(files(name) / "static")) for name in ("api", "fastapi_offline"))
    found = sorted(path for path in own.rglob("*") if path.suffix in CONTENT_TYPES)
    return {path.relative_to(own).as_posix(): path for path in found} | {
        path.name: path for path in sorted(swagger.glob("swagger-ui*"))
    }


def page_file(name: str) -> Response:
    """Return a file of the page; a `Problem` (404) where it has no such file."""
    served = page_files()
    if name not in served:
        error = Violation("file", name, "a file of the page", nearest_name(name, served, cutoff=0))
        raise Problem(404, "unknown-file", errors=[error])
    return file_response(served[name])


def file_response(path: Path) -> Response:
    """Return a file with the media type of its suffix, one of `CONTENT_TYPES`."""
    return Response(path.read_bytes(), media_type=CONTENT_TYPES[path.suffix])
