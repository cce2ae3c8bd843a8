"""Ways through the atlas, each as someone who comes with a question walks it."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from api.pages.dataset import FIRST
from tests.api.browser.visiting import PATIENCE_MS, WIDE, Visit, follow, get_json

pytestmark = pytest.mark.slow


def test_from_home_to_a_chosen_calibration_in_four_clicks(wide: Visit) -> None:
    page = wide.go()
    blank = page.locator('[name="max_error_deg"]')
    blank.click()
    blank.type("0.02")
    page.locator(".submit button").click()
    page.wait_for_url("**/?max_error_deg=0.02")
    wide.settle()
    page.locator(".calibrated > summary").first.click()
    chosen = page.locator(".calibration .method a").last
    name = chosen.inner_text()
    follow(page.locator(".calibration .method a", has_text=name).first)
    expect(page.locator("h1")).to_contain_text(name)
    expect(page.locator("#ranks")).to_be_visible()
    assert wide.complaints == []


def test_find_a_study_see_how_it_runs_and_its_board(wide: Visit) -> None:
    page = wide.page
    page.goto(wide.address + "/search")
    page.locator("#q").fill("Chang2008")
    page.locator("#q").press("Enter")
    follow(page.locator(".hits a").first)
    expect(page.locator("h1")).to_contain_text("image centroiding algorithm")
    expect(page.locator(".copyable code")).to_have_text("sunatlas run Chang2008")
    follow(page.get_by_role("link", name="cmos-single-aperture", exact=True).first)
    expect(page.locator("h1")).to_have_text("cmos-single-aperture")
    expect(page.locator("#board ~ table tbody tr")).to_have_count(FIRST)
    page.locator('select[name="condition"]').select_option("hot")
    page.get_by_role("button", name="Show", exact=True).click()
    page.wait_for_url("**condition=hot**")
    assert wide.complaints == []


@pytest.fixture
def plain(browser: Browser, address: str) -> Iterator[Page]:
    """A page without scripts."""
    context = browser.new_context(
        viewport={"width": WIDE[0], "height": WIDE[1]}, java_script_enabled=False
    )
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    yield page
    context.close()


def test_without_a_script_tables_are_read_and_questions_asked(plain: Page, address: str) -> None:
    plain.goto(address)
    assert plain.locator(".architecture").count() == 10
    plain.locator('[name="max_error_deg"]').fill("0.02")
    follow(plain.get_by_role("button", name="Show the answer"))
    found = get_json(f"{address}/v1/recommendations?max_error_deg=0.02")
    assert f"{found['count']} architectures" in plain.locator("#summary").inner_text()
    assert plain.locator(".architecture h3").all_inner_texts() == [
        f"{a['detector']} + {a['mask']}" for a in found["architectures"]
    ]
    plain.locator(".calibrated > summary").first.click()
    assert plain.locator(".calibration").first.is_visible()
    follow(plain.locator("nav a", has_text="Measurements"))
    follow(plain.locator("nav a", has_text="Data sets"))
    follow(plain.locator("tbody a").first)
    assert plain.locator("#board ~ table tbody tr").count() > 5


def test_printed_pages_hold_the_answer_in_black_on_white(dark: Visit) -> None:
    page = dark.go("/?task=Accuracy")
    page.emulate_media(media="print", color_scheme="dark")
    assert page.locator(".masthead nav").is_hidden()
    assert page.locator("#question").is_hidden()
    assert page.locator(".architecture").first.is_visible()
    ink, ground = page.evaluate(
        "() => [getComputedStyle(document.querySelector('.architecture h3 a')).color,"
        " getComputedStyle(document.body).backgroundColor]"
    )
    assert (ink, ground) == ("rgb(0, 0, 0)", "rgb(255, 255, 255)")
    sheets = page.pdf(format="A4")
    assert 1 <= len(re.findall(rb"/Type\s*/Page\b", sheets)) <= 12
