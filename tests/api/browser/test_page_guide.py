"""The guide in headless Chromium: read, searched, and drawn without a network, wide and narrow."""

from __future__ import annotations

import pytest

from tests.api.browser.visiting import Visit, build_guide, follow

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", autouse=True)
def _built(_own_working_store: None) -> None:
    build_guide()


def go(visit: Visit, path: str) -> None:
    visit.page.goto(f"{visit.address}/guide/{path}")
    visit.page.wait_for_load_state("networkidle")


def at_home(visit: Visit) -> bool:
    return all(url.startswith((visit.address, "data:")) for url in visit.requests)


def test_a_reader_searches_and_finds_without_a_network(wide: Visit) -> None:
    go(wide, "")
    wide.page.locator(".sidebar-search").fill("albedo")
    wide.page.keyboard.press("Enter")
    results = wide.page.locator("#search-results li")
    results.nth(4).wait_for()  # found pages are listed one by one; a fifth is enough
    follow(results.get_by_role("link").first)
    wide.page.wait_for_load_state("networkidle")
    assert "/guide/" in wide.page.url
    assert "albedo" in wide.page.locator("article").inner_text().lower()
    assert at_home(wide)
    assert wide.complaints == []


def test_the_tutorial_is_reached_from_the_start_and_equations_are_drawn(wide: Visit) -> None:
    go(wide, "")
    # The start names it first in a sentence, then again in the contents.
    follow(wide.page.locator("article").get_by_role("link", name="From a question").first)
    assert wide.page.locator("h1").inner_text().startswith("From a question")
    assert wide.page.locator("pre").count() > 15
    go(wide, "guide/scores.html#the-error")
    boxes = wide.page.locator(".equation math").all()
    assert len(boxes) > 2
    assert all(box.bounding_box()["height"] > 15 for box in boxes)
    assert at_home(wide)
    assert wide.complaints == []


@pytest.mark.parametrize(
    "path",
    ["", "guide/tutorial.html", "guide/data-dictionary.html", "models.html",
     "guide/python.html", "guide/python/algorithms.pipeline.html", "leaderboard.html"],
)  # fmt: skip
def test_a_phone_scrolls_tables_and_not_the_page(narrow: Visit, path: str) -> None:
    go(narrow, path)
    assert narrow.page.evaluate("document.documentElement.scrollWidth") <= 390
    assert narrow.page.locator("h1").first.is_visible()
    assert at_home(narrow)
    assert narrow.complaints == []
