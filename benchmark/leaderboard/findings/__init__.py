"""Five findings of the published record, each paired, with intervals and what is left out."""

from __future__ import annotations

from collections.abc import Mapping

from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.leaderboard.findings.finding import Estimate, Finding
from benchmark.leaderboard.findings.measured import benches, constants, methods, poses, sources
from benchmark.leaderboard.findings.record import FindingsRecord
from benchmark.learning_curves.record import published_curves
from registry.resolution import Resolution

__all__ = ["KEYS", "Estimate", "Finding", "FindingsRecord", "findings_of"]

KEYS = ("methods", "constants", "benches", "sources", "poses")


def findings_of(
    record: FindingsRecord, resolutions: Mapping[str, Resolution]
) -> tuple[Finding, ...]:
    """Return the five findings, in the order of `KEYS`."""
    architectures = {
        cell.dataset: (row["detector"], row["mask"]) for cell, row in record.rows.items()
    }
    return (
        methods(record, resolutions),
        constants(record),
        benches(record),
        sources(ERROR_BUDGET.read(), architectures),
        poses(published_curves()),
    )
