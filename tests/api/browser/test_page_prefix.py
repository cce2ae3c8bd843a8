"""Scripts behind a proxy under a prefix: what they ask for and where they lead stays below it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.api.browser.visiting import Visit
from tests.api.conftest import Client
from tests.api.server.test_prefix import proxied

pytestmark = pytest.mark.slow


def test_scripts_ask_and_lead_below_the_prefix(
    wide: Visit, atlas: Client, serve: Callable[..., Any]
) -> None:
    with proxied(atlas, serve, "/atlas") as client:
        page, start = wide.page, f"{client.base_url}/atlas/"
        wide.requests.clear()
        page.goto(start)
        wide.settle()
        page.get_by_label("Largest error, degrees").fill("0.05")
        page.keyboard.press("Tab")
        page.wait_for_function("() => location.search")
        wide.settle()
        figure = page.locator(".live-figure").first
        figure.scroll_into_view_if_needed()
        expect(figure).to_have_attribute("data-live", "true")
        mark = figure.locator(".figure-marks a").first
        assert (mark.get_attribute("href") or "").startswith("/atlas/")
        page.goto(f"{start}calibrate")
        sample = page.request.get(f"{start}calibrate/sample.csv").body()
        file: Any = {"name": "sample.csv", "mimeType": "text/csv", "buffer": sample}
        page.locator("input[type=file]").set_input_files(files=[file])
        page.locator("#columns th").first.wait_for()
        page.goto(f"{start}docs")
        page.locator("#operations-Literature-taxonomy .opblock-summary-control").click()
        page.get_by_role("button", name="Try it out").click()
        page.get_by_role("button", name="Execute").click()
        page.locator(".live-responses-table .response-col_status").get_by_text(
            "200"
        ).first.wait_for()
        assert all(url.startswith((start, "data:", "blob:")) for url in wide.requests)
        assert wide.complaints == []
