"""A dataset as files: arrays, a card that says what they are, checksums, a picture.

An export is a directory: ``card.json``, ``checksums-sha256.txt`` (which ``sha256sum --check``
reads) and for each condition ``<condition>/preview.png``, ``<condition>/references.npz`` where a
calibration has flat and dark readings, ``<condition>/references-test.npz`` where they are taken
again after it, ``<condition>/<split>.npz`` and, where samples are a few
numbers each, the same as ``<condition>/<split>.csv``. It is a function of the
dataset and of what was asked for: exporting twice gives the same bytes.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from numpy.typing import NDArray

from algorithms.contract import Observation
from benchmark import datasets
from benchmark.contract import SPLITS, UnknownNameError
from benchmark.datasets import Preset
from benchmark.datasets.export_arrays import columns_of, write_archive, write_table
from benchmark.datasets.pins import Pin, Place
from benchmark.datasets.preview import preview_png
from benchmark.datasets.samples import samples_hash
from benchmark.metrics.bounds import Bound
from benchmark.metrics.separation import store
from benchmark.progress import ProgressCallback, silent
from files.atomic import replace_all, require_replaceable
from files.checksums import (
    CHECKSUMS,
    contents,
    read_checksums,
    sha256,
    write_checksums,
)
from files.reading import FileRefusedError, read_json

CARD = "card.json"
#: Layout of an export; raised when a file or a field changes its meaning.
SCHEMA_VERSION = 1

#: What the arrays beside the observations are.
_MEANINGS = {
    "sun": "(N, 3) unit vectors from the sensor to the Sun, sensor frame, +z the boresight; "
    "tan(alpha) = y/z, tan(beta) = x/z; true ones but in the calibration split, where they are "
    "what the bench (in orbit: another instrument) says",
    "true_sun": "(N, 3) where the Sun truly stood, where `sun` has errors; not for methods",
    "origin_px": "(N, 2) detector coordinates (x, y) of each window's first pixel; a pixel's "
    "centre is at whole numbers",
    "bound_deg": "(N,) Cramer-Rao bound of the separation angle, one standard deviation, degrees; "
    "inf where the direction is not observable",
    "bound_alpha_deg": "(N,) the same of alpha; NaN where the Sun is not in front of the sensor",
    "bound_beta_deg": "(N,) the same of beta",
    "bound_unit_deg": "(N,) as bound_deg, with the unit unknown but for the flat and dark readings "
    "of references.npz; inf where the direction is not observable then",
    "observable": "(N,) bool: where the direction is observable from the sample",
}


class ExportError(ValueError):
    """A directory cannot be written to or is no export; the message names it."""


@dataclass(frozen=True)
class ExportResult:
    """What was written.

    Paths in the directory, sorted, and the card as in ``card.json``.
    """

    directory: Path
    files: tuple[str, ...]
    card: Mapping[str, Any]


def export(
    name: str,
    out: Path | str,
    *,
    conditions: Sequence[str] | None = None,
    splits: Sequence[str] | None = None,
    n: int | None = None,
    force: bool = False,
    progress: ProgressCallback = silent,
    pins: Mapping[Place, Pin] = MappingProxyType({}),
) -> ExportResult:
    """Write a dataset to the directory `out`, whole or not at all.

    Of the conditions and splits named, or all, only the first `n` samples if given. `force`
    replaces an earlier export; anything else in the way is refused all the same. `progress` is
    called as ``progress(done, total, what)`` in splits. Hashes of `pins`, of the published data,
    are stated in the card beside those of what is written.

    UnknownDatasetError, UnknownNameError for a name that there is not, naming the nearest;
    ExportError where `out` holds something; ValueError for n below 1.
    """
    preset = datasets.get(name)
    chosen = _choose("condition", conditions, preset.conditions)
    wanted = _choose("split", splits, SPLITS)
    if n is not None and n < 1:
        raise ValueError(f"n must be at least 1; got {n}")
    out = Path(os.path.abspath(out))  # noqa: PTH100 - resolve() would follow a symbolic link
    require_replaceable(out)
    _require_free(out, force=force)
    with replace_all(out) as (made,):
        _require_free(out, force=force)  # again: this process may have waited for another
        made.mkdir()
        files: list[dict[str, Any]] = []
        total = len(chosen) * len(wanted)
        for done, condition in enumerate(chosen):
            (made / condition).mkdir()
            for more, split in enumerate(wanted):
                progress(done * len(wanted) + more, total, f"{condition} {split}")
                pinned = pins.get((name, condition, split))
                files += _write_split(made, preset, (condition, split), n, pinned)
            files += _write_references(made, preset, condition)
            picture = f"{condition}/preview.png"
            (made / picture).write_bytes(preview_png(preset, condition))
            files.append({"path": picture, "kind": "preview", "condition": condition})
        exported = {"conditions": chosen, "splits": wanted, "first_samples": n}
        card = card_of(made, preset, exported, files)
        text = json.dumps(card, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
        (made / CARD).write_text(text, "utf-8", newline="\n")
        write_checksums(made)
    progress(total, total, "")
    return ExportResult(out, tuple(contents(out)), card)


def _write_split(
    made: Path, preset: Preset, which: tuple[str, str], n: int | None, pinned: Pin | None
) -> list[dict[str, Any]]:
    condition, split = which
    samples = preset.generate(condition, split, n)
    bound = preset.bound(condition, split, n)
    arrays = {name: array for name, array in samples.arrays().items() if array is not None}
    arrays |= _bounds(bound)
    count = len(samples.sun)
    about = {
        "condition": condition,
        "split": split,
        "samples": count,
        "data_hash": samples_hash(samples),
        "published_data_hash": pinned.data_hash if pinned and pinned.n == count else None,
        "bound_rms_deg": None if math.isnan(bound.rms_deg) else store(bound.rms_deg),
    }
    path = f"{condition}/{split}.npz"
    write_archive(made / path, arrays)
    shapes = {name: _describe(array) for name, array in arrays.items()}
    files: list[dict[str, Any]] = [{"path": path, "kind": "arrays", **about, "arrays": shapes}]
    if preset.observation is Observation.CURRENTS:
        path = f"{condition}/{split}.csv"
        write_table(made / path, arrays)
        files.append({"path": path, "kind": "table", **about, "columns": list(columns_of(arrays))})
    return files


def _write_references(made: Path, preset: Preset, condition: str) -> list[dict[str, Any]]:
    setup, files = preset.condition(condition), []
    taken = {"references.npz": "calibration"}
    if setup.renewed or setup.mission is not None:
        taken["references-test.npz"] = "test"
    for name, split in taken.items():
        readings = preset.references(condition, split)
        if not readings:
            continue
        path = f"{condition}/{name}"
        write_archive(made / path, readings)
        shapes = {name: _describe(array) for name, array in readings.items()}
        files.append({"path": path, "kind": "references", "condition": condition, "arrays": shapes})
    return files


def _bounds(bound: Bound) -> dict[str, NDArray[Any]]:
    unit = bound.unit_angle_deg
    return {
        "bound_deg": bound.angle_deg,
        "bound_alpha_deg": bound.alpha_deg,
        "bound_beta_deg": bound.beta_deg,
        **({} if unit is None else {"bound_unit_deg": unit}),
        "observable": bound.observable,
    }


def _describe(array: NDArray[Any]) -> dict[str, Any]:
    return {"dtype": array.dtype.str, "shape": list(array.shape)}


def card_of(
    made: Path,
    preset: Preset,
    exported: Mapping[str, Any],
    files: Sequence[Mapping[str, Any]],
) -> dict[str, Any]:
    """Return the card of an export."""
    card = preset.card()
    names = {name for file in files for name in file.get("arrays", ())}
    context = card.get("context", {})
    meanings = {"observations": f"{preset.units}; one row a sample", **_MEANINGS}
    meanings |= _references_meant(preset)
    meanings |= {f"context.{name}": text for name, text in context.items()}
    return {
        "schema": SCHEMA_VERSION,
        **{name: member for name, member in card.items() if name != "conditions"},
        "conditions": {name: card["conditions"][name] for name in exported["conditions"]},
        "studies": _studies(preset.follows),
        "exported": exported,
        "arrays": {name: text for name, text in meanings.items() if name in names},
        "data_hash": "first 32 digits of a SHA-256 over names, types, shapes and bytes of "
        "observations, sun, origin_px, true_sun and context, as in scores and pins of Sun Sensor "
        "Atlas",
        "files": [
            {
                **file,
                "bytes": (made / file["path"]).stat().st_size,
                "sha256": sha256(made / file["path"]),
            }
            for file in files
        ],
    }


def _references_meant(preset: Preset) -> dict[str, str]:
    offered = preset.offered
    light = f"uniform light at {offered.level:g} of the scale"
    return {
        f"{kind}_{unit}": f"mean of {count} readings {what}, of every element of this unit; {text}"
        for unit, text in (
            ("dn", "digital numbers, (rows, columns) or (columns,)"),
            ("ua", "microamperes, (K,)"),
            ("hz", "hertz, (K,)"),
        )
        for kind, count, what in (
            ("dark", offered.darks, "without light"),
            ("flat", offered.flats, f"in {light}"),
        )
    }


def _studies(keys: Sequence[str]) -> list[dict[str, Any]]:
    from registry.studies import study  # noqa: PLC0415 - pandas, which only the card needs

    named = ("key", "title", "authors", "year", "venue", "doi", "url")
    return [{name: getattr(study(key), name) for name in named} for key in keys]


def _choose(what: str, wanted: Sequence[str] | None, known: Sequence[str]) -> list[str]:
    for name in wanted or ():
        if name not in known:
            raise UnknownNameError(what, name, known)
    return [name for name in known if not wanted or name in wanted]


def read_card(directory: Path) -> dict[str, Any]:
    """Read the card of an export; ExportError where there is none."""
    path = directory / CARD
    try:
        card = read_json(path)
    except FileNotFoundError as error:
        raise ExportError(f"{directory}: not an export of a dataset, it has no {CARD}") from error
    except FileRefusedError as error:
        raise ExportError(str(error)) from error
    if not isinstance(card, dict) or card.get("schema") != SCHEMA_VERSION or "files" not in card:
        raise ExportError(f"{path}: not the card of an export, schema {SCHEMA_VERSION}")
    return card


def _require_free(out: Path, *, force: bool) -> None:
    if out.is_symlink() or (out.exists() and not out.is_dir()):
        raise ExportError(f"{out}: expected a directory or nothing; nothing was written")
    if not out.exists() or not any(out.iterdir()):
        return
    try:
        listed = {*read_checksums(out), CHECKSUMS}
        foreign = [name for name in contents(out) if name not in listed]
        read_card(out)
    except (FileNotFoundError, FileRefusedError, ExportError):
        foreign = contents(out) or ["directories"]
    if foreign:
        raise ExportError(
            f"{out}: holds {foreign[0]}, which is no part of an earlier export; choose another "
            "directory with --out; nothing was written"
        )
    if not force:
        raise ExportError(
            f"{out}: holds an earlier export; replace it with --force; nothing was written"
        )
