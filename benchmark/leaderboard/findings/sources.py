"""How near the best pipelines are to the bound, and where the extractor's bias keeps them off."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmark.error_budget.sentences import NEAR, bound_of, contributions
from benchmark.leaderboard.findings.finding import Estimate, Finding, number
from benchmark.leaderboard.findings.record import ARRAYS

#: Share of the squared error from which on a source dominates.
DOMINANT = 0.5


def sources(
    budgets: Mapping[str, Mapping[str, Any]], architectures: Mapping[str, tuple[str, str]]
) -> Finding:
    """Compare the best pipeline of each data set with its bound and with true spot positions."""
    pairs = [_pair(name, row, *architectures[name]) for name, row in sorted(budgets.items())]
    arrays = [p for p in pairs if p["detector"] in ARRAYS and p["extractor_share"] is not None]
    led = [pair for pair in arrays if pair["extractor_share"] > DOMINANT]
    distance = Estimate.median("ratio to the bound", [p["over_bound"] for p in pairs], "data sets")
    near = Estimate.share(
        f"within {NEAR:g} times the bound",
        sum(pair["over_bound"] <= NEAR for pair in pairs),
        len(pairs),
        "data sets",
    )
    biased = Estimate.share(
        "extractor's bias over half of the squared error", len(led), len(arrays), "data sets"
    )
    return Finding(
        "sources",
        "The bias of the extractor, not noise, limits the best pipeline on "
        f"{len(led)} of {len(arrays)} data sets of array detectors: {_masks(led, arrays)}.",
        "There it makes up more than half of the squared error (95 % interval of the share "
        f"{biased.interval}). Over all {distance.n} data sets the best pipeline has "
        f"{number(distance.value)} times the error of its Cramer-Rao bound (median; "
        f"{distance.interval}), and {round(near.value * near.n)} are within {NEAR:g} times "
        f"({near.interval}).",
        (distance, near, biased),
        (f"from the share, {len(pairs) - len(arrays)} data sets without an array detector",),
        tuple(pairs),
    )


def _pair(name: str, row: Mapping[str, Any], detector: str, mask: str) -> dict[str, Any]:
    bias = contributions(dict(row)).get("extractor")
    return {
        "dataset": name,
        "detector": detector,
        "mask": mask,
        "extractor": row["extractor"],
        "model": row["model"],
        "rms_deg": row["rms_deg"],
        "bound_deg": bound_of(row),
        "over_bound": row["rms_deg"] / bound_of(row),
        "extractor_share": None if bias is None else min((bias / row["as_is_deg"]) ** 2, 1.0),
    }


def _masks(led: list[dict[str, Any]], arrays: list[dict[str, Any]]) -> str:
    """Name the masks of the data sets that it limits, each with how many of how many."""

    def count(mask: str, pairs: list[dict[str, Any]]) -> int:
        return sum(pair["mask"] == mask for pair in pairs)

    masks = sorted(
        {pair["mask"] for pair in led}, key=lambda m: (-count(m, led) / count(m, arrays), m)
    )
    return ", ".join(f"{mask} {count(mask, led)} of {count(mask, arrays)}" for mask in masks)
