"""What pages say, against what the service says."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from html import unescape
from typing import Any

import pytest

from api.pages import dataset, sensors
from api.pages.numbers import count_text, degrees, number, percent, times
from api.pages.terms import display_text, explain_terms, glossary
from api.server.app import create_app
from benchmark.leaderboard.architectures import architectures
from registry.studies import facts
from tests.api.conftest import Client
from tests.api.pages.addresses import KINDS

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
    errors = [s["own_deg"] for p in document["pipelines"] for s in p["scores"]]
    assert len(errors) > 4
    assert all(degrees(error) in page for error in errors if error is not None)


def test_a_board_is_that_of_the_service_in_its_order(atlas: Client) -> None:
    rows = atlas.walk("/v1/leaderboard/ccd-lens?condition=hot&limit=500")
    html = atlas.get("/datasets/ccd-lens?condition=hot&rows=all").text
    board = html[html.index('id="board"') : html.index('id="heat"')]
    names = re.findall(r'<td class="first">.*?>([^<]+)</a> \+ .*?>([^<]+)</a>', board)
    assert names == [(row["extractor"], row["model"]) for row in rows]


def test_the_leaderboard_is_that_of_the_service_in_the_order_asked_for(atlas: Client) -> None:
    rows = atlas.walk("/v1/leaderboard/architectures?limit=500")
    by_name = [f"{row['detector']} + {row['mask']}" for row in rows]
    orders = {
        "": sorted(rows, key=lambda row: row["own_deg"]),
        "?order=error": sorted(rows, key=lambda row: row["own_deg"]),
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
        assert f"{degrees(row['own_deg'])}{' =' if row['tie'] else ''}" in page
    table = atlas.table("/leaderboard.csv?order=name")
    assert table == atlas.table("/v1/leaderboard/architectures?limit=500")


def test_the_leaderboard_counts_parts_as_the_service_does(atlas: Client) -> None:
    document = atlas.get("/v1/leaderboard/overview").json()
    html = atlas.get("/leaderboard", accept="text/html").text
    for role in ("extractor", "compensation", "model"):
        section = html[html.index(f'id="{role}s"') :]
        section = section[: section.index("</section>")]
        parts = [part for part in document["parts"] if part["role"] == role]
        names = re.findall(r'<td class="first"><a href="[^"]+">([^<]+)<', section)
        assert names == [part["part"] for part in parts]
        assert f"{100 * parts[0]['share_10']:.0f} %" in section
    refused = atlas.get("/leaderboard?order=taste", accept="application/json")
    assert refused.status_code == 422


def test_a_condition_of_another_data_set_is_refused_with_the_nearest(atlas: Client) -> None:
    refused = atlas.get("/datasets/ccd-lens?condition=ghosts", accept="application/json")
    assert refused.status_code == 422
    assert "nominal" in refused.json()["errors"][0]["expected"]


def test_the_answer_reads_without_a_script(atlas: Client) -> None:
    asked = "task=Accuracy&survive=albedo"
    document = atlas.get(f"/v1/recommendations?{asked}&limit=500").json()
    page = text_of(atlas.get(f"/?{asked}").text)
    assert count_text(document["count"], "architecture") in page
    assert count_text(document["designs"], "calibration") in page
    for architecture in document["architectures"][:10]:
        assert f"{architecture['detector']} + {architecture['mask']}" in page
        measured = architecture["best"]["measured"]
        assert degrees(measured["error_deg"]) in page
    assert "task Accuracy, must tolerate albedo." in page


def test_what_leaves_nothing_and_what_would_help_are_said(atlas: Client) -> None:
    document = atlas.get("/v1/recommendations?detector=Event&mask=Lens").json()["blocked"]
    page = text_of(atlas.get("/?detector=Event&mask=Lens").text)
    assert document["constraint"] in page
    assert all(relaxation["words"][1:] in page for relaxation in document["relaxations"])


def test_how_the_answer_is_shown_is_no_requirement(atlas: Client) -> None:
    plain = text_of(atlas.get("/?task=Cost").text)
    assert text_of(atlas.get("/?task=Cost&chart=error&view=table&board_sort=model").text) == plain


def test_the_scatter_has_a_point_for_every_measured_architecture(atlas: Client) -> None:
    document = atlas.get("/v1/recommendations?limit=500").json()["architectures"]
    page = atlas.get("/scatter").text
    drawn = re.findall(r'<circle class="dot (\w+)"', page)
    every = [a["best"]["measured"] for a in document]
    seen = [m for m in every if m["field_deg"] or m["fov_deg"]]
    assert 20 < len(drawn) == len(seen) == len(every)
    # The front: none errs less over a field as wide.
    places = {(m["field_deg"] or m["fov_deg"], m["error_deg"]) for m in seen}
    front = [
        (field, error)
        for field, error in places
        if not any(f >= field and e <= error and (f, e) != (field, error) for f, e in places)
    ]
    assert drawn.count("pareto") == len(front)


def test_comparison_needs_two_and_takes_four(atlas: Client) -> None:
    assert 'class="side"' not in atlas.get("/compare?architecture=CMOS:Encoded").text
    five = "&".join(
        f"architecture=CMOS:{m}" for m in ("Encoded", "Slit", "Lens", "L-Slit", "N-Slit")
    )
    assert atlas.get(f"/compare?{five}").status_code == 422
    document = atlas.get("/compare.json?architecture=CMOS:Encoded&architecture=PD:Maskless").json()
    assert [item["detector"] for item in document["items"]] == ["CMOS", "PD"]


def test_comparison_names_what_is_far_finer_under_a_condition(atlas: Client) -> None:
    asked = "architecture=CMOS:Multi-Ap.&architecture=CMOS:Single-Ap."
    items = atlas.get(f"/v1/compare?{asked}").json()["items"]
    page = text_of(atlas.get(f"/compare?{asked}", accept="text/html").text)
    document = [t for item in items for t in item["conditions"].values()]
    finer = [t["finer"] for t in document if t["finer"]]
    for f in finer:
        by = f"({f['extractor']} + {f['model']})"
        if f["availability"] < 0.95:
            by = f"at {percent(f['availability'])} {by}"
        assert f"{degrees(f['charged_deg'])} {by}" in page
    seldom = [t for t in document if t["availability"] < 0.95]
    assert all(f"availability {percent(t['availability'])}" in page for t in seldom)


def finer_built(board: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The best of each architecture, some with a far finer one beside, as once there were."""
    finer = {"dataset": "ccd-lens", "extractor": "bcm", "model": "lut", "own_deg": 0.000123}
    finer["availability"] = 0.789
    return [
        {**row, **{f"finer_{name}": value for name, value in finer.items()}}
        if row["dataset"] == "ccd-lens"
        else row
        for row in architectures(board)
    ]


