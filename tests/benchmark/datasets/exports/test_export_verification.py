"""Forged exports, whose digests all hold, are found by what the data set itself makes."""

from __future__ import annotations

import hashlib
import json
import random
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmark.datasets import export_verification
from benchmark.datasets.export import CARD, ExportError, export
from benchmark.datasets.export_arrays import read_archive, samples_of, write_archive, write_table
from benchmark.datasets.export_verification import _rms, verify
from benchmark.datasets.samples import samples_hash
from benchmark.results.store import PUBLISHED, Store
from files.checksums import write_checksums

Arrays = dict[str, Any]

PINS = Store(PUBLISHED).pins()


def fit(folder: Path, card: dict[str, Any]) -> None:
    """Make every digest of an export fit what it holds."""
    for entry in card["files"]:
        path = folder / entry["path"]
        if entry["kind"] == "arrays":
            arrays = read_archive(path)
            said = {
                "data_hash": samples_hash(samples_of(arrays)),
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


def archive(rng: random.Random, folder: Path, card: dict[str, Any], kind: str) -> Path:
    return folder / rng.choice([e["path"] for e in card["files"] if e["kind"] == kind])


def changed(path: Path, change: Callable[[Arrays], None]) -> None:
    arrays = {name: array.copy() for name, array in read_archive(path).items()}
    change(arrays)
    write_archive(path, arrays)


def numbers(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    """Change one number of what methods are given, in the sixth digit."""

    def change(arrays: Arrays) -> None:
        array = arrays[rng.choice(["observations", "sun"])]
        at = tuple(rng.randrange(length) for length in array.shape)
        array[at] = array[at] * (1 + 1e-6) + 1e-9

    changed(archive(rng, folder, card, "arrays"), change)


def bounds(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    def change(arrays: Arrays) -> None:
        name = rng.choice([n for n in arrays if n.startswith("bound")])
        factor = rng.choice([1.01, 1000.0, 1e-9, np.nan, np.inf])
        if rng.random() < 0.5:
            arrays[name] *= factor
        else:
            arrays[name][rng.randrange(len(arrays[name]))] *= factor

    changed(archive(rng, folder, card, "arrays"), change)


def flags(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    def change(arrays: Arrays) -> None:
        at = rng.randrange(len(arrays["observable"]))
        arrays["observable"][at] = not arrays["observable"][at]

    changed(archive(rng, folder, card, "arrays"), change)


def rows(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    """Leave samples out, or put them in another order."""
    order = rng.choice([slice(None, -1), slice(1, None), slice(None, None, -1)])

    def change(arrays: Arrays) -> None:
        arrays.update({name: array[order].copy() for name, array in arrays.items()})

    changed(archive(rng, folder, card, "arrays"), change)


def readings(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    def change(arrays: Arrays) -> None:
        array = arrays[rng.choice(list(arrays))]
        array.reshape(-1)[rng.randrange(array.size)] *= 1.01

    changed(archive(rng, folder, card, "references"), change)


def said(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    """Change a word or a number of the card."""
    del folder
    known = ("schema", "files", "name", "version", "exported")
    text = json.dumps({name: value for name, value in card.items() if name not in known})
    places = [found.span(1) for found in re.finditer(r": (-?[0-9][0-9.e+-]*|\"[^\"\\]+\")", text)]
    start, end = rng.choice(places)
    new = '"forged"' if text[start] == '"' else str(float(text[start:end]) * 2 + 1)
    card |= json.loads(text[:start] + new + text[end:])


def picture(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    from PIL import Image

    path = archive(rng, folder, card, "preview")
    with Image.open(path) as shown:
        picture = shown.convert("RGBA")
    picture.putpixel((rng.randrange(picture.width), rng.randrange(picture.height)), (1, 2, 3, 255))
    picture.save(path)


def left_out(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    entry = rng.choice(card["files"])
    (folder / entry["path"]).unlink()
    card["files"].remove(entry)


def another_version(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    del rng, folder
    card["version"] += 76


def another_name(rng: random.Random, folder: Path, card: dict[str, Any]) -> None:
    del folder
    card["name"] = rng.choice(["pd-code-dial", "pd-nothing", "psd-single-aperture"])


FORGERIES = (
    numbers,
    bounds,
    flags,
    rows,
    readings,
    said,
    picture,
    left_out,
    another_version,
    another_name,
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("export") / "out"
    return export("pd-slit", out, conditions=["nominal"], n=6, pins=PINS).directory


@pytest.fixture
def copy(made, tmp_path):
    return Path(shutil.copytree(made, tmp_path / "copy"))


@pytest.mark.parametrize("forgery", FORGERIES, ids=lambda one: one.__name__)
def test_a_forgery_whose_digests_fit_is_found(copy, forgery):
    card = json.loads((copy / CARD).read_text())
    forgery(random.Random(3), copy, card)
    fit(copy, card)
    assert len(verify(copy, pins=PINS)) >= 1


def test_fitting_digests_alone_changes_nothing(copy):
    fit(copy, json.loads((copy / CARD).read_text()))
    assert verify(copy, pins=PINS) == []


def test_what_differs_is_named_by_its_sample(copy):
    path = copy / "nominal" / "test.npz"

    def change(arrays):
        arrays["bound_alpha_deg"][4] *= 1000

    changed(path, change)
    fit(copy, json.loads((copy / CARD).read_text()))
    ((where, what),) = verify(copy, pins=PINS)
    assert where == "nominal/test.npz"
    assert what.startswith("bound_alpha_deg[4] is ")


def test_a_card_that_asks_for_nothing_known_is_refused(copy):
    card = json.loads((copy / CARD).read_text())
    for asked in ({"conditions": [], "splits": []}, {"first_samples": "six"}):
        fit(copy, {**card, "exported": {**card["exported"], **asked}})
        ((where, what),) = verify(copy)
        assert (where, what[:9]) == (CARD, "exported:")
    fit(copy, {**card, "exported": {}})
    with pytest.raises(ExportError, match="not the card of an export"):
        verify(copy)


def test_an_archive_that_unpacks_to_more_than_its_card_says_is_not_unpacked(copy):
    path = copy / "nominal" / "test.npz"
    described = {
        name: {"dtype": array.dtype.str, "shape": [1]}
        for name, array in export_verification.read_archive(path).items()
    }
    assert "unpacks to more" not in export_verification._read(path, described)
    changed(path, lambda a: a.update(sun=a["sun"].repeat(1000, axis=0)))
    assert "unpacks to more" in export_verification._read(path, described)


def test_what_a_card_leaves_out_is_named_but_not_a_hash_that_is_published_for_one_side(copy):
    card = json.loads((copy / CARD).read_text())
    card["mask"] = None
    for entry in card["files"]:
        if "published_data_hash" in entry:
            assert entry["published_data_hash"] is None
            entry["published_data_hash"] = entry["data_hash"]
    fit(copy, card)
    (problem,) = verify(copy, pins=PINS)
    assert problem[0] == CARD
    assert problem[1].startswith("mask is None, ")
