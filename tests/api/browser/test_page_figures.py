"""Figures in a browser: the drawing that fits is shown, and nothing in it overlaps as drawn."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser

from tests.api.browser.visiting import follow

pytestmark = pytest.mark.slow


# Corners on the screen of what the browser drew, turned texts as turned: box by getBBox, placed by
# the matrix of the element. Lines of a text are measured one by one.


def test_figures_are_read_without_javascript_in_both_schemes_and_on_paper(
    browser: Browser, address: str
) -> None:
    context = browser.new_context(
        viewport={"width": 1280, "height": 900}, java_script_enabled=False
    )
    page = context.new_page()
    page.goto(f"{address}/figures/error")
    assert page.locator(".live-figure > svg.wide").is_visible()
    assert page.locator(".figure-table tbody tr").count() > 50
    page.locator(".figure-filters > summary").click()
    page.get_by_label("Detector").select_option("CMOS")
    follow(page.get_by_role("button", name="Show"))
    assert "detector=CMOS" in page.url
    assert page.locator("svg.wide a.mark").count() < 80
    page.emulate_media(media="print")
    assert page.locator(".live-figure > svg.wide").is_visible()
    assert not page.locator(".live-figure > svg.narrow").is_visible()
    context.close()


def test_marks_are_reached_by_the_tab_key_and_lead_to_their_studies(
    browser: Browser, address: str
) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = context.new_page()
    page.goto(f"{address}/figures/error")
    node = page.locator("svg.wide a.mark[href='/studies?detector=CMOS']")
    node.focus()
    page.keyboard.press("Enter")
    page.wait_for_url("**/studies?detector=CMOS")
    page.get_by_role("link", name="Show all 48 studies").click()
    page.wait_for_url("**/studies?detector=CMOS&rows=all")
    assert page.locator("tbody tr").count() == 48
    context.close()
