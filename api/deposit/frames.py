"""Samples of every standard data set in the bundle: what a method is given, and the truth.

Of each data set the nominal condition, every split whole: what a published score follows from
(`api.deposit.rescoring`). Each is an export as `sunatlas dataset export` makes it: a card, arrays,
flat and dark readings, a picture, checksums.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmark import datasets
from benchmark.contract import SPLITS
from benchmark.datasets.export import export, read_card
from benchmark.datasets.pins import Pin, Place
from benchmark.progress import ProgressCallback, silent

FOLDER = "frames"


def write_frames(
    bundle: Path,
    names: Sequence[str],
    pins: Mapping[Place, Pin],
    progress: ProgressCallback = silent,
) -> list[dict[str, Any]]:
    """Export samples of the data sets to frames/<name>/; return a row for each file of arrays.

    Parameters
    ----------
    bundle : directory of the bundle
    names : of the data sets
    pins : hashes of the published data, stated in the cards
    progress : called as ``progress(done, total, what)`` in data sets
    """
    rows: list[dict[str, Any]] = []
    for done, name in enumerate(names):
        progress(done, len(names), name)
        condition = datasets.get(name).conditions[0]
        export(name, bundle / FOLDER / name, conditions=(condition,), splits=SPLITS, pins=pins)
        rows += sample(bundle, name)
    progress(len(names), len(names), "")
    return rows


def sample(bundle: Path, name: str) -> list[dict[str, Any]]:
    """Return a row for each file of arrays of a data set's samples, as their card says."""
    return [
        {
            "dataset": name,
            "condition": entry["condition"],
            "split": entry["split"],
            "file": f"{FOLDER}/{name}/{entry['path']}",
            "samples": entry["samples"],
            "data_hash": entry["data_hash"],
        }
        for entry in read_card(bundle / FOLDER / name)["files"]
        if entry["kind"] == "arrays"
    ]
