"""What pages say, against what the service says."""

from __future__ import annotations

import itertools
import re
from html import unescape

import pytest

from api.pages.numbers import degrees, number, percent, plural, times
from api.pages.terms import display_text, explain_terms
from api.service.knowledge import Knowledge
from tests.api.conftest import Client

TAGS = re.compile(r"<(script|style|template|noscript)\b.*?</\1>|<[^>]+>", re.DOTALL)


def text_of(html: str) -> str:
    """What is read: no tags, no line breaks."""
    return " ".join(unescape(TAGS.sub(" ", html)).split())


def test_a_study_shows_every_value_with_its_basis_and_every_score(atlas: Client) -> None:
    document = atlas.get("/v1/studies/Chang2008").json()
    page = text_of(atlas.get("/studies/Chang2008").text)
    for cell in document["attributes"]:
        assert cell["value"] in page
        assert cell["note"] in page
    errors = [s["own_error_deg"] for p in document["pipelines"] for s in p["scores"]]
    assert len(errors) > 4
    assert all(degrees(error) in page for error in errors if error is not None)


def test_the_leaderboard_is_that_of_the_service_in_the_order_asked_for(atlas: Client) -> None:
    rows = atlas.walk("/v1/leaderboard/architectures?limit=500")
    by_name = [f"{row['detector']} + {row['mask']}" for row in rows]
    orders = {
        "": sorted(rows, key=lambda row: row["own_error_deg"]),
        "?order=error": sorted(rows, key=lambda row: row["own_error_deg"]),
        "?order=bound": sorted(rows, key=lambda row: row["over_bound"]),
        "?order=name": rows,
    }
    for asked, expected in orders.items():
        html = atlas.get(f"/leaderboard{asked}", accept="text/html").text
        shown = re.findall(r'<td class="first"><a href="/architectures/[^"]+">([^<]+)<', html)
        assert shown == [f"{row['detector']} + {row['mask']}" for row in expected]
        assert shown != by_name or asked == "?order=name"
        assert atlas.get(f"/leaderboard.json{asked}").json()["items"] == expected
    page = text_of(html)
    for row in rows:
        assert row["dataset"] in page
        assert f"{degrees(row['own_error_deg'])}{' =' if row['tie'] else ''}" in page
    table = atlas.table("/leaderboard.csv?order=name")
    assert table == atlas.table("/v1/leaderboard/architectures?limit=500")


def test_the_answer_reads_without_a_script(atlas: Client) -> None:
    asked = "task=Accuracy&tolerate=albedo"
    document = atlas.get(f"/v1/recommendations?{asked}&include=calibrations").json()
    html = atlas.get(f"/?{asked}").text
    page = text_of(html)
    assert plural(document["count"], "architecture") in page
    assert plural(document["designs"], "calibration") in page
    assert document["order"] in page
    for architecture in document["architectures"]:
        assert f"{architecture['detector']} + {architecture['mask']}" in page
        assert str(explain_terms(architecture["reason"])) in html
        for calibration in architecture["calibrations"]:
            if calibration["measured"] and calibration["measured"]["own_error_deg"] is not None:
                assert degrees(calibration["measured"]["own_error_deg"]) in page
    assert "Asked: task Accuracy, tolerates albedo." in page
    assert "sunatlas recommend --task Accuracy --tolerate albedo" in page


