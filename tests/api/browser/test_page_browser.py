"""The page in a browser against the real service: what an engineer at the keyboard relies on."""

from __future__ import annotations

from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest
from playwright.sync_api import expect

from tests.api.browser.visiting import NARROW, PATIENCE_MS, Visit, get_json, tab_to

pytestmark = pytest.mark.slow


def test_every_chart_draws_without_complaint_and_without_another_host(wide: Visit) -> None:
    for chart in ("answer", "error", "performance", "task", "models"):
        page = wide.go(f"/?flow={chart}")
        assert page.locator("#flow [aria-current]").first.is_visible()
        flow = page.locator("#flow .live-figure")
        flow.scroll_into_view_if_needed()
        expect(flow).to_have_attribute("data-live", "true")
        if chart == "models":
            assert page.locator("#flow .slice").count() > 20
        else:
            assert page.locator("#flow .sankey-node").count() > 5
            assert page.locator("#flow .sankey-link").count() > 10
    assert wide.complaints == []
    assert {urlsplit(url).netloc for url in wide.requests} == {urlsplit(wide.address).netloc}
    with urlopen(wide.address, timeout=PATIENCE_MS / 1e3) as response:
        policy = response.headers["Content-Security-Policy"]
    assert "script-src 'self';" in policy  # no inline script, no evaluation of text


def test_a_requirement_narrows_flow_list_and_address_together(wide: Visit) -> None:
    page = wide.go()
    nodes, names, architectures = wide.flow_nodes(), wide.names(), wide.architectures()
    page.locator('select[name="detector"]').select_option("CMOS")
    page.wait_for_url("**/?detector=CMOS")
    wide.settle()
    narrowed = wide.flow_nodes()
    detectors = {"PD", "QPD", "PDA", "PSD", "CCD", "CMOS", "Event", "PVA"}
    assert {label.split()[0] for label in narrowed} & detectors == {"CMOS"}
    assert {label.split()[0] for label in nodes} & detectors > {"CMOS"}
    answer = get_json(f"{wide.address}/v1/recommendations?detector=CMOS")
    assert wide.architectures() == answer["count"] < architectures
    assert wide.names() == [f"CMOS + {found['mask']}" for found in answer["architectures"]]
    page.go_back()
    page.wait_for_url("**/")
    wide.settle()
    expect(page.locator('select[name="detector"]')).to_have_value("")
    assert (wide.architectures(), wide.names()) == (architectures, names)
    assert wide.flow_nodes() == nodes


def test_a_shared_address_fills_the_form_and_asks_the_same_question(wide: Visit) -> None:
    asked = "task=Accuracy&exclude_mask=Lens&max_error_deg=0.1&min_availability=0.97&tolerate=noise"
    page = wide.go(f"/?{asked}&detector=CMOS&detector=CCD")
    said = page.locator(".asked").inner_text()
    for part in ("task Accuracy", "mask not Lens", "0.1°", "0.97", "noise", "CCD or CMOS"):
        assert part in said
    answer = get_json(f"{wide.address}/v1/recommendations?{asked}&detector=CMOS&detector=CCD")
    assert wide.architectures() == answer["count"] > 0
    page.locator(".submit button").click()  # says the same: the form holds it all
    wide.settle()
    form = page.locator("#question").evaluate(
        "form => [...new FormData(form)].filter(([, v]) => v).map(pair => pair.join('=')).join('&')"
    )
    assert sorted(form.split("&")) == sorted([*asked.split("&"), "detector=CMOS", "detector=CCD"])


def test_a_click_on_a_node_requires_its_value_and_another_takes_it_back(wide: Visit) -> None:
    page = wide.go()
    for then, value in (("**/?detector=CCD", "CCD"), ("**/", "")):
        # Clicked as a user does: it must stand still and lie on top.
        wide.flow_nodes()
        page.locator(".sankey-node", has_text="CCD").locator("rect").first.click()
        page.wait_for_url(then)
        wide.settle()
        expect(page.locator('select[name="detector"]')).to_have_value(value)


def test_the_keyboard_alone_asks_and_opens_calibrations(wide: Visit) -> None:
    page = wide.go()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    tab_to(page, '[name="max_error_deg"]')
    page.keyboard.type("0.1")
    page.keyboard.press("Tab")
    page.wait_for_url("**/?max_error_deg=0.1")
    wide.settle()
    assert page.evaluate("document.activeElement.name") == "confidence", "the focus stays"
    tab_to(page, ".calibrated > summary")
    page.keyboard.press("Enter")
    expect(page.locator(".calibration").first).to_be_visible()


def test_a_server_that_is_gone_is_said_and_asked_again(wide: Visit) -> None:
    page = wide.go()
    page.route("**/?mask=*", lambda route: route.abort())
    page.locator('select[name="mask"]').select_option("Slit")
    expect(page.get_by_role("alert")).to_contain_text("The server does not answer")
    page.unroute("**/?mask=*")
    page.get_by_role("button", name="Try again").click()
    expect(page.get_by_role("alert")).to_have_count(0)
    wide.settle()
    answer = get_json(f"{wide.address}/v1/recommendations?mask=Slit")
    assert wide.architectures() == answer["count"]


@pytest.mark.parametrize(
    "path",
    [
        "/",
        "/?max_error_deg=0.02&bench_deg=0.05",
        "/?mission=leo-cubesat&task=Power",
        "/?detector=Event&mask=Lens&tolerate=spin&min_availability=0.95",
    ],
)
def test_nothing_overflows_a_narrow_screen(narrow: Visit, path: str) -> None:
    page = narrow.go(path)
    page.evaluate("document.querySelectorAll('main details').forEach(d => { d.open = true; })")
    for width in (NARROW[0], 720, 960, 1280):
        page.set_viewport_size({"width": width, "height": NARROW[1]})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert narrow.complaints == []


def test_the_scheme_follows_the_system_until_it_is_chosen(dark: Visit) -> None:
    page = dark.go()
    theme = "document.documentElement.dataset.theme"
    ink = "getComputedStyle(document.querySelector('#flow .node-label')).fill"
    dark.flow_nodes()
    assert page.evaluate(theme) == "dark"
    before = page.evaluate(ink)
    page.locator("#theme-toggle").click()
    dark.settle()
    page.wait_for_function(f"before => {ink} !== before", arg=before)
    assert page.evaluate(theme) == "light"
    dark.go()
    assert page.evaluate(theme) == "light", "the choice is remembered"
