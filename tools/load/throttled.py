"""`python -m tools.load.throttled`: pages over a slow line, in headless Chromium.

1.6 Mbit/s with 150 ms to and fro, as a telephone has them, nothing kept: neither by the browser nor
in the working store, which is new. The first answer is there when its words are painted, the whole
page when all that it loads has come, its picture included. Exit status 1 where a first answer takes
longer than `FIRST_S` or anything longer than `WHOLE_S`. These are times that pass: on a machine
that does other things they say little, and its load average is printed with them.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from playwright.sync_api import Browser, sync_playwright

from benchmark import datasets
from tests.api.browser.conftest import NAMES, QUIET
from tools.load.__main__ import SERVICE, running

BYTES_PER_S, LATENCY_MS = 1.6e6 / 8, 150
FIRST_S, WHOLE_S = 1.0, 6.0
#: Pictures that take longest to draw, asked for first: soonest after the start.
SLOWEST = ("cmos-encoded-sizes", "ccd-orbit", "ccd-multi-aperture", "cmos-compound-eye")
PAGES = (
    *(f"/datasets/{name}" for name in dict.fromkeys((*SLOWEST, *datasets.names()))),
    *("/", "/figures", "/studies/Liebe2001", "/algorithms/feic", "/claims/C04", "/leaderboard"),
    *("/datasets", "/compare", "/glossary"),
)
_PAINTED = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? null"


@dataclass(frozen=True)
class VisitResult:
    """A visit: seconds to its first words and to all of it, what came, and what went wrong."""

    path: str
    first_s: float
    whole_s: float
    requests: int
    kilobytes: float
    refused: int


def visit(browser: Browser, address: str, path: str) -> VisitResult:
    """Visit a page as a new visitor, down to its end."""
    context = browser.new_context(viewport={"width": 390, "height": 844})
    page = context.new_page()
    session = context.new_cdp_session(page)
    session.send("Network.enable")
    line = {"latency": LATENCY_MS, "offline": False}
    speeds = {"downloadThroughput": BYTES_PER_S, "uploadThroughput": BYTES_PER_S}
    session.send("Network.emulateNetworkConditions", {**line, **speeds})
    session.send("Network.setCacheDisabled", {"cacheDisabled": True})
    came: list[float] = []
    statuses: list[int] = []
    session.on("Network.loadingFinished", lambda event: came.append(event["encodedDataLength"]))
    page.on("response", lambda response: statuses.append(response.status))
    start = time.monotonic()
    page.goto(address + path, wait_until="load", timeout=120_000)
    # A picture further down is loaded when somebody comes near it.
    page.evaluate("for (const one of document.images) one.loading = 'eager'")
    page.wait_for_function(
        "() => [...document.images].every((one) => one.complete)", timeout=120_000
    )
    page.wait_for_load_state("networkidle", timeout=120_000)
    whole = time.monotonic() - start - 0.5  # which is how long the network has to be idle
    painted = page.evaluate(_PAINTED)
    context.close()
    return VisitResult(
        path,
        whole if painted is None else painted / 1e3,
        whole,
        len(came),
        sum(came) / 1e3,
        sum(status >= 400 for status in statuses),
    )


def failures(visited: Sequence[VisitResult]) -> list[str]:
    """Say what is not as wanted, one sentence each."""
    found = []
    for one in visited:
        if one.path == "/" and one.first_s > FIRST_S:
            found.append(f"the first answer took {one.first_s:.2f} s, more than {FIRST_S:g} s")
        if one.whole_s > WHOLE_S:
            found.append(f"{one.path} took {one.whole_s:.2f} s, more than {WHOLE_S:g} s")
        if one.refused:
            found.append(f"{one.path} loads {one.refused} addresses that are refused")
    return found


@contextmanager
def _service(given: str | None) -> Iterator[str]:
    if given is not None:
        yield given
        return
    with tempfile.TemporaryDirectory() as store:
        os.environ["SUNATLAS_STORE"] = store
        with running(SERVICE) as ((host, port), _):
            yield f"http://{host}:{port}"


def _browser() -> str:
    found = next((path for path in map(shutil.which, NAMES) if path), None)
    if found is None:
        raise SystemExit(f"no browser on the PATH: {', '.join(NAMES)}")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Visit every page and print; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.load.throttled", description=__doc__)
    parser.add_argument("--address", help="of a service that runs (default: a new one)")
    given = parser.parse_args(arguments)
    with sync_playwright() as playwright, _service(given.address) as address:
        browser = playwright.chromium.launch(executable_path=_browser(), args=QUIET)
        visited = []
        for path in PAGES:
            one = visit(browser, address, path)
            visited.append(one)
            print(
                f"{path:34s} first {one.first_s:5.2f} s, whole {one.whole_s:5.2f} s, "
                f"{one.requests:3d} requests, {one.kilobytes:6.1f} kB",
                flush=True,
            )
        browser.close()
    print(f"{os.cpu_count()} processors, load average {os.getloadavg()[0]:.1f}")
    wrong = failures(visited)
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
