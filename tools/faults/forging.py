"""Forgeries: something is changed and every digest beside it made to fit, as who means it would."""

from __future__ import annotations

import hashlib
import json
import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmark.datasets.checksums import write_checksums
from benchmark.datasets.export import CARD
from benchmark.datasets.export_arrays import read_archive, write_archive, write_table
from benchmark.datasets.export_verification import _rms, _samples
from benchmark.datasets.samples import samples_hash

Arrays = dict[str, Any]


def forged_export(rng: random.Random, folder: Path) -> str:
    """Forge an export; return how."""
    changes: tuple[Callable[[random.Random, Path, dict[str, Any]], None], ...] = (
        *(_numbers, _numbers, _bounds, _bounds, _flags, _rows, _said, _said, _picture, _left_out),
        *(_another_version, _another_name, _readings),
    )
    change = rng.choice(changes)
    card = json.loads((folder / CARD).read_text())
    change(rng, folder, card)
    _fit(folder, card)
    return f"forged: {change.__name__.strip('_').replace('_', ' ')}"


def _fit(folder: Path, card: dict[str, Any]) -> None:
    """Make every digest of an export fit what it holds."""
    for entry in card["files"]:
        path = folder / entry["path"]
        if entry["kind"] == "arrays":
            arrays = read_archive(path)
            said = {
                "data_hash": samples_hash(_samples(arrays)),
                "bound_rms_deg": _rms(arrays),
                "samples": len(arrays["sun"]),
            }
            entry.update(said)
            entry["arrays"] = {
                name: {"dtype": array.dtype.str, "shape": list(array.shape)}
                for name, array in arrays.items()
            }
            for other in card["files"]:
                if other["path"] == entry["path"].replace(".npz", ".csv"):
                    write_table(folder / other["path"], arrays)
                    other.update(said)
    for entry in card["files"]:
        data = (folder / entry["path"]).read_bytes()
        entry.update(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())
    (folder / CARD).write_text(json.dumps(card))
    write_checksums(folder)


def _archive(rng: random.Random, folder: Path, card: dict[str, Any], kind: str) -> Path:
    return folder / rng.choice([e["path"] for e in card["files"] if e["kind"] == kind])


def _changed(path: Path, change: Callable[[Arrays], None]) -> None:
    arrays = {name: array.copy() for name, array in read_archive(path).items()}
    change(arrays)
    write_archive(path, arrays)


def _numbers(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    """Change one number of what methods are given, in the sixth digit."""

    def change(arrays: Arrays) -> None:
        array = arrays[rng.choice(["observations", "sun"])]
        at = tuple(rng.randrange(length) for length in array.shape)
        array[at] = array[at] * (1 + 1e-6) + 1e-9

    _changed(_archive(rng, folder, card, "arrays"), change)


def _bounds(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    def change(arrays: Arrays) -> None:
        name = rng.choice([n for n in arrays if n.startswith("bound")])
        factor = rng.choice([1.01, 1000.0, 1e-9, np.nan, np.inf])
        if rng.random() < 0.5:
            arrays[name] *= factor
        else:
            arrays[name][rng.randrange(len(arrays[name]))] *= factor

    _changed(_archive(rng, folder, card, "arrays"), change)


def _flags(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    def change(arrays: Arrays) -> None:
        at = rng.randrange(len(arrays["observable"]))
        arrays["observable"][at] = not arrays["observable"][at]

    _changed(_archive(rng, folder, card, "arrays"), change)


def _rows(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    """Leave samples out, or put them in another order."""
    order = rng.choice([slice(None, -1), slice(1, None), slice(None, None, -1)])

    def change(arrays: Arrays) -> None:
        arrays.update({name: array[order].copy() for name, array in arrays.items()})

    _changed(_archive(rng, folder, card, "arrays"), change)


def _readings(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    def change(arrays: Arrays) -> None:
        array = arrays[rng.choice(list(arrays))]
        array.reshape(-1)[rng.randrange(array.size)] *= 1.01

    _changed(_archive(rng, folder, card, "references"), change)


def _said(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    """Change a word or a number of the card."""
    del folder
    known = ("schema", "files", "name", "version", "exported")
    text = json.dumps({name: value for name, value in card.items() if name not in known})
    places = [found.span(1) for found in re.finditer(r": (-?[0-9][0-9.e+-]*|\"[^\"\\]+\")", text)]
    start, end = rng.choice(places)
    new = '"forged"' if text[start] == '"' else str(float(text[start:end]) * 2 + 1)
    card |= json.loads(text[:start] + new + text[end:])


def _picture(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    from PIL import Image

    path = _archive(rng, folder, card, "preview")
    with Image.open(path) as shown:
        picture = shown.convert("RGBA")
    picture.putpixel((rng.randrange(picture.width), rng.randrange(picture.height)), (1, 2, 3, 255))
    picture.save(path)


def _left_out(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    entry = rng.choice(card["files"])
    (folder / entry["path"]).unlink()
    card["files"].remove(entry)


def _another_version(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    del rng, folder
    card["version"] += 76


def _another_name(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    del folder
    card["name"] = rng.choice(["pd-code-dial", "pd-nothing", "psd-single-aperture"])
