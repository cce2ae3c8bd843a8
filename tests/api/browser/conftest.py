"""The service in a thread, a browser, and pages of three kinds."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import pytest

from tests.api.browser.visiting import NARROW, PATIENCE_MS, WIDE, Visit
from tests.api.conftest import Client

if TYPE_CHECKING:  # loaded by those alone who open a page
    from playwright.sync_api import Browser

NAMES = ("chromium", "chromium-browser", "google-chrome")
QUIET = ["--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"]


@pytest.fixture(scope="module")
def address(atlas: Client, serve: Callable[..., Any]) -> Iterator[str]:
    with serve(atlas.app, ws="none") as connection:
        yield f"http://{connection.host}:{connection.port}"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import expect, sync_playwright

    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        reason = f"no browser ({', '.join(NAMES)} on the PATH): install chromium to test the page"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    expect.set_options(timeout=PATIENCE_MS)
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=found, args=QUIET, timeout=PATIENCE_MS)
        yield running
        running.close()


def _visit(browser: Browser, address: str, size: tuple[int, int], scheme: Any) -> Iterator[Visit]:
    context = browser.new_context(
        viewport={"width": size[0], "height": size[1]}, color_scheme=scheme, reduced_motion="reduce"
    )
    visit = Visit(context.new_page(), address)
    visit.page.set_default_timeout(PATIENCE_MS)
    visit.page.on("request", lambda request: visit.requests.append(request.url))
    visit.page.on("pageerror", lambda error: visit.complaints.append(str(error)))
    visit.page.on("console", visit.heard)
    yield visit
    context.close()


@pytest.fixture
def wide(browser: Browser, address: str) -> Iterator[Visit]:
    yield from _visit(browser, address, WIDE, "light")


@pytest.fixture
def narrow(browser: Browser, address: str) -> Iterator[Visit]:
    yield from _visit(browser, address, NARROW, "light")


@pytest.fixture
def dark(browser: Browser, address: str) -> Iterator[Visit]:
    yield from _visit(browser, address, WIDE, "dark")
