"""The accuracy that studies report against the own error of their runs here, and how they agree."""

from __future__ import annotations

import math
from typing import Any

from api.service.knowledge import Knowledge
from registry.fidelity.evidence import SCORE_FACTOR, own_error, reason_for_score

COLUMNS = ("key", "grade", "reported_deg", "kind", "rms_deg", "own_deg", "times", "reason")
"""Study, grade, figure as printed and of which kind, as RMS, own error here, their ratio, and why
they may be far from each other."""


def compare(known: Knowledge) -> list[dict[str, Any]]:
    """Return a row for every study that reports an accuracy and has a score, the worst first.

    The own error is that which the study is graded by. The worst is furthest from a ratio of one.
    """
    rows = []
    for key, resolution in known.resolutions.items():
        study = known.facts.study(key)
        reported = study.report("accuracy")
        own = own_error(resolution.strongest_pipelines, known.measurements.own_errors)
        if reported is None or own is None:
            continue
        rows.append(
            {
                "key": key,
                "grade": resolution.fidelity.grade,
                "reported_deg": reported.value_deg,
                "kind": reported.label,
                "rms_deg": reported.rms_deg,
                "own_deg": own,
                "times": own / reported.rms_deg,
                "reason": reason_for_score(study, known.facts),
            }
        )
    return sorted(rows, key=lambda row: (-abs(math.log(row["times"])), row["key"]))


def say(rows: list[dict[str, Any]]) -> str:
    """Say how published and measured accuracy agree: rank correlation, and how many are near."""
    if len(rows) < 3:
        return f"{len(rows)} studies report an accuracy and have a score."
    from scipy.stats import spearmanr  # noqa: PLC0415 - half a second

    found = spearmanr([row["rms_deg"] for row in rows], [row["own_deg"] for row in rows])
    near = sum(1.0 / SCORE_FACTOR <= row["times"] <= SCORE_FACTOR for row in rows)
    times = [row["times"] for row in rows]
    return (
        f"{len(rows)} studies report an accuracy and have a score. Spearman's rank correlation of "
        f"reported and own error is {found.statistic:.2f} (p = {found.pvalue:.1g}); {near} are "
        f"within a factor of {SCORE_FACTOR:g}, the ratios range from {min(times):.2g} to "
        f"{max(times):.2g}."
    )
