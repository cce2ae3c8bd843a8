"""A study that runs on a sensor of its own says so on its page, in the API and on a terminal."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.pages.numbers import degrees
from benchmark import datasets
from benchmark.results.store import PUBLISHED_STUDIES, Store
from tests.api.conftest import Client
from tests.api.pages.test_pages_content import text_of

KEYS = {
    "Lu2017a": "pd-maskless-two-pyramids",
    "Rufino2017": "cmos-single-aperture-naples",
    "Enright2007a": "ccd-multi-slit-ss-411",
    "deBoer2013": "cmos-single-aperture-minidss",
    "Xie2012": "cmos-single-aperture-micro-dss",
}


@pytest.mark.parametrize("key", KEYS)
def test_a_page_shows_the_sensor_with_scores_of_its_own_record(atlas: Client, key: str) -> None:
    document = atlas.get(f"/v1/studies/{key}").json()
    assert document["own_sensor"] == datasets.get(KEYS[key]).description
    html = atlas.get(f"/studies/{key}").text
    page = text_of(html)
    assert "simulated for this study alone" in page
    assert f'href="/datasets/{KEYS[key]}' not in html  # it stands on no board
    scored = Store(PUBLISHED_STUDIES).query(dataset=KEYS[key])
    by = {(row["condition"], row["extractor"], row["model"]): row["rms_deg"] for row in scored}
    ladder = document["ladder"]
    assert ladder["dataset"] == KEYS[key]
    assert degrees(ladder["own"]["own_error_deg"]) in page
    for pipeline in document["pipelines"]:
        for score in pipeline["scores"]:
            place = score["condition"], pipeline["extractor"], pipeline["model"]
            assert score["rms_deg"] == by[place]


@pytest.mark.parametrize(("key", "unknown", "of"), [("Rufino2017", 5, 5), ("deBoer2013", 2, 5)])
def test_unknown_dimensions_are_counted_where_the_grade_is_shown(
    atlas: Client, key: str, unknown: int, of: int
) -> None:
    said = f"{unknown} of {of} dimensions of its sensor are not known"
    assert said in atlas.get(f"/v1/studies/{key}").json()["sentence"]
    assert said in text_of(atlas.get(f"/studies/{key}").text)
    shown = CliRunner().invoke(app, ["studies", key], catch_exceptions=False).stdout
    assert said in " ".join(shown.split())
    assert "Its sensor here: " in shown
