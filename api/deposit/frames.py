"""Samples of every standard data set in the bundle: what a method is given, and the truth.

Of each data set the nominal condition, calibration and test split: whole where both are small,
which all are but those of large frames; of these the first few, to look at. Each is an export as
`sunatlas dataset export` makes it: a card, arrays, flat and dark readings, a picture, checksums.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmark import datasets
from benchmark.datasets.export import export, read_card
from benchmark.datasets.pins import Pin, Place
from benchmark.progress import ProgressCallback, silent

FOLDER = "frames"
SPLITS = ("calibration", "test")
#: Bytes of memory up to which a split is whole; how many the few of a larger one fill; at least
#: so few.
WHOLE, ROOM, LEAST = 8 << 20, 1 << 20, 2


def sample_size(name: str, pins: Mapping[Place, Pin]) -> int | None:
    """Return how many samples of each split go into the bundle; None for all there are.

    The calibration poses of most data sets are a raster: the first few of them cover a strip of
    the field, with which nobody can calibrate. So it is all, or some to look at.
    """
    preset = datasets.get(name)
    condition = preset.conditions[0]
    one = preset.generate(condition, "test", 1).observations.nbytes
    most = max(pins[name, condition, split].n for split in SPLITS)
    return None if one * most <= WHOLE else max(LEAST, ROOM // one)


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
        preset = datasets.get(name)
        size = sample_size(name, pins)
        condition = preset.conditions[0]
        export(
            name,
            bundle / FOLDER / name,
            conditions=(condition,),
            splits=SPLITS,
            n=size,
            pins=pins,
        )
        rows += sample(bundle, name, pins)
    progress(len(names), len(names), "")
    return rows


def sample(bundle: Path, name: str, pins: Mapping[Place, Pin]) -> list[dict[str, Any]]:
    """Return a row for each file of arrays of a data set's samples, as their card says."""
    return [
        {
            "dataset": name,
            "condition": entry["condition"],
            "split": entry["split"],
            "file": f"{FOLDER}/{name}/{entry['path']}",
            "samples": entry["samples"],
            "samples_of": pins[name, entry["condition"], entry["split"]].n,
            "data_hash": entry["data_hash"],
        }
        for entry in read_card(bundle / FOLDER / name)["files"]
        if entry["kind"] == "arrays"
    ]
