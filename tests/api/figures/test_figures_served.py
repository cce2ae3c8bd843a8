"""Figures over HTTP: pages without JavaScript, twins, drawings, and marks that lead home."""

from __future__ import annotations

import re
from html import unescape
from xml.etree import ElementTree as ET

import pytest

from api.figures.catalogue import TITLES
from tests.api.conftest import Client

SVG = "{http://www.w3.org/2000/svg}"
HTML = "text/html,*/*;q=0.8"
PATHS = [*(f"/figures/{name}" for name in TITLES), "/figures/matrix"]


@pytest.mark.parametrize("path", PATHS)
def test_a_figure_has_a_page_a_drawing_and_a_table_in_two_formats(atlas: Client, path: str) -> None:
    page = atlas.get(path, accept=HTML)
    assert page.status_code == 200
    assert page.text.count("<svg ") == 3
    document = atlas.get(f"{path}.json").json()
    assert document == atlas.get(f"/v1{path}").json()
    assert unescape(page.text).count(document["text"][0]) == 1
    table = atlas.get(f"{path}.csv")
    assert table.content == atlas.get(f"/v1{path}", accept="text/csv").content
    assert table.text.splitlines()[0].split(",") == document["columns"]
    drawing = atlas.get(f"{path}.svg")
    assert drawing.headers["content-type"] == "image/svg+xml; charset=utf-8"
    root = ET.fromstring(drawing.text)
    assert root.find(f"{SVG}title") is not None
    assert root.find(f"{SVG}desc") is not None


def marks(page: str) -> list[tuple[str, str]]:
    """Title and address of every mark of the first drawing that leads somewhere."""
    first = page[page.index("<svg ") : page.index("</svg>")]
    found = re.findall(r'<a class="mark" href="([^"]*)"[^>]*><title>(.*?)</title>', first)
    return [(unescape(title), unescape(href)) for href, title in found]


@pytest.mark.parametrize("path", [*PATHS, "/figures/error?mask=Slit&mask=Multi-Ap."])
def test_every_mark_leads_to_as_many_studies_as_it_says(atlas: Client, path: str) -> None:
    page = atlas.get(path, accept=HTML).text
    found = marks(page)
    assert len(found) > 8
    asked: dict[str, int] = {}
    for title, href in found:
        said = re.search(r": (\d+) stud", title)
        if ": no study" in title:
            assert re.fullmatch(r"/(datasets|architectures)/.+", href)
            assert atlas.get(href, accept=HTML).status_code == 200
        elif href.startswith("/studies?"):
            if href not in asked:
                listed = atlas.get(f"/v1{href}&limit=500")
                assert listed.status_code == 200, href
                asked[href] = listed.json()["total"]
            assert said is not None
            assert asked[href] == int(said[1]), title
        elif "#" in href:
            assert href.split("#")[0] == path
            assert f'id="{href.split("#")[1]}"' in page
        else:
            assert re.fullmatch(r"/studies/\w+", href)
            assert said is None or said[1] == "1"


@pytest.mark.parametrize(
    ("path", "status", "parameter", "nearest"),
    [
        ("/v1/figures/matrix?rows=detectors", 422, "rows", "detector"),
        ("/v1/figures/matrix?columns=msk", 422, "columns", "mask"),
        ("/v1/figures/errors", 404, "figure", "error"),
        ("/v1/figures/error?rows=mask", 400, "rows", None),
    ],
)
def test_what_is_not_known_is_refused_with_what_is(
    atlas: Client, path: str, status: int, parameter: str, nearest: str | None
) -> None:
    refused = atlas.get(path)
    assert refused.status_code == status
    (error,) = refused.json()["errors"]
    assert error["parameter"] == parameter
    assert nearest is None or error["nearest"] == nearest
    assert status == 400 or all(word in error["expected"] for word in ("one of", nearest))
