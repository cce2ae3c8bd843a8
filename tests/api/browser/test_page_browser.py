"""The page in a browser against the real service: what an engineer at the keyboard relies on."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest
from playwright.sync_api import Route, expect

from registry.studies import facts
from tests.api.browser.visiting import NARROW, PATIENCE_MS, Visit, get_json, tab_to

pytestmark = pytest.mark.slow


def test_every_chart_draws_without_complaint_and_without_another_host(wide: Visit) -> None:
    page = wide.go()
    for chart in ("cross-analysis", "error", "performance", "task", "model-sunburst"):
        page.locator("#chart").select_option(chart)
        page.locator(f'.diagram[data-chart="{chart}"]').wait_for()
        wide.settle()
        if chart == "model-sunburst":
            assert page.locator(".slice").count() > 20
        else:
            assert page.locator(".sankey-node").count() > 5
            assert page.locator(".sankey-link").count() > 10
    assert wide.complaints == []
    assert {urlsplit(url).netloc for url in wide.requests} == {urlsplit(wide.address).netloc}
    with urlopen(wide.address, timeout=PATIENCE_MS / 1e3) as response:
        policy = response.headers["Content-Security-Policy"]
    assert "script-src 'self';" in policy  # no inline script, no evaluation of text


def test_a_requirement_narrows_flow_architectures_and_address_together(wide: Visit) -> None:
    page = wide.go()
    nodes, architectures = wide.flow_nodes(), wide.architectures()
    page.locator('.facet-include[data-attribute="detector"][data-value="CMOS"]').click()
    wide.settle()
    assert wide.query() == {"detector": ["CMOS"]}
    narrowed = wide.flow_nodes()
    assert {n for n in narrowed if n.startswith("detector:")} == {"detector:CMOS"}
    assert narrowed < nodes
    answer = get_json(f"{wide.address}/v1/recommendations?detector=CMOS&limit=500")
    assert wide.architectures() == answer["count"] < architectures
    shown = page.locator(".architecture .pictured strong").all_inner_texts()
    assert shown == [f"CMOS + {found['mask']}" for found in answer["architectures"]]
    page.go_back()
    wide.settle()
    assert wide.architectures() == architectures
    button = page.get_by_role("button", name=f"Show all {architectures} architectures")
    button.click()
    assert page.locator(".architecture").count() == architectures
    assert page.evaluate("document.activeElement.className") == "expand"
    assert wide.flow_nodes() == nodes


def test_a_shared_address_asks_the_same_question(wide: Visit) -> None:
    page = wide.go(
        "/?task=Accuracy&exclude_mask=Lens&max_error_deg=0.1&min_availability=0.97"
        "&survive=noise&properties=Robust%20to%20noise&chart=error&view=table"
    )
    question = page.locator("#question").inner_text()
    for part in ("Accuracy", "Lens", "0.1°", "97 %", "noise", "Robust to noise"):
        assert part in question
    answer = get_json(
        f"{wide.address}/v1/recommendations?task=Accuracy&exclude_mask=Lens&max_error_deg=0.1"
        "&min_availability=0.97&survive=noise&properties=Robust%20to%20noise"
    )
    assert wide.architectures() == answer["count"] > 0
    assert page.locator("#min_availability").input_value() == "97"
    assert page.locator("#chart").input_value() == "error"
    assert page.locator(".level-list").is_visible()


def test_a_click_on_a_node_requires_its_value_and_another_takes_it_back(wide: Visit) -> None:
    page = wide.go()
    for then in ("**/?detector=CCD", "**/"):
        # Clicked as a user does: it must stand still and lie on top.
        page.locator(".sankey-node", has_text="CCD").locator(".node-rect").click()
        page.wait_for_url(then)
        wide.settle()


def test_fractional_counts_of_the_page_share_each_study_among_its_paths(wide: Visit) -> None:
    """Once for each combination of its groups; the survey's charts count compared methods, too."""
    page = wide.go("/?counting=fractional&view=table")
    drawn = page.evaluate(
        """async () => {
            const data = await import('/page/flow_data.js');
            const { Vocabulary } = await import('/page/wording.js');
            const ask = async (url) => (await fetch(url)).json();
            const words = new Vocabulary((await ask('/v1/taxonomy')).attributes);
            const answer = await ask('/v1/recommendations?limit=500');
            const all = {
                levels: ['task', 'detector', 'mask', 'model', 'extractor'],
                counting: 'fractional', nodes: answer.nodes, links: answer.links,
            };
            return data.fractional(data.grouped(all, words), answer.paths, words);
        }"""
    )
    group, combinations = facts().taxonomy.category, {}
    for path in get_json(f"{wide.address}/v1/recommendations?limit=500")["paths"]:
        values = (
            *(f"{level}:{path[level]}" for level in ("task", "detector", "mask")),
            f"model_category:{group('model', path['model'])}",
            f"extractor_family:{group('extractor', path['extractor'])}",
        )
        for key in path["studies"]:
            combinations.setdefault(key, set()).add(values)
    nodes, links = Counter(), Counter()
    for shares in combinations.values():
        for values in shares:
            nodes.update(dict.fromkeys(values, Fraction(1, len(shares))))
            links.update(dict.fromkeys(pairwise(values), Fraction(1, len(shares))))
    assert {n["id"]: n["amount"] for n in drawn["nodes"]} == pytest.approx(
        {name: float(amount) for name, amount in nodes.items()}
    )
    assert {(k["source"], k["target"]): k["value"] for k in drawn["links"]} == pytest.approx(
        {ends: float(amount) for ends, amount in links.items()}
    )


