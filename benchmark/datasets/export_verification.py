"""Whether an export is what it says: whole, and the data of the data set that it claims to be.

Checksums and hashes that stand in an export are made by whoever made it, and tell of damage alone.
What an export claims is held against the data set itself: its card against what the data set says
of itself, hashes and bounds against the pins of the published data, and everything against the same
export made again.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmark import datasets
from benchmark.datasets import Preset, UnknownDatasetError
from benchmark.datasets.export import CARD, ExportError, card_of, export, read_card
from benchmark.datasets.export_arrays import read_archive, samples_of, table_text
from benchmark.datasets.pins import BOUND_TOLERANCE, Pin, Place, bounds_agree
from benchmark.datasets.samples import HEAD, head_hash, samples_hash
from benchmark.metrics.separation import store
from benchmark.progress import ProgressCallback, silent
from files.atomic import temporary_directory
from files.checksums import CHECKSUMS, differences, read_checksums, sha256

Problem = tuple[str, str]

#: Of an archive's member, beside its numbers.
_HEADER_BYTES = 4096
#: What the file itself is held against, not the card of another export.
_OF_THE_FILE = frozenset({"bytes", "sha256"})


def verify(
    directory: Path | str,
    *,
    pins: Mapping[Place, Pin] = MappingProxyType({}),
    anew: bool = True,
    progress: ProgressCallback = silent,
) -> list[Problem]:
    """Check an export: (file, what is wrong with it); empty where all holds.

    Checksums of the files first; where they hold, the card against the data set; then the arrays
    against card and pins; then all of it against the same export made again. The first of these
    that finds anything is the last.

    `pins` are of the published data. Made `anew` takes as long as it took to make it; without it,
    of samples that no pin is of only the first `samples.HEAD` are held against the published data,
    and of bounds their root mean square. ExportError where the directory is no export, or its card
    cannot be read; FileRefusedError where the list of checksums cannot be read.
    """
    directory = Path(directory)
    if not (directory / CHECKSUMS).is_file():
        raise ExportError(f"{directory}: not an export of a dataset, it has no {CHECKSUMS}")
    if wrong := differences(directory):
        return wrong
    card = read_card(directory)
    try:
        return _claims(directory, card, pins, anew, progress)
    except (LookupError, TypeError, AttributeError, ArithmeticError) as error:
        raise ExportError(f"{directory / CARD}: not the card of an export ({error!r})") from error


def _claims(
    directory: Path,
    card: Mapping[str, Any],
    pins: Mapping[Place, Pin],
    anew: bool,
    progress: ProgressCallback,
) -> list[Problem]:
    try:
        preset = datasets.get(card["name"])
    except UnknownDatasetError as error:
        return [(CARD, f"{error}: nothing to hold it against")]
    if card["version"] != preset.version:
        here = f"here is version {preset.version}: verify it with the release that made it"
        return [(CARD, f"of version {card['version']!r} of {preset.name}; {here}")]
    if wrong := list(_wrong_card(directory, card, preset)):
        return [(CARD, text) for text in wrong]
    found: list[Problem] = []
    for entry in card["files"]:
        found += _wrong_file(directory, preset, entry, pins)
    if found or not anew:
        return sorted(found)
    return _against_another(directory, card, pins, progress)


def _wrong_card(directory: Path, card: Mapping[str, Any], preset: Preset) -> Iterator[str]:
    """Hold what a card says of all files against what the data set says of itself."""
    exported = card["exported"]
    conditions, splits, n = (exported[k] for k in ("conditions", "splits", "first_samples"))
    if not (conditions and splits and set(conditions) <= set(preset.conditions)):
        yield f"exported: {preset.name} has no conditions {_short(conditions)} of {_short(splits)}"
        return
    if not (n is None or (type(n) is int and n > 0)):
        yield f"exported: expected a number of samples from 1 or null, got {_short(n)}"
        return
    paths = [entry["path"] for entry in card["files"]]
    listed = read_checksums(directory).keys() - {CARD}
    if sorted(paths) != sorted(listed):
        yield f"files are {_short(sorted(paths))}, and {CHECKSUMS} lists {_short(sorted(listed))}"
        return
    asked = {f"{condition}/{split}.npz" for condition in conditions for split in splits}
    if missing := sorted(asked - set(paths)):
        yield f"{missing[0]} is missing among the files"
        return
    expected = card_of(directory, preset, exported, card["files"])
    for place, said, should in _unlike(card, expected):
        yield f"{place} is {_short(said)}, the data set says {_short(should)}"


def _wrong_file(
    directory: Path, preset: Preset, entry: Mapping[str, Any], pins: Mapping[Place, Pin]
) -> list[Problem]:
    name = entry["path"]
    path = directory / name
    if sha256(path) != entry["sha256"] or path.stat().st_size != entry["bytes"]:
        return [(name, "SHA-256 or size is not that of the card")]
    if entry["kind"] in {"table", "preview"}:  # held against their arrays, and the data set
        return []
    if entry["kind"] not in {"arrays", "references"}:
        return [(name, f"kind is {_short(entry['kind'])}")]
    arrays = _read(path, entry["arrays"])
    if isinstance(arrays, str):
        return [(name, arrays)]
    pin = pins.get((preset.name, entry.get("condition", ""), entry.get("split", "")))
    found = [(name, text) for text in _wrong_arrays(arrays, entry, pin, preset.version)]
    table = path.with_suffix(".csv")
    if not found and table.is_file() and table.read_bytes() != table_text(arrays).encode():
        found.append((name.removesuffix(".npz") + ".csv", f"differs from {name}"))
    return found


def _read(path: Path, described: Mapping[str, Any]) -> dict[str, NDArray[Any]] | str:
    """Return the arrays of an archive no larger than the card says, or what is wrong with it."""
    try:
        with zipfile.ZipFile(path) as archive:
            for member in archive.infolist():
                stated = described.get(member.filename.removesuffix(".npy"))
                if stated is None:
                    return f"{member.filename} is no array of the card"
                most = (
                    np.dtype(stated["dtype"]).itemsize * math.prod(stated["shape"]) + _HEADER_BYTES
                )
                if member.file_size > most:
                    return f"{member.filename} unpacks to more than the card says"
        return read_archive(path)
    except (OSError, zipfile.BadZipFile, ValueError, NotImplementedError, RuntimeError) as error:
        return f"not an archive of arrays ({error})"


def _wrong_arrays(
    arrays: Mapping[str, NDArray[Any]], entry: Mapping[str, Any], pin: Pin | None, version: int
) -> Iterator[str]:
    shapes = {key: {"dtype": a.dtype.str, "shape": list(a.shape)} for key, a in arrays.items()}
    if shapes != entry["arrays"]:
        yield f"holds {_short(shapes)}, the card says {_short(entry['arrays'])}"
        return
    if entry["kind"] == "references":
        return
    found, count, rms = samples_hash(samples_of(arrays)), len(arrays["sun"]), _rms(arrays)
    if found != entry["data_hash"]:
        yield f"hash of the data is {found}, the card says {_short(entry['data_hash'])}"
    elif entry["samples"] != count or any(len(array) != count for array in arrays.values()):
        yield f"holds {count} samples, the card says {_short(entry['samples'])}"
    elif not _alike(rms, entry["bound_rms_deg"]):
        said = _short(entry["bound_rms_deg"])
        yield f"root mean square of bound_deg is {rms}, the card says {said}"
    elif pin is not None and pin.version == version:
        yield from _unpinned(arrays, entry, pin)


def _unpinned(
    arrays: Mapping[str, NDArray[Any]], entry: Mapping[str, Any], pin: Pin
) -> Iterator[str]:
    if entry["samples"] == pin.n:
        if entry["data_hash"] != pin.data_hash:
            yield f"hash of the data is {entry['data_hash']}, of the published {pin.data_hash}"
        elif pin.split == "test" and not bounds_agree(pin.bound_deg, _rms(arrays)):
            yield f"bound_rms_deg is {_rms(arrays)}, of the published {pin.bound_deg}"
    elif entry["samples"] >= HEAD and (head := head_hash(samples_of(arrays))) != pin.head_hash:
        yield f"hash of the first {HEAD} samples is {head}, of the published {pin.head_hash}"


def _against_another(
    directory: Path, card: Mapping[str, Any], pins: Mapping[Place, Pin], progress: ProgressCallback
) -> list[Problem]:
    """Hold an export against the same one made again."""
    asked = card["exported"]
    with temporary_directory() as temporary:
        made = export(
            card["name"],
            temporary / "again",
            conditions=asked["conditions"],
            splits=asked["splits"],
            n=asked["first_samples"],
            pins=pins,
            progress=progress,
        )
        said = f"the data set {card['name']} says"
        found = [
            (CARD, f"{place} is {_short(stated)}, {said} {_short(should)}")
            for place, stated, should in _unlike(card, made.card)
        ]
        if found:
            return found
        for entry in card["files"]:
            one, other = directory / entry["path"], made.directory / entry["path"]
            if one.read_bytes() == other.read_bytes():
                continue
            text = ""
            if entry["kind"] in {"arrays", "references"}:
                text = _unlike_arrays(read_archive(one), read_archive(other))
            elif entry["kind"] == "preview" and not _same_picture(one, other):
                text = "not the picture that the data set draws"
            if text:
                found.append((entry["path"], text))
    return found


def _unlike_arrays(said: Mapping[str, NDArray[Any]], should: Mapping[str, NDArray[Any]]) -> str:
    """Name the first sample in which arrays differ, bounds beyond rounding; empty for none."""
    for name, array in should.items():
        one, other = said[name], array
        if name.startswith("bound_"):  # last bits are other ones on other processors
            same = np.isclose(one, other, rtol=BOUND_TOLERANCE, atol=0.0, equal_nan=True)
        elif other.dtype.kind == "f":
            same = (one == other) | (np.isnan(one) & np.isnan(other))
        else:
            same = one == other
        if not same.all():
            at = tuple(int(k) for k in np.argwhere(~same)[0])
            where = f"{name}[{', '.join(map(str, at))}]"
            return f"{where} is {one[at]}, the data set makes {other[at]}"
    return ""


def _same_picture(one: Path, other: Path) -> bool:
    """Say whether pictures show the same, however their libraries packed them."""
    import cv2  # noqa: PLC0415 - of verification alone

    shown, should = (cv2.imread(str(path), cv2.IMREAD_UNCHANGED) for path in (one, other))
    return shown is not None and should is not None and np.array_equal(shown, should)


def _unlike(said: Any, should: Any, place: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Give (place, what is said, what should be) of every leaf in which two cards differ."""
    if isinstance(said, dict) and isinstance(should, Mapping):
        for name in [*should, *(name for name in said if name not in should)]:
            if name in _OF_THE_FILE:
                continue
            inner = f"{place}.{name}".lstrip(".")
            if name == "published_data_hash" and None in (said.get(name, ""), should.get(name, "")):
                continue  # made, or verified, without pins
            if name == "bound_rms_deg" and _alike(said.get(name, math.nan), should.get(name)):
                continue
            yield from _unlike(said.get(name, _NONE), should.get(name, _NONE), inner)
    elif isinstance(said, list) and isinstance(should, list | tuple) and len(said) == len(should):
        for number, (one, other) in enumerate(zip(said, should, strict=True)):
            yield from _unlike(one, other, f"{place}[{number}]")
    elif not (said == should and _is_number(said) == _is_number(should)):
        yield place, said, should


class _Nothing:
    def __repr__(self) -> str:
        return "missing"


_NONE = _Nothing()


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _alike(one: Any, other: Any) -> bool:
    known = (one is None or _is_number(one)) and (other is None or _is_number(other))
    return known and bounds_agree(one, other)


def _rms(arrays: Mapping[str, NDArray[Any]]) -> float | None:
    """Return the root mean square of the bounds of observable samples; None for none."""
    seen = arrays["bound_deg"][arrays["observable"]]
    return store(float(np.sqrt(np.mean(seen**2)))) if seen.size else None


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 100 else f"{text[:97]}..."
