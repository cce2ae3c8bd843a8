"""Behind a proxy under a prefix: no link leaves it, and every one leads to what is there."""

from __future__ import annotations

import csv
import io
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import urldefrag, urljoin, urlsplit

import httpx
import pytest

from api.server.prefix import ForwardedPrefix
from tests.api.browser.visiting import build_guide
from tests.api.conftest import Client
from tests.api.pages.addresses import BESIDE, KINDS

PROXY = Path(__file__).with_name("proxy.py")
#: Neither links nor examples: what was asked for, said again, and texts to read.
MOST_ALIKE = 4  # links of one shape, such as /studies/KEY, that are followed
SAID_AGAIN = {"value", "parameter", "nearest", "expected", "description", "example", "default"}


@contextmanager
def proxied(prefix: str, port: int, *say: str) -> Iterator[httpx.Client]:
    """A client of a proxy, a process of its own, in front of a port."""
    command = [sys.executable, str(PROXY), prefix, str(port), *say]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        address = f"http://127.0.0.1:{running.stdout.readline().strip()}"
        try:
            with httpx.Client(base_url=address, timeout=300) as client:
                yield client
        finally:
            running.terminate()


class Links(HTMLParser):
    """Addresses of a page: of its links, and every attribute or metadatum that starts with /."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: set[str] = set()
        self.inside = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.inside = given.get("type", "")
        self.found |= {
            value
            for name, value in given.items()
            if name in {"href", "src", "action"} or (value.startswith("/") and name != "value")
        }

    def handle_data(self, data: str) -> None:
        if self.inside == "application/ld+json":
            self.found |= set(paths(json.loads(data)))
        self.inside = ""


def paths(document: Any) -> Iterator[str]:
    """Values in a document that are paths."""
    if isinstance(document, dict):
        for name, value in document.items():
            yield from paths(value if name not in SAID_AGAIN else None)
    elif isinstance(document, list):
        for value in document:
            yield from paths(value)
    elif isinstance(document, str) and document.startswith("/"):
        yield document


def links_of(answer: httpx.Response) -> set[str]:
    """Addresses in a response of any kind, and in its headers."""
    kind, found = answer.headers.get("content-type", "").partition(";")[0], set()
    found |= set(re.findall(r"<([^>]*)>", answer.headers.get("link", "")))
    found |= {answer.headers["location"]} if "location" in answer.headers else set()
    if kind == "text/html":
        found |= Links(answer.text).found
    elif kind.endswith("json"):
        found |= set(paths(answer.json()))
        found |= set(re.findall(r'"(http://127[^"]*)"', answer.text))  # of Croissant, link sets
    elif kind == "text/csv":
        cells = csv.reader(io.StringIO(answer.text))
        found |= {cell for row in cells for cell in row if cell.startswith("/")}
    return found


def addresses(client: httpx.Client) -> Iterator[tuple[str, str]]:
    """Every kind of page, and every path of the API with its example, under the prefix."""
    besides = ("/calibrate", "/docs", "/guide", "/openapi.json")
    for kind, address in {**KINDS, **BESIDE, **dict(zip(besides, besides, strict=True))}.items():
        yield kind, f"/atlas{address}"
    for path, operations in client.get("/atlas/openapi.json").json()["paths"].items():
        parameters = operations.get("get", {}).get("parameters", [])
        named = {p["name"]: p.get("example") for p in parameters if p["in"] == "path"}
        if "get" in operations and None not in named.values():
            yield path, "/atlas" + path.format(**named)


def kinds_of_answer(client: httpx.Client, kind: str, address: str) -> Iterator[httpx.Response]:
    """A page; a document as JSON, CSV and for Plotly, as far as there is one."""
    of_api = kind.startswith("/v1")
    accept = "application/json" if of_api else "text/html,*/*;q=0.8"
    yield client.get(address, headers={"Accept": accept})
    for form in ("csv", "plotly") if of_api else ():
        yield client.get(address, params={"format": form})


def own_links(known: dict[str, set[str]]) -> Iterator[tuple[str, str]]:
    """Links on the same host as the page where they stand, each once, with that page."""
    seen: set[str] = set()
    for page, links in known.items():
        for link in links:
            target = urldefrag(urljoin(page, link))[0]
            if target not in seen and urlsplit(target).netloc == urlsplit(page).netloc:
                seen.add(target)
                yield target, page


@pytest.mark.slow
def test_no_link_leaves_the_prefix_and_none_is_broken(
    atlas: Client, serve: Callable[..., Any]
) -> None:
    build_guide()
    app = ForwardedPrefix(atlas.app)  # type: ignore[arg-type]
    with (
        serve(app, proxy_headers=False, root_path="/atlas") as behind,
        proxied("/atlas", behind.port) as client,
    ):
        assert client.get("/studies").status_code == 404, "the proxy serves the prefix alone"
        known = {
            str(answer.url): links_of(answer)
            for kind, address in addresses(client)
            for answer in kinds_of_answer(client, kind, address)
        }
        alike = Counter[tuple[object, ...]]()
        for target, page in own_links(known):
            parts = urlsplit(target)
            assert parts.path.startswith("/atlas/"), (page, target)
            _, _, part, *rest = parts.path.split("/")
            shape = (part, len(rest), Path(parts.path).suffix, bool(parts.query))
            alike[shape] += 1
            if alike[shape] <= MOST_ALIKE:
                answer = client.get(target, headers={"Accept": "text/html,*/*;q=0.8"})
                is_refusal = page.endswith(("nowhere", "Nobody1900"))
                assert answer.status_code != 404 or is_refusal, (page, target)
                beyond = own_links({target: links_of(answer)})
                assert all(urlsplit(link).path.startswith("/atlas/") for link, _ in beyond), target
        assert len(alike) > 60


def test_a_trusted_proxy_says_the_prefix_and_nobody_else(
    atlas: Client, serve: Callable[..., Any]
) -> None:
    trusting = ForwardedPrefix(atlas.app, "127.0.0.1")  # type: ignore[arg-type]
    wary = ForwardedPrefix(atlas.app, "192.0.2.1")  # type: ignore[arg-type]
    seen = {}
    for app in (trusting, wary):
        with (
            serve(app, proxy_headers=False) as behind,
            proxied("/a", behind.port, "say") as client,
        ):
            seen[app] = client.get("/a/claims/C04", headers={"Accept": "text/html"})
    assert 'href="/a/claims"' in seen[trusting].text
    assert 'href="/claims"' in seen[wary].text
    assert "/a/" not in seen[wary].text
    assert seen[trusting].headers["etag"] != seen[wary].headers["etag"], "no kept page mixes them"
    with serve(trusting, proxy_headers=False) as behind:
        for damaged in ("//evil.example", "/a b", '/"><script>', "/..", "http://evil.example"):
            asked = {"X-Forwarded-Prefix": damaged, "Accept": "text/html"}
            behind.request("GET", "/claims/C04", headers=asked)
            assert b'href="/claims"' in behind.getresponse().read(), damaged


def test_moved_addresses_and_pages_of_lists_stay_below_the_prefix(
    atlas: Client, serve: Callable[..., Any]
) -> None:
    app = ForwardedPrefix(atlas.app)  # type: ignore[arg-type]
    with (
        serve(app, proxy_headers=False, root_path="/a/b") as behind,
        proxied("/a/b", behind.port) as client,
    ):
        assert client.get("/a/b/guide").headers["location"] == "/a/b/guide/"
        listed = client.get("/a/b/v1/claims?limit=2")
        assert urlsplit(listed.links["next"]["url"]).path == "/a/b/v1/claims"
        again = client.get(
            "/a/b/v1/claims?limit=2", headers={"If-None-Match": listed.headers["etag"]}
        )
        assert again.status_code == 304
        described = client.get("/a/b/openapi.json").json()
        assert described["servers"][0]["url"] == "/a/b/"
        assert "/v1/claims" in described["paths"]
        found = client.get("/a/b/search", params={"q": "/a"}, headers={"Accept": "text/html"})
        assert 'value="/a"' in found.text, "a text is no address"
        assert client.get("/a/b/v1/nothing").json()["instance"] == "/a/b/v1/nothing"
