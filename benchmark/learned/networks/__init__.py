"""Trained networks, a file each; `python -m benchmark.retraining` makes them again."""

from __future__ import annotations

from pathlib import Path

#: The folder.
NETWORKS = Path(__file__).parent
