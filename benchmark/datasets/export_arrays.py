"""Arrays of a dataset as files: NumPy archives that are the same bytes each time, and CSV."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmark.datasets.samples import Samples
from files.csv_writing import csv_text

Arrays = Mapping[str, NDArray[Any]]

#: Before this no zip file can be; every archive is dated so, or the same data were other bytes.
_DATE = (1980, 1, 1, 0, 0, 0)
#: Noise hardly compresses; more effort gains a few per cent for several times the time.
_EFFORT = 1


def write_archive(path: Path, arrays: Arrays) -> None:
    """Write arrays as a compressed ``.npz``, which `numpy.load` reads without pickle."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=_EFFORT) as archive:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(f"{name}.npy", _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, on every machine, for the permissions below
            entry.external_attr = 0o100644 << 16
            with archive.open(entry, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)


def read_archive(path: Path) -> dict[str, NDArray[Any]]:
    """Read every array of an ``.npz``.

    ValueError where the file is no archive of arrays.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except (OSError, EOFError, zipfile.BadZipFile, ValueError, AttributeError) as error:
        raise ValueError(f"{path}: not an archive of arrays ({error})") from error


def samples_of(arrays: Arrays) -> Samples:
    """Return the samples that the arrays of a split are, as its data set made them."""
    context = {
        name.removeprefix("context."): array
        for name, array in arrays.items()
        if name.startswith("context.")
    }
    return Samples(
        arrays["observations"],
        arrays["sun"],
        arrays.get("origin_px"),
        context or None,
        arrays.get("true_sun"),
    )


def columns_of(arrays: Arrays) -> dict[str, NDArray[Any]]:
    """Return one array (N,) a column of the table; a vector is several.

    Components of a Sun vector and of other vectors of three are named x, y and z, those of the
    observations are numbered from 1 as ``signal_<k>``.
    """
    found: dict[str, NDArray[Any]] = {}
    for name, array in arrays.items():
        if array.ndim == 1:
            found[name] = array
            continue
        if name == "observations":
            parts = [f"signal_{k}" for k in range(1, array.shape[1] + 1)]
        elif array.shape[1] == 3:
            parts = [f"{name}_{axis}" for axis in "xyz"]
        else:
            parts = [f"{name}_{k}" for k in range(1, array.shape[1] + 1)]
        found.update(zip(parts, array.T, strict=True))
    return found


def table_text(arrays: Arrays) -> str:
    """Spell arrays (N,) and (N, K) as CSV with a header; every number reads back the same."""
    columns = columns_of(arrays)
    # tolist gives Python's numbers, whose text is the shortest that reads back the same
    rows = zip(*(array.tolist() for array in columns.values()), strict=True)
    return csv_text(list(columns), rows)


def write_table(path: Path, arrays: Arrays) -> None:
    """Write arrays as `table_text` spells them."""
    path.write_text(table_text(arrays), "utf-8", newline="\n")
