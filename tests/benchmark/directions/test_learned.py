"""The verdict on networks, on rows that were made up."""

from __future__ import annotations

from typing import Any

import pytest

from benchmark.directions.learned import learned


def read(network: float, dataset: str = "cmos-lens", **more: Any) -> dict[str, Any]:
    errors = {
        "classical": [0.010, 0.011, 0.012, 0.010, 0.011],
        "seed 0": [network * error for error in (0.010, 0.011, 0.012, 0.010, 0.011)],
    }
    names = {"dataset": dataset, "network": "heat map", "extractor": "bcm", "model": "lut"}
    return {**names, "bound_deg": 0.005, "errors_deg": errors, "trust": [], **more}


@pytest.mark.parametrize(
    ("ratios", "verdict"),
    [
        ([], "not tried"),
        ([0.5, 0.5, 0.5, 0.9, 2.0], "pays"),
        ([0.5, 0.5, 0.5, 1.02], "pays"),
        ([0.5, 0.5, 2.0, 2.0], "depends on the data set"),
        ([0.5, 2.0, 2.0, 2.0], "does not pay"),
        ([0.5, 1.01, 0.99], "open"),
    ],
)
def test_networks_pay_where_they_win_on_three_quarters_of_what_tells(ratios, verdict) -> None:
    found = learned([read(ratio) for ratio in ratios])
    assert found.verdict == verdict
    assert [one.ratio for one in found.duels] == pytest.approx(ratios)


def test_a_network_that_answers_too_seldom_on_a_unit_loses() -> None:
    row = read(0.5)
    row["errors_deg"]["seed 0"] = [None] * 5
    (one,) = learned([row]).duels
    assert one.outcome == "loss"


def test_the_text_has_seeds_wrong_answers_and_the_sparse_network_beside_its_paper() -> None:
    counts = {"trial": "two Suns", "frames": 200}
    trust = [{**counts, "way": "seed 0", "wrong": 4}, {**counts, "way": "classical", "wrong": 1}]
    row = read(0.5, trust=trust)
    row["errors_deg"]["seed 1"] = [0.02] * 5
    means = {"no network": 0.002, "other units, alone": 0.3, "other units, tuned": 0.01}
    means["unit 1 itself"] = 0.05
    ablation = [
        {"learned": of, "frames": 9, "steps": 7, "mean_deg": mean} for of, mean in means.items()
    ]
    text = learned([row, {**read(2.0), "network": "sscnn", "ablation": ablation}]).text
    assert "2 training seeds give 1.1 to 4 times the bound" in text
    assert "with two 2 % (0.5 %)" in text
    assert "off by 0.3 deg on cmos-lens, by 0.01 deg once calibrated" in text
    assert "by 0.05 deg (9 frames, 7 steps)" in text
