"""Files of a calibration: tables, or a table of picture files, of which each becomes a spot."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import FeatureKind, Floats, UnsuitableDesignError
from algorithms.discovery import discover_extractors
from algorithms.measurement import QualityFlag
from calibrate.forms.pictures import picture_size
from calibrate.roles import understood
from calibrate.settings import ReadingsSettings, Settings, SettingsError
from calibrate.table import SUFFIXES, Table, TableError, read_table
from files.reading import FileRefusedError, read_bytes

_LARGEST = 512 * 1024 * 1024


@dataclass(frozen=True)
class Sources:
    """What files of one sensor hold."""

    tables: tuple[Table, ...]  # one a file; pictures are spots already
    settings: Settings
    notes: tuple[str, ...]  # on how the files and pictures were read
    digest: str  # SHA-256 of all files, 32 digits
    digests: tuple[str, ...]  # SHA-256 of each file


def read_sources(
    paths: Sequence[Path],
    settings: Settings | None = None,
    progress: Callable[[str, int, int], None] = lambda *_: None,
    most_rows: int | None = None,
) -> Sources:
    """Read files, or directories of pictures with one table each; settings are guessed if none.

    TableError if a file is none, or lacks a column, or if all have more than so many rows.
    """
    paths = [table_in(path) if path.is_dir() else path for path in paths]
    tables = [read_table(path, settings.file if settings else None) for path in paths]
    rows = sum(map(len, tables))
    if most_rows is not None and rows > most_rows:
        raise TableError(f"expected at most {most_rows} rows in all; got {rows}")
    stated, notes = _stated(tables, settings)
    if stated.readings.kind == "frames":
        for at, path in enumerate(paths):
            tables[at], said = with_spots(
                tables[at], path.parent, stated, lambda done, all_: progress("frames", done, all_)
            )
            notes += said
        stated = of_spots(stated)
    whole = hashlib.sha256()
    digests = []
    for path in paths:
        data = read_bytes(path, _LARGEST)
        whole.update(data)
        digests.append(hashlib.sha256(data).hexdigest())
    return Sources(tuple(tables), stated, tuple(notes), whole.hexdigest()[:32], tuple(digests))


def _stated(tables: Sequence[Table], settings: Settings | None) -> tuple[Settings, list[str]]:
    """Return settings, guessed where none are stated, and how files and columns were read."""
    notes = list(dict.fromkeys(note for table in tables for note in table.notes))
    if settings is not None:
        return settings, notes
    guessed = understood(tables[0])
    return guessed.settings, [*notes, *guessed.notes]


#: Columns that a spot gets in the table.
SPOT = "spot_x_px", "spot_y_px"
_LARGEST_PICTURE = 100_000_000
_MOST_PIXELS = 100_000_000
#: Pixels of the largest value, and their share of those above half of it, from which they count as
#: saturated.
_FEWEST_CLIPPED, _SHARE_CLIPPED = 8, 0.1


def table_in(directory: Path) -> Path:
    """Return the one table of poses in a directory of pictures; TableError otherwise."""
    found = sorted(path for path in directory.iterdir() if path.suffix.lower() in SUFFIXES)
    if len(found) != 1:
        raise TableError(
            f"{directory.name}: expected one table that names the pictures beside it and their "
            f"poses; got {', '.join(path.name for path in found) or 'none'}"
        )
    return found[0]


def with_spots(
    table: Table,
    directory: Path,
    settings: Settings,
    tick: Callable[[int, int], None] = lambda *_: None,
) -> tuple[Table, list[str]]:
    """Return the table with the spot of each row's picture, and what was done to the pictures.

    The table has a column of names of PNG, TIFF, BMP or JPEG files; they start from the
    directory, and may not lead out of it. `tick` is called with the number read and the number
    of all. TableError if a picture is missing or is none, by row; SettingsError if the
    extractor does not read one spot in a frame, or needs more of the drawing.
    """
    column = settings.readings.columns[0]
    if column not in table.columns:
        table.numbers(column)
    names = np.asarray(table.columns[column]).astype(str)
    extractor = _extractor(settings)
    spots = np.full((len(names), 2), np.nan)
    flags, colours, clipped = Counter[str](), 0, 0
    size: tuple[int, ...] | None = None
    for at, name in enumerate(names):
        place = f"{table.source}, row {table.rows[at]}"
        frame, coloured = _frame(directory, name, place)
        if size is not None and frame.shape != size:
            raise TableError(
                f"{place}: expected a picture of {_words(size)}, as those before it; got "
                f"{_words(frame.shape)}"
            )
        size = frame.shape
        colours += coloured
        clipped += _clipped(frame)
        found = extractor.measure(frame)
        spots[at] = found.features[0]
        flags.update(
            str(flag.name).lower().replace("_", " ") for flag in QualityFlag(found.flags[0])
        )
        tick(at + 1, len(names))
    said = [f"{len(names)} frames were read by {settings.readings.extractor}"]
    if colours:
        said.append(f"{colours} frames in colour were read by their luminance")
    if clipped:
        said.append(
            f"{clipped} frames may be saturated: many pixels of the light share the largest value"
        )
    said += [f"{count} frames: {name}" for name, count in sorted(flags.items())]
    columns = {**table.columns, **dict(zip(SPOT, spots.T, strict=True))}
    return replace(table, columns=columns), said


def of_spots(settings: Settings) -> Settings:
    """Return the settings of a table that `with_spots` gave."""
    readings = ReadingsSettings(kind="spot", columns=SPOT)
    return settings.model_copy(update={"readings": readings})


def _extractor(settings: Settings) -> Any:
    known = {
        name: cls
        for name, cls in discover_extractors().items()
        if cls.about.observation == "frames" and cls.about.kind is FeatureKind.SPOT
    }
    name = settings.readings.extractor
    if name not in known:
        raise SettingsError(
            f"readings.extractor: expected one that finds a spot in frames "
            f"({', '.join(sorted(known))}); got {name!r}"
        )
    try:
        return known[name].for_sensor(settings.sensor.geometry())
    except UnsuitableDesignError as error:
        raise SettingsError(f"readings.extractor: {error}") from None


def _frame(directory: Path, name: str, place: str) -> tuple[NDArray[np.generic], bool]:
    """Return a picture as grey levels (H, W), and whether it was one in colour."""
    import cv2  # noqa: PLC0415 - OpenCV, where there are pictures

    try:
        path = (directory / name).resolve()
        nowhere = path.is_symlink()  # links in a circle, which Python 3.13 gives back
    except (OSError, RuntimeError, ValueError):  # and 3.11 refuses; null characters
        nowhere = True
    if nowhere:
        raise TableError(f"{place}: expected a picture; got no file {name[:60]!r}")
    if not name.strip() or not path.is_relative_to(directory.resolve()):
        raise TableError(f"{place}: expected a picture in {directory.name}; got {name[:60]!r}")
    try:
        data = read_bytes(path, _LARGEST_PICTURE)
    except FileNotFoundError:
        raise TableError(f"{place}: there is no picture {name[:60]!r}") from None
    except FileRefusedError as error:
        raise TableError(f"{place}: {error.reason}") from None
    size = picture_size(data)
    if size is not None and size[0] * size[1] > _MOST_PIXELS:
        most = f"expected a picture of at most {_MOST_PIXELS} pixels"
        raise TableError(f"{place}: {most}; got {_words(size[::-1])}")
    picture = None
    with suppress(cv2.error, MemoryError):
        if size is not None:
            picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise TableError(f"{place}: expected a PNG, TIFF, BMP or JPEG picture; got {name[:60]!r}")
    if picture.ndim == 2:
        return picture, False
    colours = picture[:, :, :3]
    # of three equal colours each is the luminance
    grey = bool((colours == colours[:, :, :1]).all())
    return (colours[:, :, 0] if grey else _luminance(colours)), True


def _clipped(frame: NDArray[np.generic]) -> bool:
    """Say whether many of the pixels of the light share the largest value."""
    levels = np.asarray(frame, dtype=np.float64)
    largest = float(levels.max())
    count = int((levels == largest).sum())
    lit = int((levels > (largest + float(np.median(levels))) / 2.0).sum())
    return count >= _FEWEST_CLIPPED and count > _SHARE_CLIPPED * lit


def _words(shape: tuple[int, ...]) -> str:
    return f"{shape[1]} x {shape[0]} pixels"


def _luminance(colours: NDArray[np.generic]) -> Floats:
    """Luminance (H, W) of blue, green and red (H, W, 3): ITU-R BT.601, not rounded."""
    return np.asarray(colours @ np.array([0.114, 0.587, 0.299]))
