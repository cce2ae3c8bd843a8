"""axe-core finds nothing serious on any kind of page, in either scheme, wide or narrow."""

from __future__ import annotations

from importlib.resources import files

import pytest
from playwright.sync_api import expect

from tests.api.browser.visiting import Visit, build_guide
from tests.api.pages.addresses import BESIDE, KINDS

pytestmark = pytest.mark.slow

AXE = (files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")
PLACES = {**KINDS, **BESIDE}
SERIOUS = {"serious", "critical"}


@pytest.fixture(scope="module", autouse=True)
def _built(_own_working_store: None) -> None:
    build_guide()


@pytest.mark.parametrize("kind", PLACES)
@pytest.mark.parametrize("visit", ["wide", "narrow", "dark"])
def test_no_page_has_a_serious_issue(visit: str, kind: str, request: pytest.FixtureRequest) -> None:
    visited: Visit = request.getfixturevalue(visit)
    page = visited.page
    page.goto(visited.address + PLACES[kind])
    if kind.startswith("answer"):
        page.wait_for_function("() => document.documentElement.dataset.live")
    for figure in page.locator(".live-figure").all():
        figure.scroll_into_view_if_needed()
        expect(figure).to_have_attribute("data-live", "true")
    page.evaluate(AXE)
    result = page.evaluate("() => axe.run(document, {resultTypes: ['violations']})")
    found = [
        (issue["id"], node["target"], node["failureSummary"])
        for issue in result["violations"]
        if issue["impact"] in SERIOUS
        for node in issue["nodes"][:3]
    ]
    assert len(result["passes"]) > 10  # or it has not looked
    assert found == []
