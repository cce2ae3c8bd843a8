"""The service in a thread, a browser, and pages of three kinds."""

from __future__ import annotations

import os
import shutil
import socket
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
import uvicorn
from playwright.sync_api import Browser, expect, sync_playwright

from tests.api.browser.delivery import InPieces
from tests.api.browser.visiting import NARROW, PATIENCE_MS, WIDE, Visit
from tests.api.conftest import Client

NAMES = ("chromium", "chromium-browser", "google-chrome")
QUIET = ["--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"]


@pytest.fixture(scope="module")
def address(atlas: Client) -> Iterator[str]:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        options = {"log_level": "warning", "ws": "none", "lifespan": "off"}
        server = uvicorn.Server(uvicorn.Config(InPieces(atlas.app), **options))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        deadline = time.monotonic() + PATIENCE_MS / 1e3
        while not server.started:
            assert thread.is_alive(), "the service did not start"
            assert time.monotonic() < deadline, "the service did not start"
            time.sleep(0.05)
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        server.should_exit = True
        thread.join(timeout=PATIENCE_MS / 1e3)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
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
