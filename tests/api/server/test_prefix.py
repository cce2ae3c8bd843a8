"""Behind a proxy under a prefix: no link leaves it, and every one leads to what is there."""

from __future__ import annotations

import csv
import html
import io
import json
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urldefrag, urljoin, urlsplit

import httpx
import pytest

from api.server.prefix import ForwardedPrefix
from tests.api.browser.visiting import build_guide
from tests.api.conftest import Client
from tests.api.pages.addresses import BESIDE, KINDS

PAGE = {"Accept": "text/html,*/*;q=0.8"}
#: Links of one shape, such as /studies/KEY, that are followed.
MOST_ALIKE = 4
#: Neither links nor examples: what was asked for, said again, and texts to read.
SAID_AGAIN = {"value", "parameter", "nearest", "expected", "description", "example", "default"}


@contextmanager
def proxied(
    atlas: Client, serve: Callable[..., Any], prefix: str, *say: str, trusted: str = "127.0.0.1"
) -> Iterator[httpx.Client]:
    """A client of a proxy, a process of its own, in front of the service."""
    app = ForwardedPrefix(atlas.app, trusted)  # type: ignore[arg-type]
    options = {} if say else {"root_path": prefix}
    with serve(app, proxy_headers=False, **options) as behind:
        proxy = [sys.executable, f"{Path(__file__).parent}/proxy.py", prefix, str(behind.port)]
        with subprocess.Popen([*proxy, *say], stdout=subprocess.PIPE, text=True) as running:
            assert running.stdout is not None
            address = f"http://127.0.0.1:{running.stdout.readline().strip()}"
            try:
                with httpx.Client(base_url=address, timeout=300) as client:
                    yield client
            finally:
                running.terminate()


def paths(document: Any) -> Iterator[str]:
    """Values in a document that are paths, or addresses of this service."""
    if isinstance(document, dict):
        document = [value for name, value in document.items() if name not in SAID_AGAIN]
    if isinstance(document, list):
        for value in document:
            yield from paths(value)
    elif isinstance(document, str) and document.startswith(("/", "http://127.0.0.1:")):
        yield document


def links_of(answer: httpx.Response) -> Iterator[str]:
    """Addresses in a response of any kind, and in its headers."""
    kind = answer.headers.get("content-type", "").partition(";")[0]
    yield from re.findall(r"<([^>]*)>", answer.headers.get("link", ""))
    yield from filter(None, [answer.headers.get("location")])
    if kind == "text/html":
        for name, value in re.findall(r'\s([\w-]+)="([^"]*)"', answer.text):
            if name in {"href", "src", "action"} or (value.startswith("/") and name != "value"):
                yield html.unescape(value)
        for found in re.findall(r'<script type="application/ld\+json">(.*?)</script>', answer.text):
            yield from paths(json.loads(found))
    elif kind.endswith("json"):
        yield from paths(answer.json())
    elif kind == "text/csv":
        yield from (paths(list(csv.reader(io.StringIO(answer.text)))))


def addresses(client: httpx.Client) -> Iterator[tuple[str, dict[str, str]]]:
    """Every kind of page, and every document of the API as JSON, CSV and for Plotly."""
    for at in (*KINDS.values(), *BESIDE.values(), "/calibrate", "/docs", "/guide", "/openapi.json"):
        yield f"/atlas{at}", PAGE
    for path, operations in client.get("/atlas/openapi.json").json()["paths"].items():
        parameters = operations.get("get", {}).get("parameters", [])
        named = {p["name"]: p.get("example") for p in parameters if p["in"] == "path"}
        if "get" in operations and None not in named.values():
            for form in ("", "?format=csv", "?format=plotly"):
                yield f"/atlas{path.format(**named)}{form}", {}


@pytest.mark.slow
def test_no_link_leaves_the_prefix_and_none_is_broken(
    atlas: Client, serve: Callable[..., Any]
) -> None:
    build_guide()
    seen: set[str] = set()
    alike = Counter[tuple[object, ...]]()
    with proxied(atlas, serve, "/atlas") as client:
        assert client.get("/studies").status_code == 404, "the proxy serves the prefix alone"

        def new_links(answer: httpx.Response) -> Iterator[str]:
            for link in links_of(answer):
                target = urlsplit(urldefrag(urljoin(str(answer.url), link))[0])
                if target.netloc == answer.url.netloc.decode() and target.geturl() not in seen:
                    assert target.path.startswith("/atlas/"), (answer.url, link)
                    seen.add(target.geturl())
                    yield target.geturl()

        for address, headers in addresses(client):
            first = client.get(address, headers=headers)
            for target in new_links(first):
                parts = urlsplit(target)
                _, _, part, *rest = parts.path.split("/")
                shape = (part, len(rest), Path(parts.path).suffix, bool(parts.query))
                alike[shape] += 1
                if alike[shape] <= MOST_ALIKE:
                    answer = client.get(target, headers=PAGE)
                    # the JSON of a page that refuses refuses as well
                    assert first.status_code == 404 or answer.status_code != 404, (address, target)
                    assert list(new_links(answer)) is not None
    assert len(alike) > 60


def test_a_trusted_proxy_says_the_prefix_and_nobody_else(
    atlas: Client, serve: Callable[..., Any]
) -> None:
    def claim(prefix: str, trusted: str) -> httpx.Response:
        with proxied(atlas, serve, prefix, "say", trusted=trusted) as client:
            return client.get(f"{prefix}/claims/C04", headers=PAGE)

    trusting, wary = claim("/a", "127.0.0.1"), claim("/a", "192.0.2.1")
    assert 'href="/a/claims"' in trusting.text
    assert 'href="/claims"' in wary.text
    assert "/a/" not in wary.text
    assert trusting.headers["etag"] != wary.headers["etag"], "no kept page mixes them"
    with serve(ForwardedPrefix(atlas.app), proxy_headers=False) as behind:  # type: ignore[arg-type]
        for damaged in ('/"><script>', "/..", "/a;b", "//evil.example"):
            asked = {"Accept": "text/html", "X-Forwarded-Prefix": damaged}
            behind.request("GET", "/claims/C04", headers=asked)
            assert b'href="/claims"' in behind.getresponse().read(), damaged


def test_headers_and_refusals_have_the_prefix_and_texts_do_not(
    atlas: Client, serve: Callable[..., Any]
) -> None:
    with proxied(atlas, serve, "/a/b") as client:
        assert client.get("/a/b/guide").headers["location"] == "/a/b/guide/"
        listed = client.get("/a/b/v1/claims?limit=2")
        assert urlsplit(listed.links["next"]["url"]).path == "/a/b/v1/claims"
        kept = {"If-None-Match": listed.headers["etag"]}
        assert client.get("/a/b/v1/claims?limit=2", headers=kept).status_code == 304
        described = client.get("/a/b/openapi.json").json()
        assert described["servers"][0]["url"] == "/a/b/"
        assert "/v1/claims" in described["paths"]
        assert client.get("/a/b/v1/nothing").json()["instance"] == "/a/b/v1/nothing"
        assert 'value="/a"' in client.get("/a/b/search?q=/a", headers=PAGE).text
