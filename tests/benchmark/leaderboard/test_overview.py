"""How near the bound each part comes: counted from the files of the record, and by hand."""

import pandas as pd
import pytest

from benchmark import datasets
from benchmark.leaderboard.board import build
from benchmark.leaderboard.overview import SAYS, overview
from benchmark.metrics.score import METRICS
from benchmark.results.store import PUBLISHED

LIMITS = {"1_5": 1.5, "3": 3.0, "10": 10.0}


@pytest.fixture(scope="module")
def found(published_board):
    return overview(published_board)


@pytest.fixture(scope="module")
def runs():
    """A row a data set, part and pipeline with its ratio to the bound; NaN where it is silent."""
    rows = []
    for name in datasets.names():
        frame = pd.read_csv(PUBLISHED / "scores" / f"{name}.csv")
        frame = frame[(frame["condition"] == datasets.get(name).conditions[0]) & (frame.unit == 0)]
        ratio = frame["over_bound"].where(frame["availability"] >= 0.95)
        for place, value in zip(zip(frame.extractor, frame.model, strict=True), ratio, strict=True):
            *ahead, model = place[1].split(" + ")
            rows += [(name, "extractor", place[0], value), (name, "model", model, value)]
            rows += [(name, "compensation", part, value) for part in ahead]
    return pd.DataFrame(rows, columns=["dataset", "role", "part", "ratio"])


@pytest.mark.slow
def test_shares_are_those_of_the_best_pipeline_of_a_part_on_each_board(found, runs):
    best = runs.groupby(["role", "part", "dataset"])["ratio"].min()
    nearest = best.groupby("dataset").min()
    assert found["boards"] == len(nearest) == len(datasets.names())
    assert {(p["role"], p["part"]) for p in found["parts"]} == set(
        best.index.droplevel("dataset").unique()
    )
    for part in found["parts"]:
        mine = best[part["role"], part["part"]]
        assert (part["boards"], part["answered"]) == (len(mine), mine.notna().sum())
        for name, limit in LIMITS.items():
            assert part[f"within_{name}"] == (mine <= limit).sum(), part
            assert part[f"share_{name}"] == pytest.approx((mine <= limit).mean())
        assert part["reachable_10"] == (nearest[mine.index] <= 10).sum()
        if mine.notna().any():
            assert part["median_over_bound"] == pytest.approx(mine.median(), rel=1e-4)
        else:
            assert part["median_over_bound"] is None


def test_every_board_has_one_pipeline_in_front(found):
    for role in ("extractor", "model"):
        parts = [part for part in found["parts"] if part["role"] == role]
        assert sum(part["leads"] for part in parts) == found["boards"]


def test_parts_stand_by_role_and_the_nearest_first(found):
    roles = [part["role"] for part in found["parts"]]
    assert list(dict.fromkeys(roles)) == ["extractor", "compensation", "model"]
    assert roles == sorted(roles, key=["extractor", "compensation", "model"].index)
    for role in set(roles):
        shares = [part["share_10"] for part in found["parts"] if part["role"] == role]
        assert shares == sorted(shares, reverse=True)


def row(dataset, extractor, model, ratio, **more):
    return {
        "dataset": dataset, "condition": "nominal", "extractor": extractor, "model": model,
        "extractor_taxonomy": "E", "model_taxonomy": "M", "unit": 0, "dataset_version": 1,
        "detector": "PD", "mask": "M", "half_fov_deg": None, **dict.fromkeys(METRICS),
        "rms_deg": ratio, "charged_deg": more.get("rms_deg", ratio), "over_bound": ratio,
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
