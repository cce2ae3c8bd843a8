"""What the docs say of the leaderboard: the best of each architecture, and an overview of parts."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from api.docs.markdown import table
from benchmark.leaderboard import summaries
from benchmark.leaderboard.architectures import architectures
from benchmark.leaderboard.board import board_of
from benchmark.leaderboard.overview import ROLES, WITHIN, overview, suffix
from benchmark.results.store import Store

PARTS = (
    "A board is a data set under its first condition. A part (extractor, compensation or model) is "
    "judged on each board, on unit 0, by the pipeline with it that is nearest to the bound and "
    "has at least 95 % availability. *Within 1.5* counts the boards on which the RMS of that "
    "pipeline on unit 0 is at most 1.5 times the Cramer-Rao bound, and so on. Parts run on "
    "different boards, and on some boards no pipeline is near the bound."
)


def best_per_architecture_table() -> str:
    """Table of the best pipeline of each architecture, how far from its bound and how sure."""
    rows = architectures(_board())
    return f"{summaries.best_per_architecture_table(rows)}\n\n{summaries.tally(rows)}"


def how_sure() -> str:
    """Say what the columns of that table are."""
    return summaries.ARCHITECTURES


def parts() -> str:
    """Tables of how near the bound each part of a pipeline comes, and how that is counted."""
    document = overview(_board())
    said = [PARTS]
    for role in ROLES:
        rows = [
            (
                f"`{part['part']}`",
                str(part["boards"]),
                *(str(part[f"within_{suffix(limit)}"]) for limit in WITHIN),
                summaries.digits(part["median_over_bound"]),
            )
            for part in document["parts"]
            if part["role"] == role
        ]
        within = (f"within {limit:g}" for limit in WITHIN)
        said += [f"### By {role}", table((role, "boards", *within, "median × bound"), rows)]
    return "\n\n".join(said)


@cache
def _board() -> Mapping[str, Any]:
    return board_of(Store())
