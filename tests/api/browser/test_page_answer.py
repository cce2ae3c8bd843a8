"""The answer on the page: three kinds of evidence apart, calibrations, and what would help."""

from __future__ import annotations

from typing import Any
from urllib.parse import quote

import pytest
from playwright.sync_api import Locator, expect

from api.pages.answer import KINDS
from api.pages.terms import display_text as named
from tests.api.browser.visiting import Visit, get_json

pytestmark = pytest.mark.slow


def answer(visit: Visit, asked: str) -> Any:
    return get_json(f"{visit.address}/v1/recommendations?{asked}")


def written(error_deg: float) -> str:
    """An error as the page writes it: three significant digits, no exponent."""
    digits = f"{error_deg:#.3g}"
    assert "e" not in digits
    return f"{digits.rstrip('.')}°"


def kind(row: Locator, name: str) -> str:
    return row.locator(f"td.kind.{name}").inner_text()


def test_each_architecture_shows_advice_studies_and_measurement_in_columns_of_their_own(
    wide: Visit,
) -> None:
    asked = "task=Accuracy&survive=albedo&limit=500"
    found = answer(wide, asked)["architectures"]
    page = wide.go(f"/?{asked}&view=table")
    page.get_by_role("button", name=f"Show all {len(found)} architectures").click()
    headings = page.locator(".architectures > thead th.kind").all_inner_texts()
    assert headings == [label for _, label in KINDS]
    rows = page.locator(".architecture").all()
    assert len(rows) == len(found) > 10
    for row, architecture in zip(rows, found, strict=True):
        advised, proposed, measured = (kind(row, n) for n in ("advised", "proposed", "measured"))
        assert ("for Accuracy" in advised) == architecture["advised"]
        assert all(one["section"] in advised for one in architecture["advice"])
        studies, best = architecture["studies"], architecture["best"]["measured"]
        assert proposed.split()[0] == str(len(studies))
        assert row.locator("td.proposed a").all_inner_texts() == studies[:2]
        assert written(best["error_deg"]) in measured
        assert f"{best['dataset']}, {best['condition']}" in measured
        tags = row.locator(".tag").all_inner_texts()
        assert len(tags) == len(architecture["tasks"])
        for tag, task in zip(tags, architecture["tasks"], strict=True):
            assert tag.startswith("✓") == task["advised"]
            assert task["task"] in tag
    assert len({kind(row, "advised") for row in rows}) > 1


def test_a_row_opens_to_its_calibrations_the_best_measured_among_them(wide: Visit) -> None:
    asked = "detector=CMOS&mask=Encoded"
    (architecture,) = answer(wide, f"{asked}&calibrations=500")["architectures"]
    page = wide.go(f"/?{asked}&view=table")
    page.locator(".expand").first.click()
    assert 0 < page.locator(".calibration").count() < architecture["count"]
    expect(page.locator(".calibration .pareto-mark")).to_have_count(1)
    page.get_by_role("button", name=f"Show all {architecture['count']} calibrations").click()
    rows = page.locator(".calibration")
    expect(rows).to_have_count(architecture["count"])
    for row, calibration in zip(rows.all(), architecture["calibrations"], strict=True):
        stages = [*calibration["compensations"], calibration["model"]]
        labels = [
            named(calibration["extractor"], "extractor"),
            *(named(stage, "model") for stage in stages),
        ]
        assert [text.strip() for text in row.locator(".labels li").all_inner_texts()] == labels
        measured = calibration["measured"]
        name = f"{measured['extractor']} + {measured['model']}"
        assert row.locator(".method").inner_text() == name
        unproposed = "not in the literature" in kind(row, "proposed")
        assert unproposed == (not calibration["studies"])
        if calibration["measured"]["error_deg"] is not None:
            assert written(calibration["measured"]["error_deg"]) in kind(row, "measured")
    assert any(not calibration["studies"] for calibration in architecture["calibrations"])
    assert wide.complaints == []


def test_studies_of_a_row_show_the_basis_of_each_value(wide: Visit) -> None:
    page = wide.go("/?task=Accuracy&view=table")
    page.locator(".expand").first.click()
    page.locator(".detail summary", has_text="basis of each value").click()
    keys = answer(wide, "task=Accuracy&limit=1")["architectures"][0]["studies"]
    expect(page.locator(".study")).to_have_count(len(keys))
    page.locator(".study details summary").first.click()
    table = page.locator(".provenance table").first
    expect(table).to_be_visible()
    study = get_json(f"{wide.address}/v1/studies/{keys[0]}")
    text = table.inner_text()
    for row in study["attributes"]:
        assert row["basis"] in text
        assert row["value"] is None or row["value"] in text


