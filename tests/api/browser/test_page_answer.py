"""The answer on the page: no winner where nothing is asked, evidence by kind, ways out of none."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import expect

from api.pages.numbers import degrees
from tests.api.browser.visiting import Visit, follow, get_json

pytestmark = pytest.mark.slow


def answer(visit: Visit, asked: str) -> Any:
    return get_json(f"{visit.address}/v1/recommendations?{asked}")


def test_with_nothing_asked_there_are_three_ways_to_begin_and_no_winner(wide: Visit) -> None:
    page = wide.go()
    cards = page.locator(".start").all_inner_texts()
    titles = ("Most built", "Advised for accuracy", "Lowest simulated")
    assert [card.splitlines()[0] for card in cards] == list(titles)
    (lowest,) = (one for one in answer(wide, "")["cards"] if one["title"] == "lowest simulated")
    assert lowest["words"] in cards[2]
    assert ("built by nobody" in cards[2]) != lowest["built"]
    assert page.locator(".architecture .rank").count() == 0
    assert "no ranking" in page.locator("#answer").inner_text()
    picture = page.locator(".scatter .live-figure")
    picture.scroll_into_view_if_needed()
    expect(picture).to_have_attribute("data-live", "true")
    assert picture.locator(".scatterlayer .point").count() > 20
    assert "error in flight, °" in (picture.text_content() or "")
    assert wide.names() == [
        f"{a['detector']} + {a['mask']}" for a in answer(wide, "")["architectures"]
    ]


def test_each_architecture_says_which_evidence_meets_which_requirement(wide: Visit) -> None:
    asked = "detector=CMOS&max_error_deg=0.1&min_fov_deg=120"
    found = answer(wide, f"{asked}&include=calibrations")["architectures"]
    page = wide.go(f"/?{asked}")
    rows = page.locator(".architecture").all()
    assert len(rows) == len(found) > 3
    for row, one in zip(rows, found, strict=True):
        rank = row.locator(".rank").inner_text().split()[-1]
        assert rank == f"{one['rank']}{'=' if one['tied'] else ''}"
        assert row.locator(".reason").inner_text() == one["reason"]
        states = [
            [cell for cell in line.locator("td").all_inner_texts() if cell != "–"]
            for line in row.locator(".states tbody tr").all()
        ]
        kinds = ("reported", "measured", "advised")
        assert states == [[e[kind] for kind in kinds if e[kind]] for e in one["evidence"]]
        measured, said = one["best"]["measured"], row.locator(".best").inner_text()
        assert f"error in flight {degrees(measured['flight_error_deg'])}" in said
        assert f"own error {degrees(measured['own_error_deg'])}" in said
        needed = measured["needs_bench_deg"]
        bench = f"Needs a calibration bench of {needed:g}° or better"
        assert (bench if needed else "No calibration bench is good enough") in said
        for report in one["reports"]:
            assert (report["name"] or report["key"]) in row.locator(".reports").inner_text()
        dois = {f"https://doi.org/{report['doi']}" for report in one["reports"] if report["doi"]}
        links = row.locator(".reports a[href^='https:']").evaluate_all(
            "all => all.map(a => a.href)"
        )
        assert set(links) == dois
        assert bool(one["count"]) == bool(row.locator(".calibrated").count())
        if not one["count"]:  # reports alone bring it in
            continue
        row.locator(".calibrated > summary").click()
        names = row.locator(".calibration .method").all_inner_texts()
        assert names == [
            f"{c['measured']['extractor']} + {c['measured']['model']}" for c in one["calibrations"]
        ]


@pytest.mark.parametrize(
    "asked", ["detector=Event&mask=Lens", "mission=leo-cubesat&max_error_deg=0.00001"]
)
def test_no_match_says_why_and_each_change_leads_to_as_many_as_it_says(
    wide: Visit, asked: str
) -> None:
    page = wide.go(f"/?{asked}")
    blocked = answer(wide, asked)["blocked"]
    assert blocked["detail"][1:] in page.locator(".blocked").inner_text()
    links = page.locator(".blocked li")
    assert links.count() == len(blocked["relaxations"]) > 0
    for at in (0, len(blocked["relaxations"]) - 1):
        wide.go(f"/?{asked}")
        follow(links.nth(at).locator("a"))
        wide.settle()
        assert wide.architectures() == blocked["relaxations"][at]["architectures"]