def test_data_sets_that_nothing_is_measured_on_yet_are_listed(
    atlas: Client, client_of: Callable[..., Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dataset.boards, "first_rows", lambda *_: [])
    fresh = client_of(create_app(atlas.app.state.knowledge))
    assert "pd-orbit" in fresh.get("/datasets", accept="text/html").text


@pytest.mark.parametrize("address", ["/datasets", "/leaderboard", "/detectors/CCD"])
def test_what_is_far_finer_on_a_part_stands_beside_the_best(
    atlas: Client, client_of: Callable[..., Client], monkeypatch: pytest.MonkeyPatch, address: str
) -> None:
    monkeypatch.setattr(dataset, "best_of_each", finer_built)
    monkeypatch.setattr(sensors, "architectures", finer_built)
    fresh = client_of(create_app(atlas.app.state.knowledge))
    html = fresh.get(address, accept="text/html").text
    text = text_of(html)
    assert text.count("0.000123°") == 1
    assert re.search(r"0\.000123° \S+ 78\.9 % \(bcm \+ lut\)", text)
    assert "/glossary#term-finer" in html


def test_a_card_of_the_answer_names_what_is_far_finer_with_its_share(atlas: Client) -> None:
    """Asked to survive ageing, one architecture errs by degrees but for most of its samples."""
    document = atlas.get("/v1/recommendations?survive=ageing&limit=500").json()["architectures"]
    seldom = [a for a in document if a["best"]["measured"] and a["best"]["measured"]["finer"]]
    for a in seldom:
        asked = f"/?survive=ageing&detector={a['detector']}&mask={a['mask']}"
        html = atlas.get(asked, accept="text/html").text
        card = text_of(html[html.index('class="best-one"') :].partition("</a>")[0])
        measured, finer = a["best"]["measured"], a["best"]["measured"]["finer"]
        assert f"RMS error {degrees(measured['error_deg'])} over " in card
        assert f"{degrees(finer['error_deg'])} at {percent(finer['availability'])}" in card


def test_search_leads_to_the_page_of_what_it_finds(atlas: Client) -> None:
    for word, page in (
        ("Chang2008", "/studies/Chang2008"),
        ("cmos-lens", "/datasets/cmos-lens"),
        ("mt-acm", "/algorithms/mt-acm"),
    ):
        found = atlas.get(f"/search.json?q={word}").json()["items"]
        assert page in [item["page"] for item in found[:3]]


@pytest.mark.parametrize("kind", KINDS)
def test_none_never_stands_bare(atlas: Client, kind: str) -> None:
    page = atlas.get(KINDS[kind], accept="text/html").text
    assert not re.search(r">\s*None\s*<", page)


def test_every_abbreviation_of_the_taxonomy_is_told_in_the_glossary() -> None:
    taxonomy = facts().taxonomy.to_dict()
    short = {e["value"] for entries in taxonomy.values() for e in entries if e["value"].isupper()}
    assert len(short) > 20
    assert short <= set(glossary())


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


@pytest.mark.parametrize(
    "path",
    ["/algorithms/escm", "/datasets/cmos-encoded", "/datasets/qpd-maskless-pyramid"],
)
def test_no_page_shows_the_backquotes_of_its_sources(atlas: Client, path: str) -> None:
    page = atlas.get(path, accept="text/html").text
    assert "<code>" in page
    assert "`" not in re.sub(r"<(script|style|pre)\b.*?</\1>", "", page, flags=re.DOTALL)


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
