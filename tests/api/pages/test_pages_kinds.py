"""What holds for every kind of page, read as a browser without a script reads it."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from itertools import pairwise
from urllib.parse import unquote, urlsplit

import pytest
from fastapi.routing import APIRoute

from api.addresses import NAVIGATION
from api.pages.routers import ROUTERS
from api.pages.serving import PageRouter
from api.web.static_files import PAGE, page_address
from tests.api.conftest import Client
from tests.api.pages.addresses import KINDS
from tests.api.pages.test_pages_content import text_of

LABEL = re.compile(r"\b(?:sec|tab|fig|rq|rqsum):\w+")
VOID = {"meta", "link", "img", "input", "br", "hr"}


class Page(HTMLParser):
    """Tags with their attributes, text outside scripts, and whether tags are closed in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.text = text
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.inline: list[str] = []
        self.unmatched: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        if self.open and self.open[-1] == tag:
            self.open.pop()
        else:
            self.unmatched.append(f"</{tag}> in {'/'.join(self.open[-3:])}")

    def handle_data(self, data: str) -> None:
        linked = self.tags and self.tags[-1] == ("script", {"type": "application/ld+json"})
        if self.open and self.open[-1] in {"script", "style"} and data.strip() and not linked:
            self.inline.append(data)

    def attributes(self, name: str) -> list[tuple[str, str]]:
        return [(tag, a[name] or "") for tag, a in self.tags if a.get(name) is not None]


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_read_as_it_is_meant_without_a_script(kind: str, atlas: Client) -> None:
    response = atlas.get(KINDS[kind], accept="text/html")
    assert response.headers["content-type"] == "text/html; charset=utf-8"
    assert response.status_code in {200, 404, 422}
    page = Page(response.text)
    assert (page.unmatched, page.open) == ([], []), "markup is whole"
    ids = [value for _, value in page.attributes("id")]
    assert sorted(set(ids)) == sorted(ids)
    nothing_is_inline_or_from_elsewhere(page)
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch("h[1-6]", tag)]
    assert levels.count(1) == levels[0] == 1, "one heading of the page, and it comes first"
    assert all(after - before <= 1 for before, after in pairwise(levels)), "none is skipped"
    links = {value for tag, value in page.attributes("href") if tag == "a"}
    assert {pages[0][0] for pages in NAVIGATION.values()} <= links, "every part is a press away"
    assert ("form", "/search") in page.attributes("action")
    assert all("scope" in a for tag, a in page.tags if tag == "th")
    assert all(a.get("alt") is not None for tag, a in page.tags if tag == "img")
    assert all(a.get("aria-label") for tag, a in page.tags if tag == "svg")
    assert not re.search(r">\s*None\s*<", page.text)
    assert not LABEL.findall(text_of(page.text)), "labels of the survey's source"


def nothing_is_inline_or_from_elsewhere(page: Page) -> None:
    assert page.inline == []
    assert not [a for _, attributes in page.tags for a in attributes if a.startswith("on")]
    assert page.attributes("style") == []
    loaded = [one for one in page.attributes("href") if one[0] == "link"] + page.attributes("src")
    for tag, address in loaded:
        assert not urlsplit(address).netloc, (tag, address)
        if address.startswith("/page/"):
            name = address.removeprefix(f"{page_address()}/").removeprefix("/page/")
            assert name == "styles.css" or PAGE.lookup_path(name)[0], address


def test_every_page_of_a_section_leads_to_the_others(atlas) -> None:
    for section, pages in NAVIGATION.items():
        for address, _ in pages if len(pages) > 1 else ():
            text = atlas.get(address, accept="text/html").text
            for other, name in pages if address != "/guide" else ():  # as soon as that is built
                mark = ' aria-current="page"' if other == address else ""
                assert f'<a href="{other}"{mark}>{name}</a>' in text, section


def test_there_is_a_page_of_every_route() -> None:
    """What these tests and the browser's look at is every kind of page that there is."""
    paths = [urlsplit(unquote(path)).path for path in KINDS.values()]
    routes = [
        route
        for router in ROUTERS
        if isinstance(router, PageRouter)
        for route in router.routes
        if isinstance(route, APIRoute)
        and not route.path.endswith((".json", ".csv", ".bib", ".svg", ".png"))
    ]
    assert len(routes) > 15
    for route in routes:
        assert any(route.path_regex.fullmatch(path) for path in paths), route.path
