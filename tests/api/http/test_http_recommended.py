"""Queries of recommendations, which a dependency reads, mean what bodies mean, or are refused."""

import pytest


@pytest.mark.parametrize(
    ("query", "status"),
    [
        ("limit=3&limit=3", 422),
        ("task=Accuracy&task=Cost&task=Accuracy", 200),
        ("task=", 422),
        ("limit=", 422),
        ("max_error_deg=1e-1&sort=measured", 200),
        ("max_error_deg=%2B1", 422),
        ("task=Accuracy&tasks=Cost", 400),
        ("task=%ff", 400),
        ("%74ask=Accuracy", 200),
        ("format=json&format=csv", 422),
    ],
)
def test_a_query_is_read_as_a_body_of_the_same_requirements(atlas, query, status) -> None:
    answer = atlas.get(f"/v1/recommendations?{query}")
    assert answer.status_code == status
    if status == 200:
        body = answer.json()["requirements"]
        sort = answer.json()["sort"]
        posted = atlas.post("/v1/recommendations", json={**body, "sort": sort})
        assert posted.content == answer.content
    else:
        assert answer.json()["errors"]