def test_a_refusal_is_shown_as_the_service_words_it(wide: Visit) -> None:
    page = wide.go("/?detector=CMOSS")
    alert = page.get_by_role("alert").inner_text()
    assert "CMOSS" in alert
    assert "did you mean “CMOS”" in alert


def test_the_keyboard_alone_requires_a_value_opens_evidence_and_sorts(wide: Visit) -> None:
    rows = [
        {"extractor": name, "model": "m", "status": "ok", "rms_deg": rms, "bound_deg": 0.01,
         "over_bound": rms / 0.01, "availability": found, "false_sun": None, "time_ratio": 1.0,
         "rank": rank, "tied": False, "studies": []}
        for rank, (name, rms, found) in enumerate((("a", 0.02, 0.5), ("b", 0.03, 1.0),
                                                   ("c", 0.04, 0.75)))
    ]  # fmt: skip

    def board(route: Route) -> None:
        route.fulfill(json={"items": rows, "total": len(rows), "next": None})

    wide.page.route("**/v1/leaderboard/*", board)
    page = wide.go("/?view=table")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    tab_to(page, '.facet-include[data-attribute="task"][data-value="Cost"]')
    page.keyboard.press("Space")
    wide.settle()
    assert wide.query()["task"] == ["Cost"]
    focused = "document.activeElement.getAttribute('aria-pressed')"
    assert page.evaluate(focused) == "true", "the focus stays on the value"
    tab_to(page, ".architectures .expand")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.getAttribute('aria-expanded')") == "true"
    assert page.locator(".calibration").first.is_visible()
    tab_to(page, '[data-sort="availability"]')
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")  # the focus stays on the heading: a second press turns the order
    heading = page.locator("th", has=page.locator('[data-sort="availability"]'))
    assert heading.get_attribute("aria-sort") == "descending"
    assert [t.split()[1] for t in page.locator(".score").all_inner_texts()] == ["b", "c", "a"]
    assert "Availability, descending" in page.locator("#board-status").inner_text()


def test_a_value_of_the_table_is_required_and_keeps_the_focus(wide: Visit) -> None:
    page = wide.go("/?view=table")
    tab_to(page, '.level-value[data-node="detector:CCD"]')
    page.keyboard.press("Enter")
    wide.settle()
    assert wide.query()["detector"] == ["CCD"]
    focused = page.locator(":focus")
    assert focused.get_attribute("data-node") == "detector:CCD"
    assert focused.get_attribute("aria-pressed") == "true"


