"""Figures in a browser: the drawing that fits is shown, and nothing in it overlaps as drawn."""

from __future__ import annotations

import itertools
from typing import Any

import pytest
from playwright.sync_api import Browser

from tests.api.browser.visiting import follow
from tests.api.figures.geometry import Shape, overlap

pytestmark = pytest.mark.slow

PATHS = [
    *("/figures/error", "/figures/performance", "/figures/cross-analysis", "/figures/task"),
    *("/figures/aggregate", "/figures/models", "/figures/publications", "/figures/coordinates"),
    *("/figures/matrix", "/figures/matrix?rows=model&columns=extractor"),
]
WIDTHS = (390, 700, 1000, 1280, 1600)

# Corners on the screen of what the browser drew, turned texts as turned: box by getBBox, placed by
# the matrix of the element. Lines of a text are measured one by one.
BOXES = """() => {
  const drawn = [...document.querySelectorAll('.live-figure > svg')]
    .filter((svg) => svg.getBoundingClientRect().width > 0);
  const svg = drawn[0];
  const corners = (element, x, y, w, h) => {
    const m = element.getScreenCTM();
    return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
      .map(([a, b]) => [m.a * a + m.c * b + m.e, m.b * a + m.d * b + m.f]);
  };
  const box = (element) => {
    const b = element.getBBox();
    return corners(element, b.x, b.y, b.width, b.height);
  };
  const boxes = [];
  for (const element of svg.querySelectorAll('rect, text')) {
    const kind = element.tagName;
    const lines = kind === 'text' ? [...element.querySelectorAll(':scope > tspan[x]')] : [];
    const parts = lines.length ? lines : [element];
    for (const part of parts) {
      boxes.push({kind, said: kind === 'rect' ? element.getAttribute('class') : part.textContent,
                  classes: element.getAttribute('class'), corners: box(part)});
    }
  }
  const frame = svg.getBoundingClientRect();
  return {shown: drawn.length, boxes, frame: [frame.left, frame.top, frame.right, frame.bottom],
          overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
          smallest: Math.min(...[...svg.querySelectorAll('text')].map(
            (t) => parseFloat(t.getAttribute('font-size')) * svg.getScreenCTM().a))};
}"""


def shape(box: dict[str, Any]) -> Shape:
    corners = tuple((x, y) for x, y in box["corners"])
    return Shape(box["kind"], box["said"], frozenset(box["classes"].split()), corners)


def inside_its_cell(a: Shape, b: Shape) -> bool:
    """Say whether one is a cell of a matrix and the other a letter or the dot in it."""
    both = a.classes | b.classes
    return "cell" in both and (a.kind != b.kind or "dot" in both)


@pytest.mark.parametrize("path", PATHS)
def test_nothing_overlaps_as_the_browser_draws_it(
    browser: Browser, address: str, path: str
) -> None:
    context = browser.new_context(viewport={"width": WIDTHS[0], "height": 900})
    page = context.new_page()
    errors: list[str] = []
    page.on("console", lambda message: errors.append(message.text))
    page.goto(address + path)
    drawn = set()
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        found = page.evaluate(BOXES)
        assert found["shown"] == 1, "one drawing at each width"
        assert found["overflow"] <= 0, f"{width} px"
        assert found["smallest"] >= 10.5, "letters stay readable"
        boxes = [shape(box) for box in found["boxes"]]
        drawn.add(len(boxes))
        overlapping = [
            (a.said, b.said)
            for a, b in itertools.combinations(boxes, 2)
            if not inside_its_cell(a, b) and overlap(a, b)
        ]
        assert overlapping == [], f"{width} px"
        left, top, right, bottom = found["frame"]
        for box in boxes:
            for x, y in box.corners:
                assert left - 1 <= x <= right + 1, (width, box.said)
                assert top - 1 <= y <= bottom + 1, (width, box.said)
    assert errors == []
    assert min(drawn) > 10
    context.close()


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
