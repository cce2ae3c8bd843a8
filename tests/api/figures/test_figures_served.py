"""Figures over HTTP: pages without JavaScript, twins, drawings, and marks that lead home."""

from __future__ import annotations

import io
import re
from html import unescape
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from PIL import Image

from api.figures.catalogue import TITLES
from tests.api.conftest import Client

PLOTLY = "application/vnd.plotly.v1+json"
SVG = "{http://www.w3.org/2000/svg}"
HTML = "text/html,*/*;q=0.8"
PATHS = [*(f"/figures/{name}" for name in TITLES), "/figures/matrix"]


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=[pytest.mark.slow] * (n % 4 > 0)) for n, path in enumerate(PATHS)],
)
def test_a_figure_has_a_page_a_drawing_and_a_table_in_two_formats(atlas: Client, path: str) -> None:
    page = atlas.get(path, accept=HTML)
    assert page.status_code == 200
    assert page.text.count(f'src="{path}.svg"') == 1
    assert f'data-spec="{path}.plotly.json"' in page.text
    document = atlas.get(f"{path}.json").json()
    assert document == atlas.get(f"/v1{path}").json()
    assert unescape(page.text).count(document["text"][0]) == 3  # both pictures, and below them
    table = atlas.get(f"{path}.csv")
    assert table.content == atlas.get(f"/v1{path}", accept="text/csv").content
    assert table.text.splitlines()[0].split(",") == document["columns"]
    drawing = atlas.get(f"{path}.svg")
    assert drawing.headers["content-type"] == "image/svg+xml; charset=utf-8"
    root = ET.fromstring(drawing.text)
    assert root.find(f"{SVG}title") is not None
    assert root.find(f"{SVG}desc") is not None
    given = atlas.get(f"{path}.plotly.json")
    assert given.headers["content-type"] == PLOTLY
    asked = atlas.get(f"/v1{path}?format=plotly")
    assert asked.json()["layout"] == given.json()["layout"]
    assert asked.content == atlas.get(f"/v1{path}", accept=PLOTLY).content
    assert atlas.get(f"{path}.plotly.json?detector=CCD").json() != given.json()


def marks(part: Any) -> list[tuple[str, str]]:
    """Text and address of every mark of a specification that leads somewhere."""
    if isinstance(part, dict) and "text" in part and "href" in part:
        return [(part["text"], part["href"])]
    inside = part.values() if isinstance(part, dict) else part if isinstance(part, list) else ()
    return [mark for one in inside for mark in marks(one)]


def test_plotly_is_served_from_here_packed_and_may_be_kept(atlas: Client) -> None:
    page = atlas.get("/figures/error", accept=HTML).text
    (address,) = set(re.findall(r'data-plotly="([^"]*)"', page))
    packed = atlas.get(address, headers={"Accept-Encoding": "gzip"})
    assert packed.headers["content-encoding"] == "gzip"
    assert "immutable" in packed.headers["cache-control"]
    plain = atlas.get(address, headers={"Accept-Encoding": "identity"})
    assert "content-encoding" not in plain.headers
    assert b"plotly.js 4" in plain.content[:100]


def test_a_figure_is_a_picture_for_a_slide(atlas: Client) -> None:
    drawn = atlas.get("/figures/error.png")
    assert drawn.headers["content-type"] == "image/png"
    with Image.open(io.BytesIO(drawn.content)) as read:
        assert read.width >= 2000
        assert read.convert("RGB").getpixel((0, 0)) == (255, 255, 255)


@pytest.mark.parametrize("path", [*PATHS, "/figures/error?mask=Slit&mask=Multi-Ap."])
def test_every_mark_leads_to_as_many_studies_as_it_says(atlas: Client, path: str) -> None:
    page = atlas.get(path, accept=HTML).text
    base, _, query = path.partition("?")
    found = marks(atlas.get(f"{base}.plotly.json?{query}").json())
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
