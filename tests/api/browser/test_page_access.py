"""axe-core finds nothing serious on any kind of page, in either scheme, wide or narrow."""

from __future__ import annotations

from importlib.resources import files

import pytest
from playwright.sync_api import expect

from tests.api.browser.visiting import NARROW, WIDE, Visit, build_guide
from tests.api.pages.addresses import BESIDE, KINDS

pytestmark = pytest.mark.slow

AXE = (files("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")
PLACES = {**KINDS, **BESIDE}
SERIOUS = {"serious", "critical"}


@pytest.fixture(scope="module", autouse=True)
def _built(_own_working_store: None) -> None:
    build_guide()


@pytest.mark.parametrize("kind", PLACES)
def test_no_page_has_a_serious_issue(kind: str, wide: Visit) -> None:
    """Drawn once, then looked at wide and light, and narrow and dark."""
    page = wide.page
    page.goto(wide.address + PLACES[kind])
    if kind.startswith("answer"):
        page.wait_for_function("() => document.documentElement.dataset.live")
    for figure in page.locator(".live-figure").all():
        figure.scroll_into_view_if_needed()
        expect(figure).to_have_attribute("data-live", "true")
    page.evaluate(AXE)
    for scheme, size in (("light", WIDE), ("dark", NARROW)):
        page.emulate_media(color_scheme=scheme)
        page.set_viewport_size({"width": size[0], "height": size[1]})
        expect(page.locator("html")).to_have_attribute("data-theme", scheme)
        result = page.evaluate("() => axe.run(document, {resultTypes: ['violations']})")
        found = [
            (scheme, size, issue["id"], node["target"], node["failureSummary"])
            for issue in result["violations"]
            if issue["impact"] in SERIOUS
            for node in issue["nodes"][:3]
        ]
        assert len(result["passes"]) > 10  # or it has not looked
        assert found == []
