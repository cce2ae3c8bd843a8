"""Which answers pages of other sites may read (Fetch standard, CORS protocol)."""

import pytest

ORIGIN = {"Origin": "https://notebook.example"}


@pytest.mark.parametrize(
    "url", ["/v1/taxonomy", "/v1/nothing", "/v1/studies?x=1", "/openapi.json", "/healthz"]
)
def test_answers_and_refusals_may_be_read_from_anywhere(atlas, url):
    answer = atlas.get(url, headers=ORIGIN)
    assert answer.headers["access-control-allow-origin"] == "*"
    assert "Link" in answer.headers["access-control-expose-headers"]
    assert answer.headers["cross-origin-resource-policy"] == "cross-origin"
    # Never together with the above: browsers refuse it, and nobody logs in.
    assert "access-control-allow-credentials" not in answer.headers


def test_a_preflight_is_answered_and_a_plain_options_is_not(atlas):
    asks = {**ORIGIN, "Access-Control-Request-Method": "POST"}
    asks["Access-Control-Request-Headers"] = "content-type"
    answer = atlas.request("OPTIONS", "/v1/recommendations", headers=asks)
    assert (answer.status_code, answer.content) == (204, b"")
    assert "POST" in answer.headers["access-control-allow-methods"].split(", ")
    assert "content-type" in answer.headers["access-control-allow-headers"].lower().split(", ")
    assert answer.headers["access-control-allow-origin"] == "*"
    assert atlas.request("OPTIONS", "/v1/recommendations").status_code == 405


def test_the_page_is_not_for_other_sites(atlas):
    for url in ("/", "/page/page.css"):
        answer = atlas.get(url, headers=ORIGIN)
        assert "access-control-allow-origin" not in answer.headers
        assert answer.headers["cross-origin-resource-policy"] == "same-origin"
    asks = {**ORIGIN, "Access-Control-Request-Method": "GET"}
    assert atlas.request("OPTIONS", "/", headers=asks).status_code == 405
