"""The leaderboard of the page in a browser against the real service."""

from __future__ import annotations

import pytest

from tests.api.browser.visiting import WIDE, Visit, get_json

pytestmark = pytest.mark.slow


def test_ranks_that_units_do_not_tell_apart_are_shown_as_ties(wide: Visit) -> None:
    page = wide.go("/?dataset=ccd-orbit")
    board = wide.page.request.get(f"{wide.address}/v1/leaderboard/ccd-orbit?condition=nominal")
    rows = board.json()["items"]
    tied = [row for row in rows if row["tied"]]
    assert tied  # or there is nothing to see
    texts = page.locator(".score").all_inner_texts()
    for row, text in zip(rows, texts, strict=False):
        mark = "=" if row["tied"] else ""
        assert text.split()[0] == f"{row['rank']}{mark}"
        assert ("–" in text) == (row["low_deg"] is not None)
        assert ("false detections" in text) == bool(row["false_sun"])
    assert page.locator(".key-units").count() == 1
    page.select_option("#board-condition", "stable")
    wide.settle()
    assert page.locator(".key-units").count() == 0
    assert "one sensor unit" in page.locator("#board-body .legend").inner_text()


def test_the_leaderboard_is_judged_over_a_part_of_the_field(wide: Visit) -> None:
    page = wide.go("/?dataset=cmos-single-aperture")
    page.select_option("#board-field", "20")
    wide.settle()
    assert wide.query()["board_field"] == ["20"]
    assert page.get_by_role("columnheader", name="RMS within 20°").count() == 1
    asked = "/v1/leaderboard/cmos-single-aperture?condition=nominal&field_deg=20"
    first = wide.page.request.get(f"{wide.address}{asked}").json()["items"][0]
    best = page.locator(".score").first.inner_text().split()
    assert best[:3] == ["1", first["extractor"], first["model"]]
    assert float(best[3].rstrip("°")) == pytest.approx(first["field_rms_deg"], rel=0.01)
    page.select_option("#board-field", "90")  # wider than the sensor's own
    wide.settle()
    assert "ends at 60" in page.locator("#board-body .legend").inner_text()
    assert page.locator(".score").first.inner_text().split()[0] == "–"


def test_the_best_of_each_extractor_stands_first_and_what_studies_used_is_marked(
    wide: Visit,
) -> None:
    page = wide.go("/?dataset=qpd-single-aperture")
    asked = "/v1/leaderboard/qpd-single-aperture?condition=nominal"
    rows = get_json(f"{wide.address}{asked}")["items"]
    assert sum(bool(row["studies"]) for row in rows) > 1
    texts = page.locator(".score").all_inner_texts()
    for row, text in zip(rows, texts, strict=False):
        assert text.split()[1:3] == [row["extractor"], row["model"]]
        count = len(row["studies"])
        assert (f"{count} stud{'y' if count == 1 else 'ies'}" in text) == bool(count)
    legend = page.locator("#board-body .legend")
    assert "best pipeline of each extractor first" in legend.inner_text()
    page.locator('[data-sort="over_bound"]').click()
    wide.settle()
    assert "best pipeline of each extractor first" not in legend.inner_text()


def test_the_leaderboard_shows_every_row_the_service_has(wide: Visit) -> None:
    page = wide.go("/?view=table")
    for card in get_json(f"{wide.address}/v1/datasets?limit=500")["items"]:
        name = card["name"]
        page.locator("#dataset").select_option(name)
        page.wait_for_function(
            "name => !document.querySelector('#leaderboard [aria-busy]')"
            " && document.querySelector('#dataset').value === name",
            arg=name,
        )
        condition = page.locator("#board-condition").input_value()
        rows = get_json(f"{wide.address}/v1/leaderboard/{name}?condition={condition}&limit=500")
        more = page.locator("#leaderboard .more")
        if more.count():
            more.click()
        assert page.locator(".score").count() == rows["total"]
        assert page.evaluate("document.documentElement.scrollWidth") <= WIDE[0]
        if not rows["total"]:
            assert "No pipeline is scored" in page.locator("#board-body").inner_text()


@pytest.mark.parametrize("name", ["cmos-compound-eye", "qpd-single-aperture"])
def test_the_card_of_a_data_set_opens_with_its_picture(wide: Visit, name: str) -> None:
    page = wide.go("/?view=table")
    page.locator("#dataset").select_option(name)
    summary = page.get_by_text(f"Description of {name}: a picture")
    summary.click()
    picture = page.locator("#board-card img.preview")
    picture.wait_for()
    page.wait_for_function("() => document.querySelector('img.preview').naturalWidth > 0")
    card = get_json(f"{wide.address}/v1/datasets/{name}")
    assert picture.get_attribute("src") == card["preview"]
    facts = page.locator(".card-facts").inner_text()
    assert f"{card['geometry']['half_fov_deg']:g}" in facts
    assert len(facts) < 20_000, "hundreds of apertures belong in the JSON"
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDE[0]
    assert wide.complaints == []
