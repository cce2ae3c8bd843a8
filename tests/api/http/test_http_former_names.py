"""Names that changed in 0.2: the old ones are answered and taken beside the new until 0.3."""

import pytest

from api.schema.former_names import MEMBERS


def test_an_answer_has_each_number_under_both_names(atlas):
    row = atlas.get("/v1/leaderboard/architectures?limit=1").json()["items"][0]
    both = [(new, old) for new, old in MEMBERS.items() if new in row]
    assert ("own_error_deg", "own_deg") in both
    assert all(row[new] == row[old] for new, old in both)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("/v1/recommendations?survive=albedo", "/v1/recommendations?tolerate=albedo"),
        (
            "/v1/leaderboard/architectures?sort=-runner_up_own_deg",
            "/v1/leaderboard/architectures?sort=-runner_up_own_error_deg",
        ),
        ("/v1/datasets?fields=stands_for_sensors", "/v1/datasets?fields=represents_sensors"),
        (
            "/v1/leaderboard/architectures?fields=finer_own_deg",
            "/v1/leaderboard/architectures?fields=partial_own_error_deg",
        ),
    ],
)
def test_a_question_by_an_old_name_is_that_by_the_new(atlas, old, new):
    first, second = atlas.get(old), atlas.get(new)
    assert first.status_code == second.status_code == 200
    assert first.json() == second.json()
