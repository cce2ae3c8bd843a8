"""A page in a headless browser, with what it asked for and what it complained about."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs, urlsplit
from urllib.request import urlopen

from filelock import FileLock

from api.guide import site

if TYPE_CHECKING:  # loaded by those alone who open a page
    from playwright.sync_api import ConsoleMessage, Locator, Page

WIDE, NARROW = (1280, 900), (390, 844)
#: Longer than a machine under load ever takes: what does not come at all is what fails.
PATIENCE_MS = 300_000


@dataclass
class Visit:
    """A page, with what it asked for and complained about."""

    page: Page
    address: str
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def go(self, path: str = "/") -> Page:
        self.page.goto(self.address + path)
        self.settle()
        return self.page

    def settle(self) -> None:
        """Wait until nothing is being loaded or drawn."""
        self.page.wait_for_function(
            """() => document.documentElement.dataset.live
                     && !document.querySelector('[aria-busy="true"]')""",
            timeout=PATIENCE_MS,
        )

    def heard(self, message: ConsoleMessage) -> None:
        if message.type in {"error", "warning"}:
            self.complaints.append(message.text)

    def query(self) -> dict[str, list[str]]:
        return parse_qs(urlsplit(self.page.url).query)

    def flow_nodes(self) -> set[str]:
        """Labels of the nodes that the live flow shows, with their numbers."""
        from playwright.sync_api import expect

        flow = self.page.locator("#flow .live-figure")
        flow.scroll_into_view_if_needed()
        expect(flow).to_have_attribute("data-live", "true")
        return set(self.page.locator("#flow .node-label").all_text_contents())

    def names(self) -> list[str]:
        """Architectures in the order of the page."""
        return self.page.locator(".architecture h3").all_inner_texts()

    def architectures(self) -> int:
        """Number of architectures that the summary states."""
        return int(self.page.locator("#summary strong").first.inner_text().split()[0])


def build_guide() -> None:
    """Build the guide's site where the service looks for it, once; a warning is an error."""
    place = site.cached_site()
    assert place is not None
    with FileLock(place.parent / ".lock"):
        done = subprocess.run(
            [sys.executable, "-m", "api.cli.command_line", "guide", "build", "--strict", "--quiet"],
            env=os.environ, capture_output=True, text=True, check=False,
        )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert place.is_dir()


def get_json(address: str) -> Any:
    with urlopen(address, timeout=PATIENCE_MS / 1e3) as response:
        return json.load(response)


def follow(link: Locator) -> None:
    """Click what leads to another page, and wait until the whole of that page is there.

    A click alone returns as soon as the first bytes come, and what is then counted once, without
    waiting, may stand further down.
    """
    with link.page.expect_navigation():
        link.click()


def tab_to(page: Page, selector: str, most: int = 250) -> None:
    """Press Tab until the focus is on an element."""
    for _ in range(most):
        page.keyboard.press("Tab")
        if page.evaluate("s => document.activeElement.matches(s)", selector):
            return
    raise AssertionError(f"Tab does not reach {selector}")
