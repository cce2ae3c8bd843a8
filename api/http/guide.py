"""The guide's site as it is served: files of a directory, once it is built."""

from __future__ import annotations

from fastapi import Response
from starlette.staticfiles import StaticFiles

from api.guide import site
from api.web.static_files import file_of

INDEX = "index.html"
_UNBUILT = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>The guide is not built</title>
<meta name="viewport" content="width=device-width"></head><body><h1>The guide is not built</h1>
<p>Run <code>sunatlas guide build</code>, which takes half a minute, then load this page again;
<a href="/">the atlas</a> is there meanwhile.</p></body></html>
"""
_MISSING = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>The guide is not installed</title>
<meta name="viewport" content="width=device-width"></head><body><h1>The guide is not installed</h1>
<p>What builds it is an extra: <code>{install}</code>, then <code>sunatlas guide build</code>.
<a href="/">The atlas</a> does without it.</p></body></html>
"""


def respond(name: str) -> Response:
    """Give a file of the guide; where it is not built, a page that says how (503).

    Parameters
    ----------
    name : of the file, below /guide/; a directory stands for its index

    Raises
    ------
    Problem
        404 where the guide has no such file.
    """
    place = site.cached_site()
    if place is None:
        return _unavailable(_MISSING.format(install=site.INSTALL))
    if not place.is_dir():
        return _unavailable(_UNBUILT)
    return file_of(StaticFiles(directory=place), name or INDEX, "guide")


def _unavailable(text: str) -> Response:
    return Response(text, 503, headers={"Cache-Control": "no-store"}, media_type="text/html")
