"""Links of README and docs: every page, picture and heading that one names is there."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

from api.glossary import glossary

ROOT = Path(__file__).resolve().parents[3]
PAGES = sorted(
    [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), ROOT / "survey_data" / "CHANGELOG.md"]
)


def targets(page: Path) -> list[str]:
    """Where the links and pictures of a page lead."""
    inner = (
        one
        for token in MarkdownIt("commonmark").enable("table").parse(page.read_text("utf-8"))
        for one in token.children or ()
    )
    found = [one.attrGet("href") or one.attrGet("src") for one in inner]
    return [str(target) for target in found if target]


@cache
def anchors(page: Path) -> frozenset[str]:
    """Headings of a page as GitHub names them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text("utf-8"), re.MULTILINE)
    plain = (re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings)
    return frozenset(heading.replace(" ", "-") for heading in plain)


def flaw(page: Path, target: str) -> str:
    """What is wrong with a link, without asking any network; empty where nothing is."""
    if re.match(r"[a-z]+:", target):
        return "" if re.match(r"https?://[\w-]+\.\S+$", target) else "no address of the web"
    name, _, anchor = target.partition("#")
    path = (page.parent / name).resolve() if name else page
    if not path.exists() or not path.is_relative_to(ROOT):
        return f"no {name}"
    return f"no heading #{anchor}" if anchor and anchor not in anchors(path) else ""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_of_a_page_leads_somewhere(page: Path) -> None:
    flaws = {target: flaw(page, target) for target in targets(page)}
    assert {target: said for target, said in flaws.items() if said} == {}


def test_what_the_glossary_points_to_is_there() -> None:
    seen = {one.see for one in glossary() if one.see}
    assert len(seen) > 10
    assert [see for see in seen if flaw(ROOT / "docs" / "index.md", see)] == []
