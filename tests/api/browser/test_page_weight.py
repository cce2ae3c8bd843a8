"""What the first answer weighs: bytes as they are sent, and how often the browser has to ask."""

from __future__ import annotations

from dataclasses import dataclass, field
from urllib.parse import urlsplit

import pytest

from tests.api.browser.visiting import Visit

pytestmark = pytest.mark.slow

#: A slow mobile line: 1.6 Mbit/s with 150 ms to and fro.
BYTES_PER_S, LATENCY_S = 1.6e6 / 8, 0.15


@dataclass
class Traffic:
    """Bytes of every answer by path, as sent: compressed, with their headers."""

    paths: dict[str, str] = field(default_factory=dict)
    bytes: dict[str, int] = field(default_factory=dict)

    def weight(self, *beginnings: str) -> int:
        return sum(n for path, n in self.bytes.items() if path.startswith(beginnings))


@pytest.fixture
def traffic(wide: Visit) -> Traffic:
    seen = Traffic()
    session = wide.page.context.new_cdp_session(wide.page)
    session.send("Network.enable")
    session.on(
        "Network.requestWillBeSent",
        lambda event: seen.paths.__setitem__(
            event["requestId"], urlsplit(event["request"]["url"]).path
        ),
    )
    session.on(
        "Network.loadingFinished",
        lambda event: seen.bytes.__setitem__(
            seen.paths[event["requestId"]], int(event["encodedDataLength"])
        ),
    )
    return seen


def test_the_first_answer_is_light_and_one_round_after_the_page(
    wide: Visit, traffic: Traffic
) -> None:
    page = wide.go("/?task=Accuracy&tolerate=albedo")
    page.wait_for_load_state("networkidle")
    # What is drawn first waits for the page, its styles and the one classic script: no answer of
    # the service, no module.
    styles = tuple(path for path in traffic.bytes if path.endswith(".css"))
    first = traffic.bytes["/"] + traffic.weight("/page/theme.js", *styles)
    assert len(styles) >= 4
    assert first < 50_000
    assert sum(traffic.bytes.values()) < 300_000
    assert not [path for path in traffic.bytes if "plotly" in path]
    # To connect, for the page, for its styles; then the bytes themselves.
    assert 3 * LATENCY_S + first / BYTES_PER_S < 1.0
    # Modules name modules, these ask the service: four rounds more.
    assert 7 * LATENCY_S + sum(traffic.bytes.values()) / BYTES_PER_S < 6.0
