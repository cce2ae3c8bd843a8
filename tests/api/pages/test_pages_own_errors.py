"""One own error a pipeline and data set, the same on every page, in commands and documents."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from html import unescape
from typing import Any

from api.cli.commands.studies import _rungs
from api.pages.numbers import degrees
from api.service.knowledge import Knowledge
from benchmark.leaderboard.summaries import digits
from tests.api.conftest import Client
from tests.api.pages.addresses import KINDS
from tests.api.pages.test_pages_content import text_of

HOOK = re.compile(
    r'<data class="own-error" value="(?P<value>[^"]+)" data-of="(?P<of>[^"]+)">'
    r"(?P<text>[^<]+)</data>"
)
BELOW = re.compile(r'<span class="below[^"]*">.*?</span>', re.DOTALL)
CELL = re.compile(r'<td data-label="Own error[^"]*"[^>]*>(.*?)</td>', re.DOTALL)
Place = tuple[str, ...]


def shown(html: str) -> Iterator[tuple[Place, float, str]]:
    """Own errors of a page: data set, extractor and model, number, and what is read."""
    for hook in HOOK.finditer(html):
        yield tuple(unescape(hook["of"]).split("|")), float(hook["value"]), hook["text"]


def require_the_record(known: Knowledge, client: Client, pages: Iterable[str]) -> int:
    """Require that every own error of some pages is the record's; return of how many pipelines."""
    record: Mapping[Any, Mapping[str, Any]] = known.measurements.nominal
    board = {
        (row["dataset"], row["extractor"], row["model"]): row["own_error_deg"]
        for row in known.measurements.board_rows()
        if row["condition"] == "nominal"
    }
    met: dict[Place, set[str]] = {}
    for address in pages:
        html = client.get(address, accept="text/html").text
        for place, value, text in shown(html):
            assert value == record[place]["own_error_deg"] == board[place], (address, place)
            met.setdefault(place, set()).add(text)
        for cell in CELL.findall(html):
            bare = BELOW.sub("", HOOK.sub("", cell))
            assert "RMS over units" in cell or "°" not in bare, (address, cell)
    for place, texts in met.items():
        assert texts == {degrees(board[place])}, place
    return len(met)


def test_own_errors_of_one_page_of_each_kind_are_the_records(
    knowledge: Knowledge, atlas: Client
) -> None:
    assert require_the_record(knowledge, atlas, KINDS.values()) > 40


def test_a_study_is_a_ladder_on_one_data_set_and_condition(
    knowledge: Knowledge, atlas: Client
) -> None:
    document = atlas.get("/v1/studies/Zhang2021").json()
    ladder = document["ladder"]
    rows = [
        row
        for row in knowledge.measurements.board_rows(ladder["dataset"])
        if row["condition"] == ladder["condition"]
    ]
    own = next(
        row for row in rows if all(row[n] == ladder["own"][n] for n in ("extractor", "model"))
    )
    assert ladder["own"]["own_error_deg"] == own["own_error_deg"]
    assert ladder["best"]["own_error_deg"] == rows[0]["own_error_deg"]
    assert ladder["own"]["own_error_deg"] == min(
        score["own_error_deg"]
        for pipeline in document["pipelines"]
        for score in pipeline["scores"]
        if (score["dataset"], score["condition"]) == (ladder["dataset"], ladder["condition"])
    )
    html = atlas.get("/studies/Zhang2021", accept="text/html").text
    rungs = html[html.index('class="ladder"') : html.index('id="attributes"')]
    read = text_of(rungs)
    reported = document["reported_accuracy"]
    assert f"{degrees(reported['rms_deg'])} RMS" in read
    assert f"{degrees(ladder['bound_deg'])} with the unit known" in read
    assert f"/datasets/{ladder['dataset']}?condition={ladder['condition']}#board" in rungs
    assert f"/calibrate?model={ladder['own']['model']}" in rungs
    lines = " ".join(_rungs(ladder))
    for rung in (ladder["own"], ladder["best"]):
        assert degrees(rung["own_error_deg"]) in read
        assert f"own error {digits(rung['own_error_deg'])} deg" in lines