def test_a_server_that_is_gone_is_said_and_asked_again(wide: Visit) -> None:
    page = wide.go("/?view=table")
    page.route("**/v1/recommendations*", lambda route: route.abort())
    page.locator('.facet-include[data-attribute="task"][data-value="Cost"]').click()
    expect(page.get_by_role("alert")).to_contain_text("The server does not answer")
    page.unroute("**/v1/recommendations*")
    page.get_by_role("button", name="Try again").click()
    wide.settle()
    answer = get_json(f"{wide.address}/v1/recommendations?task=Cost")
    assert wide.architectures() == answer["count"]
    assert page.get_by_role("alert").count() == 0


@pytest.mark.parametrize(
    "path",
    [
        "/?task=Accuracy",
        "/?view=table&detail=all&survive=albedo&sort=measured",
        "/?detector=Event&mask=Lens&survive=spin&min_availability=0.95",
    ],
)
def test_nothing_overflows_a_narrow_screen(narrow: Visit, path: str) -> None:
    page = narrow.go(path)
    for button in page.locator(".expand").all()[:2]:
        button.click()
    for summary in page.locator(".evidence > details:visible > summary").all():
        summary.click()
    if page.locator(".study details summary").count():
        page.locator(".study details summary").first.click()
        expect(page.locator(".provenance table").first).to_be_visible()
    for width in (NARROW[0], 720, 960):
        page.set_viewport_size({"width": width, "height": NARROW[1]})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert narrow.complaints == []


CONTRAST = (Path(__file__).parent / "page_contrast.js").read_text(encoding="utf-8")


@pytest.mark.parametrize("scheme", ["wide", "dark"])
def test_text_is_readable_in_both_schemes(scheme: str, request: pytest.FixtureRequest) -> None:
    visit: Visit = request.getfixturevalue(scheme)
    page = visit.go("/?task=Accuracy&exclude_mask=Lens&view=table")
    page.locator(".expand").first.click()
    selectors = ["h1", "h2", "p", "a", "th", "td", "button", "label", "select", "summary", "span"]
    ratios = page.evaluate(CONTRAST, selectors)
    assert set(ratios) == set(selectors)
    assert {s: r for s, r in ratios.items() if r < 4.5} == {}


def test_the_scheme_follows_the_system_until_it_is_chosen(dark: Visit) -> None:
    page = dark.go()
    theme = "document.documentElement.dataset.theme"
    ink = "getComputedStyle(document.querySelector('.sankey-node .node-label')).fill"
    assert page.evaluate(theme) == "dark"
    before = page.evaluate(ink)
    page.locator("#theme-toggle").click()
    dark.settle()
    page.wait_for_function(f"before => {ink} !== before", arg=before)
    assert page.evaluate(theme) == "light"
    dark.go()
    assert page.evaluate(theme) == "light", "the choice is remembered"


def test_the_masthead_keeps_to_one_line_above_what_sticks_below_it(wide: Visit) -> None:
    page = wide.go("/")
    for width in (901, 1060, 1061, 1140, 1141, 1280, 1600):
        page.set_viewport_size({"width": width, "height": 900})
        bottom, top, jumped_to = page.evaluate(
            "() => [document.querySelector('.masthead').getBoundingClientRect().height,"
            " parseFloat(getComputedStyle(document.querySelector('#requirements')).top),"
            " parseFloat(getComputedStyle(document.documentElement).scrollPaddingTop)]"
        )
        assert bottom < min(top, jumped_to), width
        assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("width", [701, 900, 1000, 1140, 1141])
def test_between_phone_and_desk_no_word_of_the_answer_runs_over_its_cell(
    wide: Visit, width: int
) -> None:
    wide.page.set_viewport_size({"width": width, "height": 900})
    page = wide.go("/?task=Accuracy&detector=CMOS&min_fov_deg=100")
    assert page.locator("#requirements-form").is_visible() == (width > 1140)
    over = page.locator(".architectures td, .architectures th").evaluate_all(
        "cells => cells.filter(cell => cell.scrollWidth > cell.clientWidth)"
        ".map(cell => cell.textContent)"
    )
    assert over == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
