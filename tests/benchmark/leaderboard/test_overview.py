"""How near the bound each part comes: counted from the files of the record, and by hand."""

import pytest

from benchmark.leaderboard.board import build
from benchmark.leaderboard.overview import SAYS, overview
from benchmark.metrics.score import METRICS


@pytest.fixture(scope="module")
def found(published_board):
    return overview(published_board)


def row(dataset, extractor, model, ratio, **more):
    return {
        "dataset": dataset, "condition": "nominal", "extractor": extractor, "model": model,
        "extractor_taxonomy": "E", "model_taxonomy": "M", "unit": 0, "dataset_version": 1,
        "detector": "PD", "mask": "M", "half_fov_deg": None, **dict.fromkeys(METRICS),
        "rms_deg": ratio, "rms_all_answers_deg": more.get("rms_deg", ratio), "over_bound": ratio,
        "availability": 1.0, **more,
    }  # fmt: skip


def test_a_part_is_judged_by_its_best_partner_and_silence_counts_as_far():
    board = build(
        [
            row("one", "e", "bad", 50.0),
            row("one", "e", "glass + good", 1.5),
            row("two", "e", "bad", 4.0),
            row("two", "e", "good", 1.0, availability=0.9),
            row("three", "e", "good", None),
            row("three", "f", "bad", 2.0),
            row("boundless", "e", "good", None, rms_deg=1.0),
        ]
    )
    found = overview(board)
    assert (found["boards"], found["says"]) == (3, SAYS)
    parts = {(part["role"], part["part"]): part for part in found["parts"]}

    def counts(role, part):
        names = ("boards", "answered", "within_1_5", "within_3", "within_10", "leads")
        return tuple(parts[role, part][name] for name in names)

    assert counts("extractor", "e") == (3, 2, 1, 1, 2, 2)
    assert counts("extractor", "f") == (1, 1, 0, 1, 1, 1)
    assert counts("model", "good") == (3, 1, 1, 1, 1, 1)
    assert counts("model", "bad") == (3, 3, 0, 1, 2, 2)
    assert counts("compensation", "glass") == (1, 1, 1, 1, 1, 1)
    assert parts["model", "bad"]["median_over_bound"] == 4.0
    assert parts["model", "bad"]["share_10"] == pytest.approx(2 / 3)
