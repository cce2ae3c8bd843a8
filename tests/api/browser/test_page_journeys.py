"""Ten ways through the atlas, each as someone who comes with a question walks it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from api.pages.dataset import FIRST
from tests.api.browser.visiting import PATIENCE_MS, WIDE, Visit, follow, get_json, tab_to

pytestmark = pytest.mark.slow


def answer(visit: Visit, asked: str) -> Any:
    return get_json(f"{visit.address}/v1/recommendations?{asked}&limit=500")


def test_choose_for_accuracy_and_step_back(wide: Visit) -> None:
    page = wide.go()
    everything = wide.architectures()
    page.locator('.facet-include[data-attribute="task"][data-value="Accuracy"]').click()
    wide.settle()
    page.locator("#max_error_deg").fill("0.05")
    page.locator("#max_error_deg").press("Enter")
    wide.settle()
    found = answer(wide, "task=Accuracy&max_error_deg=0.05")
    assert wide.architectures() == found["count"] < everything
    first = found["architectures"][0]
    name = f"{first['detector']} + {first['mask']}"
    expect(page.locator("#best .best-one strong").first).to_have_text(name)
    # The board follows what is asked, and says how it stands to the limit.
    measured = first["best"]["measured"]
    expect(page.locator("#dataset")).to_have_value(measured["dataset"])
    expect(page.locator("#board-judged")).to_contain_text("Error at most 0.05°")
    page.locator('[name="sort"][value="measured"]').check()
    wide.settle()
    assert wide.query()["sort"] == ["measured"]
    for left in ({"task", "max_error_deg"}, {"task"}, set()):
        page.go_back()
        wide.settle()
        assert set(wide.query()) == left
    assert wide.architectures() == everything


def test_coarse_with_albedo(wide: Visit) -> None:
    page = wide.go("/?accuracy=CSS&survive=albedo")
    found = answer(wide, "accuracy=CSS&survive=albedo")
    assert wide.architectures() == found["count"] > 0
    expect(page.locator("#question")).to_contain_text("albedo")
    page.locator("#board-condition").select_option("nominal")
    wide.settle()
    expect(page.locator("#board-judged")).to_contain_text("not tested by this condition")
    page.locator("#max_latency_us").fill("100")
    page.locator("#max_latency_us").press("Enter")
    wide.settle()
    expect(page.locator("#board-judged")).to_contain_text("meet it")
    page.locator('[name="across"][value="poses"]').check()
    page.wait_for_url("**across=poses**")


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


def test_compare(wide: Visit) -> None:
    page = wide.page
    page.goto(wide.address + "/compare")
    picks = page.locator('select[name="architecture"]')
    picks.nth(0).select_option("CMOS:Encoded")
    picks.nth(1).select_option("QPD:Single-Ap.")
    follow(page.get_by_role("button", name="Compare", exact=True).first)
    heads = page.locator(".side thead th")
    expect(heads).to_have_count(2)
    assert [text.strip() for text in heads.all_inner_texts()] == [
        "CMOS + Encoded",
        "QPD + Single-Ap.",
    ]
    page.locator('select[name="dataset"]').select_option("ccd-lens")
    choose = page.get_by_role("button", name="Choose pipelines")
    follow(page.get_by_role("button", name="Compare", exact=True).last.or_(choose).last)
    ways = page.locator('select[name="pipeline"]')
    ways.nth(0).select_option(index=1)
    ways.nth(1).select_option(index=2)
    follow(page.get_by_role("button", name="Compare", exact=True).last)
    expect(page.locator(".side thead th")).to_have_count(2)
    expect(page.locator("svg.plot")).to_be_visible()


def test_read_a_claim(wide: Visit) -> None:
    page = wide.page
    page.goto(wide.address + "/claims")
    follow(page.locator(".verdict.refuted").first)
    document = get_json(f"{wide.address}/v1/claims?verdict=refuted")
    rows = page.locator("tbody tr")
    expect(rows).to_have_count(document["total"])
    follow(rows.first.locator("a").first)
    claim = get_json(f"{wide.address}/v1/claims/{document['items'][0]['id']}")
    expect(page.locator("h1")).to_contain_text(claim["statement"])
    assert page.locator("#rules ~ table tbody tr").count() == len(claim["rules"])
    page.locator("summary", has_text="The numbers").click()
    assert page.locator("figure table tbody tr").count() > 1


def test_glossary(narrow: Visit) -> None:
    page = narrow.page
    page.goto(narrow.address + "/studies/Chang2008")
    word = page.locator("a.term", has_text="RMS").first
    word.click()
    tip = page.locator(".tip")
    expect(tip).to_contain_text("root mean square")
    box = tip.bounding_box()
    assert box is not None
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 390
    page.keyboard.press("Escape")
    expect(tip).to_have_count(0)
    word.click()
    tip.get_by_role("link").click()
    page.wait_for_url("**/glossary#term-rms")
    expect(page.locator(":target")).to_contain_text("root of the mean", ignore_case=True)


def test_on_a_phone_the_answer_comes_before_the_controls(narrow: Visit) -> None:
    page = narrow.go("/")
    tops = page.evaluate(
        "() => ['#summary', '#best', '#requirements', '#architectures-body'].map("
        "s => document.querySelector(s).getBoundingClientRect().top)"
    )
    assert tops == sorted(tops)
    assert page.locator("#requirements-form").is_hidden()
    page.locator("#requirements-toggle").click()
    page.locator('details[data-group="task"] > summary').click()
    page.locator('.facet-include[data-attribute="task"][data-value="Cost"]').click()
    narrow.settle()
    assert narrow.architectures() == answer(narrow, "task=Cost")["count"]
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_the_keyboard_alone_walks_from_the_answer_to_a_calibration(wide: Visit) -> None:
    page = wide.go("/")
    tab_to(page, ".best-one")
    page.keyboard.press("Enter")
    page.wait_for_url("**/architectures/**")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "content"
    tab_to(page, ".calibration a[href^='/algorithms/']")
    page.keyboard.press("Enter")
    page.wait_for_url("**/algorithms/**")
    expect(page.locator("#ranks")).to_be_visible()


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
    assert plain.get_by_text("Loading").is_hidden()
    plain.locator('select[name="task"]').select_option("Cost")
    follow(plain.get_by_role("button", name="Show the answer"))
    found = get_json(f"{address}/v1/recommendations?task=Cost&limit=500")
    count = f"{found['count']} architectures"
    assert count in plain.locator("#summary").inner_text()
    first = found["architectures"][0]
    assert plain.locator(".architecture strong").first.inner_text() == (
        f"{first['detector']} + {first['mask']}"
    )
    follow(plain.locator("table a", has_text="calibrations").first)
    assert plain.locator(".calibration").count() > 3
    follow(plain.locator("nav a", has_text="Data sets"))
    follow(plain.locator("tbody a").first)
    assert plain.locator("#board ~ table tbody tr").count() > 5


def test_printed_pages_hold_the_answer_in_black_on_white(dark: Visit) -> None:
    page = dark.go("/?task=Accuracy")
    page.emulate_media(media="print", color_scheme="dark")
    assert page.locator(".masthead nav").is_hidden()
    assert page.locator("#requirements").is_hidden()
    assert page.locator(".architecture").first.is_visible()
    ink, ground = page.evaluate(
        "() => [getComputedStyle(document.querySelector('.architecture strong')).color,"
        " getComputedStyle(document.body).backgroundColor]"
    )
    assert (ink, ground) == ("rgb(0, 0, 0)", "rgb(255, 255, 255)")
    sheets = page.pdf(format="A4")
    assert 1 <= len(re.findall(rb"/Type\s*/Page\b", sheets)) <= 12
