"""Recommendations as the command line and the HTTP service both give them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

OF_ARCHITECTURE = ("rank", "detector", "mask", "advised", "studies", "pareto")


def rows(document: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield a row a calibration of an answer; what is not measured has empty measured cells."""
    for architecture in document["architectures"]:
        for calibration in architecture["calibrations"]:
            yield {
                **{name: architecture[name] for name in OF_ARCHITECTURE},
                "calibration": calibration["rank"],
                **{name: calibration[name] for name in ("extractor", "compensations", "model")},
                "calibration_studies": calibration["studies"],
                "support": calibration["support"],
                "measured": calibration["measured"] or {},
            }
