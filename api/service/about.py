"""What is known, in numbers and versions."""

from __future__ import annotations

from typing import Any

from api.service.knowledge import Knowledge


def health(known: Knowledge, version: str) -> dict[str, Any]:
    """Return the status of a service of a version, with versions of facts and record."""
    return {
        "status": "ok",
        "version": version,
        "studies": len(known.facts.studies),
        "datasets": len(known.measurements.presets),
        "scores": len(known.measurements.scores),
        "facts_sha256": known.facts_digest,
        "record_sha256": known.measurements.digest,
    }
