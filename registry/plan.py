"""What can be scored, as the registry is told it: `benchmark.plan` answers, the caller hands in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

Architecture = tuple[str, str]
"""Detector and mask, as values of the taxonomy."""

Pair = tuple[str, str]
"""Extractor and model, or chain, by their names."""

Plan = Mapping[Architecture, Mapping[Pair, Sequence[str]]]
"""Of each architecture that is simulated, its pipelines, and the data sets each is scored on."""