@pytest.mark.parametrize(
    ("level", "member", "words"),
    [("flight", "flight_error_deg", "error in flight"), ("own", "own_error_deg", "own error")],
)
def test_the_scatter_has_a_point_for_every_judged_error_and_no_other(
    atlas: Client, level: str, member: str, words: str
) -> None:
    """With a bench, too: errors without one are drawn."""
    for asked in (f"level={level}", f"level={level}&max_error_deg=0.5&bench_deg=0.05"):
        document = atlas.get(f"/v1/recommendations?{asked}&limit=500").json()["architectures"]
        traces = atlas.get(f"/answer.architectures.plotly.json?{asked}").json()["data"]
        drawn = {trace["name"]: trace["y"] for trace in traces if "text" in trace}
        every = [a["best"]["measured"] for a in document if a["best"] and a["best"]["measured"]]
        places = {(m["field_deg"], m[member]) for m in every if m[member]}
        assert sum(map(len, drawn.values())) == sum(bool(m[member]) for m in every) > 5
        # The front: none errs less over a field as wide.
        front = [
            (field, error)
            for field, error in places
            if not any(f >= field and e <= error and (f, e) != (field, error) for f, e in places)
        ]
        assert sorted(drawn["Pareto front"]) == sorted(error for _, error in front)
        shown = sorted(itertools.chain(*drawn.values()))
        assert shown == sorted(m[member] for m in every if m[member])
        said = [mark["text"] for trace in traces for mark in trace.get("customdata", ())]
        assert all(f": {words} " in text for text in said)


@pytest.mark.parametrize("name", ["cmos-slit", "qpd-single-aperture"])
def test_a_data_set_shows_facts_of_its_own_board(
    atlas: Client, knowledge: Knowledge, name: str
) -> None:
    boards = {board["name"]: board for board in knowledge.measurements.leaderboard["datasets"]}
    board = boards[name]
    page = text_of(atlas.get(f"/datasets/{name}").text)
    assert f"adds an error of {degrees(board['bench_deg'])}" in page
    assert f"through its calibration it is {degrees(board['bound_unit_deg'])}" in page


def test_a_data_set_says_which_future_directions_were_tried_on_it(atlas: Client) -> None:
    tried = atlas.get("/v1/directions").json()["items"]
    told = {
        (one["dataset"], direction["id"]): (one["first"], times(one["ratio"]), one["second"])
        for direction in tried
        for one in direction["duels"]
        if one["outcome"] != "tie"
    }
    assert ("ccd-lens", "D09") in told
    html = atlas.get("/datasets/ccd-lens").text
    shown = re.findall(r'<a href="/directions#(\w+)">', html)
    assert shown == [identity for dataset, identity in told if dataset == "ccd-lens"]
    first, ratio, second = told["ccd-lens", "D09"]
    assert f"{first} has {ratio} the error of {second}." in text_of(html)
    dusty = atlas.get("/datasets/ccd-lens?condition=noise").text
    assert "/directions#" not in dusty


def test_comparison_needs_two_and_takes_four(atlas: Client) -> None:
    assert 'class="side"' not in atlas.get("/compare?architecture=CMOS:Encoded").text
    five = "&".join(
        f"architecture=CMOS:{m}" for m in ("Encoded", "Slit", "Lens", "L-Slit", "N-Slit")
    )
    assert atlas.get(f"/compare?{five}").status_code == 422
    document = atlas.get("/compare.json?architecture=CMOS:Encoded&architecture=PD:Maskless").json()
    assert [item["detector"] for item in document["items"]] == ["CMOS", "PD"]


def test_an_abbreviation_is_explained_at_its_first_place_and_no_part_of_a_name_is() -> None:
    text = str(explain_terms("RMS of RMS, not RMS-like nor <CCD>"))
    assert text.count('class="term"') == 2
    assert 'title="root mean square">RMS</a> of RMS' in text
    assert "&lt;<a" in text
    assert display_text("None", "mask") == "no mask"


def test_what_stands_between_backquotes_is_code_and_nothing_else_of_a_text_changes() -> None:
    assert explain_terms("RMS of `RMS_deg`: ``a < b``, a `") == (
        f"{explain_terms('RMS')} of <code>RMS_deg</code>: <code>a &lt; b</code>, a `"
    )


def test_numbers_have_three_digits_no_exponent_and_a_dash_for_none() -> None:
    assert [number(x) for x in (0.0123456, 123.4, 2e-7, 0.0, None)] == [
        "0.0123",
        "123",
        "0.00000020",
        "0",
        "–",
    ]
    assert (degrees(0.5), times(None), percent(0.99999), percent(1.0)) == (
        "0.500°",
        "–",
        "99.9 %",
        "100 %",
    )
