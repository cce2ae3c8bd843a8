"""No answer is larger than a megabyte where nothing is asked for but what has to be.

Larger is only what is asked for by name: `/v1/leaderboard?whole=true`, `limit` beyond its default.
"""

import pytest

LARGEST = 1_000_000


@pytest.fixture(scope="module")
def operations(atlas):
    """Each GET of the description with an address that its examples give, nothing optional."""
    found = {}
    for path, item in atlas.get("/openapi.json").json()["paths"].items():
        if "get" not in item:
            continue
        asked = {}
        for parameter in item["get"].get("parameters", ()):
            if parameter.get("required"):
                asked[parameter["name"]] = parameter.get("example", "sun")
        address = path.format(**asked)
        query = {name: value for name, value in asked.items() if f"{{{name}}}" not in path}
        found[path] = (item["get"], address, query)
    return found


def test_no_answer_is_large_unasked(atlas, operations):
    assert len(operations) > 30
    for path, (_, address, query) in operations.items():
        answer = atlas.get(address, params=query)
        # two things have to be named to be compared
        assert answer.status_code == (400 if path == "/v1/compare" else 200), path
        assert len(answer.content) <= LARGEST, path
