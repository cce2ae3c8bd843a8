"""Exports whose files, card and pins say different things, found without making them again."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.export import CARD, export
from benchmark.datasets.export_arrays import read_archive, write_archive
from benchmark.datasets.export_verification import verify
from benchmark.datasets.pins import Pin
from files.checksums import write_checksums

NAME, PATH = "pd-slit", "nominal/test.npz"
PLACE = (NAME, "nominal", "test")
N = 4

Change = Callable[[Path, dict[str, Any]], None]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("export") / "out"
    return export(NAME, out, conditions=["nominal"], splits=["test"], n=N).directory


@pytest.fixture
def copy(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "copy"))


def card_in(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / CARD).read_text()))


def entry_of(card: dict[str, Any], path: str = PATH) -> dict[str, Any]:
    return next(entry for entry in card["files"] if entry["path"] == path)


def write_back(folder: Path, card: dict[str, Any]) -> None:
    """Let sizes and SHA-256 fit the files, and nothing else that the card says of them."""
    for entry in card["files"]:
        data = (folder / entry["path"]).read_bytes()
        entry.update(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())
    seal(folder, card)


def seal(folder: Path, card: dict[str, Any]) -> None:
    (folder / CARD).write_text(json.dumps(card))
    write_checksums(folder)


def drop_test(folder: Path, card: dict[str, Any]) -> None:
    (folder / PATH).unlink()
    card["files"].remove(entry_of(card))


def name_another_kind(folder: Path, card: dict[str, Any]) -> None:
    entry_of(card)["kind"] = "film"


def change_table(folder: Path, card: dict[str, Any]) -> None:
    table = (folder / PATH).with_suffix(".csv")
    table.write_bytes(table.read_bytes().replace(b"1", b"2", 1))


def add_array(folder: Path, card: dict[str, Any]) -> None:
    arrays = read_archive(folder / PATH)
    write_archive(folder / PATH, {**arrays, "hidden": np.zeros(2)})


def count_one_more(folder: Path, card: dict[str, Any]) -> None:
    entry_of(card)["samples"] = N + 1


def state_another_bound(folder: Path, card: dict[str, Any]) -> None:
    entry_of(card)["bound_rms_deg"] *= 1.01


@pytest.mark.parametrize(
    ("change", "where", "what"),
    [
        (drop_test, CARD, "nominal/test.npz is missing among the files"),
        (name_another_kind, PATH, "kind is 'film'"),
        (change_table, "nominal/test.csv", "differs from nominal/test.npz"),
        (add_array, PATH, "hidden.npy is no array of the card"),
        (count_one_more, PATH, "holds 4 samples, the card says 5"),
        (state_another_bound, PATH, "root mean square of bound_deg is "),
    ],
)
def test_a_contradiction_is_named_with_its_file(
    copy: Path, change: Change, where: str, what: str
) -> None:
    card = card_in(copy)
    change(copy, card)
    write_back(copy, card)
    ((file, problem),) = verify(copy, anew=False)
    assert file == where
    assert problem.startswith(what)


def pin_of(folder: Path) -> Pin:
    entry = entry_of(card_in(folder))
    return Pin(
        *PLACE,
        version=datasets.get(NAME).version,
        n=N,
        data_hash=entry["data_hash"],
        head_hash=entry["data_hash"],
        bound_deg=entry["bound_rms_deg"],
    )


def test_data_and_bound_are_held_against_a_pin_of_as_many_samples(made: Path) -> None:
    pin = pin_of(made)
    assert pin.bound_deg is not None
    assert verify(made, pins={PLACE: pin}, anew=False) == []

    other = replace(pin, data_hash="0" * 32)
    assert verify(made, pins={PLACE: other}, anew=False) == [
        (PATH, f"hash of the data is {pin.data_hash}, of the published {'0' * 32}")
    ]
    wide = replace(pin, bound_deg=2.0 * pin.bound_deg)
    assert verify(made, pins={PLACE: wide}, anew=False) == [
        (PATH, f"bound_rms_deg is {pin.bound_deg}, of the published {wide.bound_deg}")
    ]
