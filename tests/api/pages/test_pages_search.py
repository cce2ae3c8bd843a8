"""The search page: it says what the search of the API finds, of the kinds asked for."""

from __future__ import annotations

from urllib.parse import quote

import pytest

from tests.api.conftest import Client

JSON = "application/json"


def found(atlas: Client, asked: str) -> list[dict]:
    response = atlas.get(f"/search?{asked}", accept=JSON)
    assert response.status_code == 200, response.text
    return response.json()["items"]


@pytest.mark.parametrize("words", ["centroid", "kalman filter", "Xie2012", "albedo"])
def test_the_page_finds_what_the_api_finds_in_its_order(atlas: Client, words: str) -> None:
    page = [(one["kind"], one["id"]) for one in found(atlas, f"q={quote(words)}")]
    api = [(one["kind"], one["id"]) for one in atlas.walk(f"/v1/search?q={quote(words)}")]
    assert page
    assert page == api[: len(page)]


def test_of_a_kind_that_is_asked_for_there_is_nothing_else(atlas: Client) -> None:
    every = found(atlas, "q=slit")
    for kind in {one["kind"] for one in every}:
        narrowed = found(atlas, f"q=slit&kind={kind}")
        assert {one["kind"] for one in narrowed} == {kind}
        assert {one["id"] for one in every if one["kind"] == kind} <= {o["id"] for o in narrowed}
    both = found(atlas, "q=slit&kind=study&kind=dataset")
    assert {one["kind"] for one in both} == {"study", "dataset"}


def test_every_result_has_a_page_that_opens(atlas: Client) -> None:
    for one in found(atlas, "q=multi-aperture"):
        assert atlas.get(one["page"].partition("#")[0], accept="text/html").status_code == 200


def test_without_words_and_with_words_nobody_wrote_there_is_nothing(atlas: Client) -> None:
    assert found(atlas, "") == found(atlas, "q=qqqqzzzzxxxx") == []
