"""Links of README and docs: every page, picture and heading that one names is there."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).resolve().parents[3]
PAGES = sorted(
    [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), ROOT / "survey_data" / "CHANGELOG.md"]
)
NAMES = [page.relative_to(ROOT).as_posix() for page in PAGES]


@cache
def tokens(page: Path) -> list[Token]:
    return MarkdownIt("commonmark").enable("table").parse(page.read_text("utf-8"))


def targets(page: Path) -> list[str]:
    """Where the links and pictures of a page lead."""
    found = []
    for token in tokens(page):
        for inner in token.children or ():
            target = inner.attrGet("href") or inner.attrGet("src")
            if target is not None:
                found.append(unquote(str(target)))
    return found


@cache
def anchors(page: Path) -> frozenset[str]:
    """Headings of a page as GitHub names them, and anchors in HTML."""
    found: dict[str, int] = {}
    for opening, inline in zip(tokens(page), tokens(page)[1:], strict=False):
        if opening.type == "heading_open":
            plain = "".join(one.content for one in inline.children or () if one.content)
            slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
            found[slug] = found.get(slug, -1) + 1
            if found[slug]:
                found[f"{slug}-{found[slug]}"] = 0
    written = re.findall(r'<a (?:id|name)="([^"]+)"', page.read_text("utf-8"))
    return frozenset({*found, *written})


def flaw(page: Path, target: str) -> str:
    """What is wrong with a link, without asking any network; empty where nothing is."""
    parts = urlsplit(target)
    if parts.scheme:
        host = parts.hostname or ""
        sound = parts.scheme in {"http", "https"} and ("." in host) and not re.search(r"\s", target)
        return "" if sound else "no address of the web"
    path = (page.parent / parts.path).resolve() if parts.path else page
    if not path.exists():
        return f"no {parts.path}"
    if not path.is_relative_to(ROOT):
        return "leads out of the repository"
    if parts.fragment and (path.suffix != ".md" or parts.fragment not in anchors(path)):
        return f"no heading #{parts.fragment} in {path.name}"
    return ""


@pytest.mark.parametrize("name", NAMES)
def test_every_link_of_a_page_leads_somewhere(name: str) -> None:
    page = ROOT / name
    flaws = {target: flaw(page, target) for target in targets(page)}
    assert {target: said for target, said in flaws.items() if said} == {}


def test_links_are_found_and_a_broken_one_of_each_kind_is_named(tmp_path: Path) -> None:
    assert sum(len(targets(page)) for page in PAGES) > 400
    page = ROOT / "docs" / "index.md"
    assert flaw(page, "guide/scores.md#the-bound") == ""
    assert flaw(page, "https://example.org/a") == ""
    assert flaw(page, "guide/scores.md#no-such") == "no heading #no-such in scores.md"
    assert flaw(page, "guide/missing.md") == "no guide/missing.md"
    assert flaw(page, "htp://example.org") == "no address of the web"
    assert flaw(page, "https://localhost") == "no address of the web"
    assert flaw(page, "../../outside.md").startswith(("no ", "leads out"))


def test_a_heading_that_stands_twice_has_two_anchors() -> None:
    page = ROOT / "docs" / "guide" / "data-dictionary.md"
    assert {"claims", "facts", "scores"} <= anchors(page)


def test_what_the_glossary_points_to_is_there() -> None:
    from api.glossary import glossary

    docs = ROOT / "docs"
    seen = {one.see for one in glossary() if one.see}
    assert len(seen) > 10
    assert {see: flaw(docs / "index.md", see) for see in seen if flaw(docs / "index.md", see)} == {}
