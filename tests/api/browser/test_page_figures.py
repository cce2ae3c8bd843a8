"""Figures in a browser: a picture first, then live; marks lead on by press and by key."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, Page, expect

from api.figures.catalogue import MATRIX, TITLES
from tests.api.browser.visiting import Visit, follow

pytestmark = pytest.mark.slow


def live(visit: Visit, path: str) -> Page:
    visit.page.goto(visit.address + path)
    expect(visit.page.locator(".live-figure")).to_have_attribute("data-live", "true")
    return visit.page


def test_figures_are_read_without_javascript(browser: Browser, address: str) -> None:
    context = browser.new_context(
        viewport={"width": 1280, "height": 900}, java_script_enabled=False
    )
    page = context.new_page()
    page.goto(f"{address}/figures/error")
    picture = page.locator(".live-figure img.on-light")
    assert picture.is_visible()
    assert picture.evaluate("image => image.decode().then(() => image.naturalWidth)") > 500
    assert not page.locator(".live-figure img.on-dark").is_visible()
    assert page.locator(".figure-table tbody tr").count() > 50
    page.locator(".figure-filters > summary").click()
    page.get_by_label("Detector").select_option("CMOS")
    follow(page.get_by_role("button", name="Show"))
    assert "detector=CMOS" in page.url
    context.close()


@pytest.mark.parametrize("name", [*TITLES, MATRIX])
@pytest.mark.parametrize("visit", ["dark", "narrow"])
def test_every_figure_comes_alive_without_complaint(
    visit: str, name: str, request: pytest.FixtureRequest
) -> None:
    """The policy of the page's content refuses nothing, and nothing widens the page."""
    visited: Visit = request.getfixturevalue(visit)
    page = live(visited, f"/figures/{name}")
    assert page.locator(".figure-plot .main-svg").first.is_visible()
    assert not page.locator(".live-figure img:visible").count()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert visited.complaints == []
    assert all(url.startswith((visited.address, "data:", "blob:")) for url in visited.requests)


def test_a_node_lights_its_paths_and_a_press_narrows_or_excludes(wide: Visit) -> None:
    page = live(wide, "/figures/error")
    node = page.locator(".sankey-node", has_text="CMOS").locator("rect").first
    dimmed = "all => all.filter(one => one.style.opacity).length"
    node.hover(force=True)
    links = page.locator(".sankey-link")
    assert 0 < links.evaluate_all(dimmed) < links.count()
    node.click(force=True)
    page.wait_for_url("**/figures/error?detector=CMOS")
    expect(page.locator(".live-figure")).to_have_attribute("data-live", "true")
    assert page.locator(".sankey-node", has_text="CCD").count() == 0
    page = live(wide, "/figures/error")
    node.click(force=True, modifiers=["Shift"])
    page.wait_for_url("**/figures/error?detector=**")
    assert "CMOS" not in wide.query()["detector"]
    assert "CCD" in wide.query()["detector"]


def test_marks_are_gone_through_by_arrow_keys_and_lead_to_their_studies(wide: Visit) -> None:
    page = live(wide, f"/figures/{MATRIX}")
    page.locator(".figure-marks a").first.focus()
    page.keyboard.press("End")
    page.keyboard.press("Home")
    expect(page.locator(".figure-marks a:focus")).to_contain_text("PD × Single-Ap.: 2 studies")
    page.keyboard.press("Enter")
    page.wait_for_url("**/studies?detector=PD&mask=Single-Ap.")


def test_a_tap_is_a_click(browser: Browser, address: str) -> None:
    context = browser.new_context(
        viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    visit = Visit(context.new_page(), address)
    page = live(visit, f"/figures/{MATRIX}")
    page.locator(".live-figure").scroll_into_view_if_needed()
    box = page.locator(".nsewdrag").bounding_box()
    assert box is not None
    page.touchscreen.tap(box["x"] + 0.05 * box["width"], box["y"] + 0.05 * box["height"])
    page.wait_for_url("**/studies?detector=PD&mask=Single-Ap.")
    page = live(visit, "/figures/error")
    page.locator(".sankey-node", has_text="CMOS").locator("rect").first.tap(force=True)
    page.wait_for_url("**/figures/error?detector=CMOS")
    context.close()


def test_a_picture_stays_where_plotly_does_not_come(wide: Visit) -> None:
    page = wide.page
    page.route("**/plotly.min.js", lambda route: route.abort())
    with page.expect_console_message(lambda message: message.type == "error"):
        page.goto(wide.address + "/figures/error")
    expect(page.locator(".live-figure img.on-light")).to_be_visible()
    assert page.locator(".figure-plot").count() == 0


def test_a_cell_without_a_study_leads_to_what_is_measured(wide: Visit) -> None:
    page = live(wide, f"/figures/{MATRIX}")
    box = page.locator(".nsewdrag").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.05 * box["width"], box["y"] + 0.45 * box["height"])
    page.wait_for_url("**/architectures/CCD/Single-Ap.")


def test_colours_follow_the_scheme(dark: Visit) -> None:
    page = live(dark, "/figures/error")
    ink = "getComputedStyle(document.querySelector('.sankey-node .node-label, .node-label')).fill"
    before = page.evaluate(ink)
    page.locator("#theme-toggle").click()
    page.wait_for_function(f"before => {ink} !== before", arg=before)
