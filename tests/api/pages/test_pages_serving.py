"""Pages over HTTP: each with its twins, refusals that a person can read, no empty field refused."""

from __future__ import annotations

import pytest

from tests.api.conftest import Client


def test_a_page_has_its_twins_at_the_same_address_with_the_bytes_of_the_service(
    atlas: Client,
) -> None:
    page = atlas.get("/studies/Chang2008", accept="text/html,*/*;q=0.8")
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert "<h1>Development of high-accuracy image centroiding" in page.text
    for suffix, kind in ((".json", "application/json"), (".csv", "text/csv")):
        assert f'href="/studies/Chang2008{suffix}"' in page.text
        twin = atlas.get(f"/studies/Chang2008{suffix}")
        assert twin.headers["content-type"].startswith(kind)
        assert twin.content == atlas.get("/v1/studies/Chang2008", accept=kind).content


def test_the_address_of_a_page_gives_a_program_what_it_accepts(atlas: Client) -> None:
    for kind in ("application/json", "text/csv"):
        answer = atlas.get("/studies?detector=Event", accept=kind)
        assert (
            answer.content == atlas.get("/v1/studies?detector=Event&limit=500", accept=kind).content
        )


def test_fields_that_nobody_filled_in_ask_for_nothing(atlas: Client) -> None:
    empty = atlas.get("/studies?q=&detector=Event&mask=")
    assert empty.status_code == 200
    assert empty.text == atlas.get("/studies?detector=Event").text


@pytest.mark.parametrize("path", ["/studies/Chang208", "/studies?detector=CMOSS"])
def test_a_refusal_is_a_page_for_a_person_and_a_problem_for_a_program(
    atlas: Client, path: str
) -> None:
    page = atlas.get(path, accept="text/html")
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.headers["cache-control"] == "no-store"
    problem = atlas.get(path, accept="application/json")
    assert problem.headers["content-type"] == "application/problem+json"
    assert page.status_code == problem.status_code >= 400
    (error,) = problem.json()["errors"]
    assert f"did you mean “{error['nearest']}”" in page.text