def test_what_disagrees_costs_or_is_not_tried_stands_above_the_table(wide: Visit) -> None:
    page = wide.go("/?view=table")
    found = answer(wide, "")
    said = page.locator("#findings").inner_text()
    assert found["contradictions"]
    for sentence in [*found["contradictions"], found["regret"]["sentence"]]:
        assert sentence[1:] in said
    at = next(a["rank"] for a in found["architectures"] if a["contradiction"])
    page.locator(f'[aria-controls="architecture-{at}"]').click()
    sentence = found["architectures"][at - 1]["contradiction"]
    assert sentence[1:] in page.locator(f"#architecture-{at} .contradiction").inner_text()
    page = wide.go("/?view=table&error=Manufacturing")  # what is advised for it errs more
    costs = answer(wide, "error=Manufacturing")["regret"]
    assert costs["ratio"] > 2
    assert costs["sentence"][1:] in page.locator("#findings").inner_text()
    page.get_by_role("button", name="Rank by measurement").click()
    wide.settle()
    assert wide.query()["sort"] == ["measured"]
    best = answer(wide, "error=Manufacturing&sort=measured&limit=1")
    assert best["regret"]["sentence"][1:] in page.locator("#findings").inner_text()
    first = best["architectures"][0]
    assert page.locator(".architecture strong").first.inner_text() == (
        f"{first['detector']} + {first['mask']}"
    )
    page.locator('[data-list="survive"][data-value="spin"]').evaluate("button => button.click()")
    wide.settle()
    untried = answer(wide, "error=Manufacturing&survive=spin")["untried"]["spin"]
    assert f"on {len(untried)} architectures" in page.locator("#findings").inner_text()


def test_the_order_is_chosen_by_the_keyboard_and_keeps_the_focus(wide: Visit) -> None:
    page = wide.go("/?view=table")
    page.locator('[name="sort"]:checked').focus()
    page.keyboard.press("ArrowRight")
    wide.settle()
    assert wide.query()["sort"] == ["support"]
    assert page.evaluate("document.activeElement.value") == "support"
    found = answer(wide, "sort=support&limit=10")["architectures"]
    shown = page.locator(".architecture .pictured strong").all_inner_texts()
    assert shown == [f"{a['detector']} + {a['mask']}" for a in found]


def test_hazards_properties_and_availability_are_asked_of_the_service(wide: Visit) -> None:
    page = wide.go("/?view=table")
    before = wide.architectures()
    for group, value in (("survive", "albedo"), ("properties", "Robust to noise")):
        page.locator(f'details[data-group="{group}"] > summary').click()
        button = page.locator(f'[data-list="{group}"][data-value="{value}"]')
        button.click()
        wide.settle()
        assert button.get_attribute("aria-pressed") == "true"
    page.locator("#min_availability").fill("97")
    page.locator("#min_availability").press("Enter")
    wide.settle()
    asked = {"survive": ["albedo"], "properties": ["Robust to noise"], "min_availability": ["0.97"]}
    assert wide.query() == {**asked, "view": ["table"]}
    question = "&".join(f"{name}={quote(value)}" for name, (value,) in asked.items())
    assert wide.architectures() == answer(wide, question)["count"] < before
    command = page.locator("#answer-links code").inner_text()
    assert "--survive albedo --properties 'Robust to noise'" in command
    page.locator("#question .chip", has_text="albedo").click()
    wide.settle()
    assert "survive" not in wide.query()


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ("detector=Event&mask=Lens", {"detector", "mask"}),
        ("max_error_deg=0.0001", {"error at most"}),
        ("survive=spin&survive=ageing&task=FOV", {"must tolerate", "task"}),
    ],
)
def test_no_match_names_the_constraint_and_a_relaxation_leads_out(
    wide: Visit, asked: str, words: set[str]
) -> None:
    page = wide.go(f"/?{asked}&view=table")
    blocked = answer(wide, asked)["blocked"]
    named = page.locator("#blocked .culprit").inner_text().split(" + ")
    assert len(named) == len(blocked["constraint"].split(" + "))
    assert set(named) <= words
    assert blocked["detail"][1:] in page.locator("#blocked").inner_text()
    buttons = page.locator(".relaxation")
    assert buttons.count() == len(blocked["relaxations"])
    for text, relaxation in zip(buttons.all_inner_texts(), blocked["relaxations"], strict=True):
        assert relaxation["words"][1:] in text
    buttons.last.click()
    wide.settle()
    assert wide.architectures() == blocked["relaxations"][-1]["architectures"] > 0
    assert page.locator("#blocked .culprit").count() == 0
