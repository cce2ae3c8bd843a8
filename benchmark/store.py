"""Results as plain files that live in git: accuracy, running times, hashes of data.

A store is a directory of canonical JSON Lines, one record a line, sorted:

- ``scores.jsonl``: one row a cell; depends on code and data only, never on time or machine.
- ``runs.jsonl``: how long each stored cell took, where, with which libraries; by the score's key.
- ``data.jsonl``: hash of each generated split, with the digest of the code that generated it.

A running runner keeps its progress in ``.sunatlas/journal.jsonl`` (`benchmark.store_journal`).
"""

from __future__ import annotations

import gc
import json
import os
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmark.content_key import SCHEMA_VERSION
from benchmark.plan import Cell

if TYPE_CHECKING:
    import pandas as pd

Row = dict[str, Any]
Filter = str | Collection[str] | None

PUBLISHED = Path(__file__).parent / "published"

_IDENTITY = ("key", "dataset", "condition", "extractor", "model", "status")


class StoreError(ValueError):
    """A stored file cannot be read; the message names file and line."""


class UnknownFieldError(LookupError):
    """A query names a field that results do not have; the message names the nearest."""


@dataclass(frozen=True)
class Pin:
    """Hash of one generated split, what it was generated from, and its bound.

    ``bound_deg`` is the Cramer-Rao bound of the test split, root mean square over the samples
    where the direction is observable; None for other splits and where there is no bound.
    """

    dataset: str
    condition: str
    split: str
    version: int
    specification: str
    data_hash: str
    n: int
    bound_deg: float | None = None

    @property
    def place(self) -> tuple[str, str, str]:
        """What the pin is for."""
        return (self.dataset, self.condition, self.split)


class Store:
    """Results in a directory; made on the first write.

    Parameters
    ----------
    directory
        Where the files are; the published results by default.
    """

    def __init__(self, directory: Path | str = PUBLISHED) -> None:
        self.directory = Path(directory)
        self.scores_path = self.directory / "scores.jsonl"
        self.runs_path = self.directory / "runs.jsonl"
        self.data_path = self.directory / "data.jsonl"
        self.work_directory = self.directory / ".sunatlas"

    def rows(self) -> list[Row]:
        """All stored score rows, sorted by dataset, condition, extractor and model.

        Raises
        ------
        StoreError
            On a line that is no JSON object, lacks an identifying field, repeats a cell, or was
            written under another schema version.
        """
        rows: dict[Cell, Row] = {}
        for number, row in _lines(self.scores_path):
            where = f"{self.scores_path}, line {number}"
            _check_row(row, where)
            cell = cell_of(row)
            if cell in rows:
                raise StoreError(f"{where}: {cell} is there twice")
            rows[cell] = row
        return [rows[cell] for cell in sorted(rows)]

    def runs(self) -> dict[str, Row]:
        """Return running times by key of the score they belong to."""
        found = {}
        for number, row in _lines(self.runs_path):
            if not isinstance(row.get("key"), str):
                raise StoreError(f"{self.runs_path}, line {number}: expected a field 'key'")
            found[row["key"]] = row
        return found

    def pins(self) -> dict[tuple[str, str, str], Pin]:
        """Pinned data by (dataset, condition, split)."""
        found = {}
        for number, row in _lines(self.data_path):
            pin = pin_of(row, f"{self.data_path}, line {number}")
            found[pin.place] = pin
        return found

    def query(self, **where: Filter) -> list[Row]:
        """Return the rows whose fields have one of the wanted values.

        ``query(dataset="x", model=["a", "b"])``; a filter of None is no filter.

        Raises
        ------
        UnknownFieldError
            For a field that no row has.
        """
        rows = self.rows()
        known = {name for row in rows for name in row} or set(_IDENTITY)
        wanted = {}
        for field, values in where.items():
            if field not in known:
                close = get_close_matches(field, sorted(known), n=1)
                hint = f"did you mean {close[0]!r}?" if close else f"known: {sorted(known)}"
                raise UnknownFieldError(f"results have no field {field!r}; {hint}")
            if values is not None:
                wanted[field] = {values} if isinstance(values, str) else set(values)
        return [row for row in rows if all(row.get(f) in some for f, some in wanted.items())]

    def frame(self, **where: Filter) -> pd.DataFrame:
        """`query(**where)` as a pandas frame, running times joined on where they are known."""
        import pandas as pd  # noqa: PLC0415 - half a second that most readers do not need

        runs = self.runs()
        extra = ("latency_us", "time_ratio")
        return pd.DataFrame(
            [
                {**row, **{name: runs.get(row["key"], {}).get(name) for name in extra}}
                for row in self.query(**where)
            ]
        )

    def write(self, rows: Iterable[Row], runs: Iterable[Row], pins: Iterable[Pin]) -> None:
        """Replace the three files, each whole or not at all; unchanged ones are left alone."""
        replace(self.scores_path, _text(sorted(rows, key=cell_of)))
        replace(self.runs_path, _text(sorted(runs, key=lambda run: (cell_of(run), run["key"]))))
        replace(self.data_path, _text(asdict(p) for p in sorted(pins, key=lambda p: p.place)))


def cell_of(row: Mapping[str, Any]) -> Cell:
    """Return the cell a stored row belongs to."""
    return Cell(row["dataset"], row["condition"], row["extractor"], row["model"])


def pin_of(row: Mapping[str, Any], where: str) -> Pin:
    """Return the pin a stored line holds; StoreError naming `where` otherwise."""
    try:
        return Pin(**row)
    except TypeError as error:
        raise StoreError(f"{where}: not a pin of data ({error})") from error


def replace(path: Path, text: str) -> bool:
    """Write a file whole or not at all; True when its content changed."""
    content = text.encode()
    if path.is_file() and path.read_bytes() == content:
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return True


@contextmanager
def collector_paused() -> Iterator[None]:
    """Stop looking for cycles while very many objects are made that all stay.

    With ten thousand rows that takes a quarter of the time of a call with nothing to measure.
    """
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _text(rows: Iterable[Row]) -> str:
    """Spell rows as `canonical_json` does; their values are plain, and rounded when made."""
    spell = json.JSONEncoder(
        sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    ).encode
    return "".join(spell(row) + "\n" for row in rows)


def _lines(path: Path) -> list[tuple[int, Row]]:
    if not path.is_file():
        return []
    found = []
    for number, line in enumerate(path.read_bytes().splitlines(), start=1):
        try:
            row = json.loads(line)
        except ValueError as error:
            raise StoreError(f"{path}, line {number}: not JSON ({error})") from error
        if not isinstance(row, dict):
            raise StoreError(
                f"{path}, line {number}: expected a JSON object, got {type(row).__name__}"
            )
        found.append((number, row))
    return found


def _check_row(row: Row, where: str) -> None:
    missing = [name for name in _IDENTITY if not isinstance(row.get(name), str)]
    if missing:
        raise StoreError(f"{where}: expected text in {', '.join(missing)}")
    if row.get("schema") != SCHEMA_VERSION:
        raise StoreError(
            f"{where}: written under schema {row.get('schema')!r}, this version reads "
            f"{SCHEMA_VERSION}; delete the file and run `sunatlas leaderboard`"
        )
