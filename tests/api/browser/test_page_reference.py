"""The API reference in headless Chromium: Swagger UI shows all operations, nothing is from afar."""

from __future__ import annotations

import pytest

from tests.api.browser.visiting import Visit, get_json

pytestmark = pytest.mark.slow


def test_the_reference_shows_every_operation_and_asks_the_service(wide: Visit) -> None:
    page = wide.page
    page.goto(f"{wide.address}/docs")
    page.locator(".opblock").nth(4).wait_for()
    paths = get_json(f"{wide.address}/openapi.json")["paths"]
    operations = sum(len(item) for item in paths.values())
    assert page.locator(".opblock").count() == operations > 40
    page.locator("#operations-Literature-taxonomy .opblock-summary-control").click()
    page.get_by_role("button", name="Try it out").click()
    page.get_by_role("button", name="Execute").click()
    page.locator(".live-responses-table .response-col_status").get_by_text("200").first.wait_for()
    assert all(url.startswith((wide.address, "data:", "blob:")) for url in wide.requests)
    assert wide.complaints == []
