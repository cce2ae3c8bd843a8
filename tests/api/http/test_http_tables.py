"""Tables over HTTP: fixed columns, `format`, `sort` and `fields`, against the JSON of the same."""

import csv
import io
import math

import pytest

from api.schema.former_names import MEMBERS

#: Questions to one table, some of which nothing answers.
ASKED = (
    ("/v1/studies", "/v1/studies?year_min=2020&detector=PD", "/v1/studies?edition=all"),
    ("/v1/flows/error", "/v1/flows/error?error=Electrical&counting=fractional"),
    ("/v1/figures/matrix", "/v1/figures/matrix?rows=mask&columns=mask&detector=OI"),
    *(
        (f"/v1/figures/{name}", f"/v1/figures/{name}?detector=OI")
        for name in ("error", "models", "publications", "coordinates")
    ),
    (
        *("/v1/recommendations", "/v1/recommendations?tolerate=albedo&max_error_deg=1"),
        *(
            "/v1/recommendations?max_error_deg=0.000001",
            "/v1/recommendations/designs?task=Accuracy",
        ),
    ),
    ("/v1/datasets", "/v1/datasets?limit=1"),
    (
        *("/v1/leaderboard", "/v1/leaderboard/qpd-single-aperture"),
        *(f"/v1/leaderboard/qpd-single-aperture?{q}" for q in ("field_deg=30", "max_error_deg=1")),
    ),
    ("/v1/claims", "/v1/claims?q=zzz"),
    ("/v1/figures/gap", "/v1/figures/gap?detector=OI&mask=Lens"),
    ("/v1/figures/trade-off", "/v1/figures/trade-off?across=mass&detector=OI"),
    ("/v1/figures/robustness", "/v1/figures/robustness?compare=mirror&compare=bctm"),
    ("/v1/search?q=centroid", "/v1/search?q=zzzzzzzz"),
)
LISTS = {
    # nested, and so columns of their own or left to JSON
    "/v1/studies": {"values", "runs", "headline", "sentence"},
    "/v1/datasets": {"splits", "represents", "setups"},
    "/v1/algorithms": set(),
    "/v1/leaderboard/architectures": set(),
    "/v1/leaderboard/qpd-single-aperture": set(),
    "/v1/results": set(),
    "/v1/sweeps": set(),
    "/v1/advice": set(),
    "/v1/search?q=centroid": set(),
}


def asked(url, **more):
    return url + ("&" if "?" in url else "?") + "&".join(f"{k}={v}" for k, v in more.items())


def columns(atlas, url):
    text = atlas.get(asked(url, format="csv")).text
    assert atlas.get(url, "text/csv").text == text
    return text.split("\n")[0].split(",")


@pytest.mark.parametrize("urls", ASKED, ids=lambda urls: urls[0])
def test_a_table_has_its_columns_whatever_is_asked(atlas, urls):
    first, *others = (columns(atlas, url) for url in urls)
    assert len(first) > 3
    assert others == [first] * len(others)


@pytest.mark.parametrize("url", LISTS)
def test_no_member_of_an_item_is_lost_in_its_table(atlas, url):
    members = set(atlas.get(asked(url, limit=5)).json()["items"][0])
    assert members - {*columns(atlas, asked(url, limit=5))} - {*MEMBERS.values()} <= LISTS[url]


def test_format_and_accept_agree_or_are_refused(atlas):
    url = "/v1/taxonomy"
    assert atlas.get(f"{url}?format=csv").headers["content-type"].startswith("text/csv")
    assert atlas.get(f"{url}?format=json", "text/csv, */*;q=0.1").json()["attributes"]
    browser = "text/html,application/xhtml+xml,*/*;q=0.8"
    assert atlas.get(f"{url}?format=csv", browser).text.startswith("attribute,")
    assert atlas.get(f"{url}?%66ormat=csv").text.startswith("attribute,")
    for query, accept, status in [
        ("format=csv", "application/json", 406),
        ("format=json", "text/csv", 406),
        ("format=json", "application/json;q=0, */*", 406),
        ("format=xml", None, 422),
        ("format=csv&format=json", None, 422),
        ("format=", None, 422),
        ("Format=csv", None, 400),
    ]:
        answer = atlas.get(f"{url}?{query}", accept)
        assert answer.status_code == status, query
        assert "ormat" in answer.json()["detail"]
    assert atlas.get("/healthz?format=csv").status_code == 400


def test_the_next_page_keeps_format_sort_and_fields(atlas):
    url = "/v1/studies?format=csv&sort=-year&fields=key&fields=year&limit=100"
    rows, following = [], url
    while following:
        answer = atlas.get(following)
        rows += list(csv.DictReader(io.StringIO(answer.text)))
        following = answer.links.get("next", {}).get("url")
    every = atlas.get("/v1/studies?limit=500").json()["items"]
    assert {row["key"] for row in rows} == {study["key"] for study in every}
    years = [int(row["year"] or -1) for row in rows]
    assert years == sorted(years, reverse=True)


@pytest.mark.parametrize(
    ("url", "column"),
    [
        ("/v1/leaderboard/qpd-single-aperture", "max_deg"),
        ("/v1/studies", "year"),
        ("/v1/claims", "statement"),
    ],
)
def test_sorted_rows_are_those_of_the_list_in_order(atlas, url, column):
    plain = atlas.get(f"{url}?limit=500").json()["items"]
    up = atlas.get(f"{url}?limit=500&sort={column}").json()["items"]
    down = atlas.get(f"{url}?limit=500&sort=-{column}").json()["items"]
    there = [row for row in plain if row[column] not in (None, "")]
    missing = [row for row in plain if row[column] in (None, "")]

    def key(row):
        value = row[column]
        return value.casefold() if isinstance(value, str) else value

    assert up == sorted(there, key=key) + missing
    assert down == sorted(there, key=key, reverse=True) + missing


def test_fields_narrow_json_and_csv_alike(atlas):
    wanted = ["rms_deg", "extractor", "studies"]
    base = "/v1/leaderboard/qpd-single-aperture?limit=50"
    query = base + "".join(f"&fields={name}" for name in wanted)
    items = atlas.get(query).json()["items"]
    whole = atlas.get(base).json()["items"]
    assert items == [
        {name: row[name] for name in ("extractor", "rms_deg", "studies")} for row in whole
    ]
    rows = atlas.table(query)
    assert list(rows[0]) == ["extractor", "rms_deg", "studies"]
    for row, item in zip(rows, items, strict=True):
        assert row["extractor"] == item["extractor"]
        assert row["studies"] == "; ".join(item["studies"])
        number = float(row["rms_deg"]) if row["rms_deg"] else None
        assert number == item["rms_deg"] or math.isnan(item["rms_deg"])


def test_words_that_are_no_columns_are_refused_with_the_nearest(atlas):
    for name, word, near in [("sort", "rms_degs", "rms_deg"), ("fields", "extracter", "extractor")]:
        answer = atlas.get(f"/v1/results?{name}={word}")
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["nearest"] == near
    assert atlas.get("/v1/studies?sort=detector").status_code == 422  # a list a row
    assert atlas.get("/v1/studies?sort=year&sort=key").status_code == 422
