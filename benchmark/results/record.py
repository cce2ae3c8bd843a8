"""A store open for writing: everything it holds, and a journal of what is measured.

What is measured is in the journal before more is awaited, so that a killed run loses only what
was in flight; the store's files are written once, at the end. A line torn by a kill is dropped
when the journal is read and cut off before more is appended. One process writes at a time.
"""

from __future__ import annotations

import binascii
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, TypeVar

from benchmark.contract import Cell
from benchmark.datasets.pins import Pin, Place
from benchmark.results import record_manifest
from benchmark.results.components import Components, ComponentsError
from benchmark.results.csv_tables import Row, StoreError
from benchmark.results.samples import CellErrors, Directions, SampleErrors
from benchmark.results.store import Store
from files.locks import LockedError, lock_or_refuse
from files.reading import FileRefusedError, parse_json, read_bytes

_What = TypeVar("_What")


class StoreLockedError(LockedError):
    """Another runner is writing to the store."""

    def __init__(self, holder: str, store: Path) -> None:
        super().__init__(
            holder,
            store,
            f"another runner ({holder}) is writing to {store}; wait for it or use another store",
        )


def _everything(_what: object) -> bool:
    return True


class Record:
    """Numbers by what they are of, each with the key of the components it was measured with.

    `errors` is what the journal holds sample by sample; the rest stays on disk.
    """

    def __init__(self, store: Store) -> None:
        self.store = store
        self.journal = store.work_directory / "journal.jsonl"
        self._journal = Journal(self.journal)
        self._components = store.components()
        self.scores: dict[Cell, Row] = store.scores()
        self.pins: dict[Place, Pin] = store.pins()
        self.errors = SampleErrors()
        known, unfinished = self._components, record_manifest.is_unfinished(store.directory)
        self._score_keys = _keys(self.scores, known.cell_key, unfinished=unfinished)
        self._pin_keys = _keys(
            self.pins, lambda place: known.pin_key(*place[:2]), unfinished=unfinished
        )
        self._changed = False
        self._read_journal()

    def is_scored(self, cell: Cell, components: Components) -> bool:
        """Say whether a cell's score is of these components, and no failure."""
        return (
            self._score_keys.get(cell) == components.cell_key(cell)
            and self.scores[cell]["status"] != "failed"
        )

    def why_outdated(self, cell: Cell, components: Components) -> tuple[str, ...]:
        """Say why a cell's score is not of these components; empty where it is.

        ``("new",)`` without a score, ``("failed",)`` for one that failed, else those of
        `benchmark.results.components.KEYED` that have changed since.
        """
        if cell not in self._score_keys:
            return ("new",)
        changed = components.changed_parts(self._score_keys[cell], cell)
        if not changed and self.scores[cell]["status"] == "failed":
            return ("failed",)
        return changed

    def is_pinned(self, place: Place, components: Components) -> bool:
        """Say whether a split's pin is of these components."""
        return self._pin_keys.get(place) == components.pin_key(*place[:2])

    def keep(
        self,
        components: Components,
        *,
        pins: Iterable[Pin] = (),
        scores: Mapping[Cell, Row] | None = None,
        errors: Mapping[Cell, CellErrors] | None = None,
        directions: Mapping[str, Directions] | None = None,
    ) -> None:
        """Take in what was measured with these components; on return it survives a power cut.

        `errors` are of cells in `scores`, sample by sample (`benchmark.results.samples`),
        `directions` the samples that they are of, by data set.
        """
        records: list[Row] = [
            {"pin": asdict(pin), "key": components.pin_key(*pin.place[:2])} for pin in pins
        ]
        records += [
            {"cell": asdict(cell), "score": row, "key": components.cell_key(cell)}
            for cell, row in (scores or {}).items()
        ]
        records += [
            {"errors_of": asdict(cell), **found.to_texts()}
            for cell, found in (errors or {}).items()
        ]
        records += [
            {"directions_of": name, **known.to_texts()}
            for name, known in (directions or {}).items()
        ]
        if not records:
            return
        self._journal.append(records)
        for record in records:
            self._take(record, str(self.journal))

    def drop(
        self,
        *,
        scores: Callable[[Cell], bool] = _everything,
        pins: Callable[[Place], bool] = _everything,
    ) -> None:
        """Forget what is no longer wanted: each function says what is, everything by default."""
        before = len(self.scores), len(self.pins)
        self.scores = {cell: row for cell, row in self.scores.items() if scores(cell)}
        self.pins = {place: pin for place, pin in self.pins.items() if pins(place)}
        self._changed |= before != (len(self.scores), len(self.pins))

    def write(self, components: Components) -> None:
        """Write the store's files and forget the journal.

        What was measured with other components than these is left out, where these say anything
        of it: code that has changed since cannot vouch for it. The others stay as they were.
        """
        known = self._components.update(components)
        scores = {
            cell: row
            for cell, row in self.scores.items()
            if self._score_keys[cell] == known.cell_key(cell)
        }
        pins = [
            pin
            for place, pin in self.pins.items()
            if self._pin_keys[place] == known.pin_key(*place[:2])
        ]
        datasets = {cell.dataset for cell in scores} | {pin.dataset for pin in pins}
        used = replace(
            known.only(scores),
            datasets={name: one for name, one in known.datasets.items() if name in datasets},
        )
        if self._changed or used != self._components:
            # Scores last: while they are the old ones, the next call does all of it again.
            self.errors.write(
                self.store.directory,
                lambda cell: cell in scores and scores[cell]["status"] == "ok",
            )
            self.store.write(scores, pins, used)
        self._journal.remove()

    def cut_torn(self) -> None:
        """Cut off what a kill left half written at the journal's end."""
        self._journal.cut_torn()

    def _read_journal(self) -> None:
        for number, record in self._journal.read():
            self._take(record, f"{self.journal}, line {number}")

    def _take(self, record: Any, where: str) -> None:
        self._changed = True
        try:
            if self._took_errors(record):
                return
            fields, key = set(record), record["key"]
            if fields == {"pin", "key"}:
                pin = Pin(**record["pin"])
                self.pins[pin.place], self._pin_keys[pin.place] = pin, key
            elif fields == {"cell", "score", "key"}:
                cell = Cell(**record["cell"])
                self.scores[cell], self._score_keys[cell] = record["score"], key
            else:
                raise StoreError(f"{where}: not a record of the journal; fields {sorted(fields)}")
        except (TypeError, KeyError, binascii.Error) as error:
            raise StoreError(f"{where}: not a record of the journal ({error!r})") from error

    def _took_errors(self, record: Any) -> bool:
        """Take in a record of errors or of directions; return whether it is one."""
        if "errors_of" in record:
            self.errors.keep(Cell(**record["errors_of"]), CellErrors.read(record))
        elif "directions_of" in record:
            self.errors.directions[record["directions_of"]] = Directions.read(record)
        else:
            return False
        return True


@contextmanager
def open_record(store: Store) -> Iterator[Record]:
    """Hold a store for writing; released by the system when the process ends, however it ends.

    A write that a killed runner left is finished where only its end is missing. StoreLockedError,
    at once, when another process holds it; StoreError, ComponentsError for a broken file.
    """
    directory = store.work_directory
    directory.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        try:
            stack.enter_context(lock_or_refuse(directory / "store"))
        except LockedError as error:
            raise StoreLockedError(error.holder, store.directory) from error
        record_manifest.finish(store.directory)
        record_manifest.require_unchanged(store.directory)
        record = Record(store)
        record.cut_torn()
        yield record


def _keys(
    numbers: dict[_What, Any], key_of: Callable[[_What], Any], *, unfinished: bool
) -> dict[_What, Any]:
    """Return the key of each number; those without are forgotten where a write is unfinished.

    Components are written last. The journal has what was written before them, too.
    """
    found = {}
    for what in list(numbers):
        try:
            found[what] = key_of(what)
        except ComponentsError:
            if not unfinished:
                raise
            del numbers[what]
    return found


_LARGEST = 2_000_000_000


class Journal:
    """A line of JSON for each thing measured, in a file that need not be there."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def read(self) -> Iterator[tuple[int, Any]]:
        """Yield (number of the line, record) of every whole line; StoreError for what is none."""
        for number, line in enumerate(self._whole_lines().splitlines(), start=1):
            where = f"{self.path}, line {number}"
            try:
                record = parse_json(line.decode("utf-8"), self.path)
            except FileRefusedError as error:
                raise StoreError(f"{where}: {error.reason}") from error
            except UnicodeDecodeError as error:
                raise StoreError(f"{where}: not UTF-8 text") from error
            if not isinstance(record, dict):
                raise StoreError(f"{where}: not a record of the journal")
            yield number, record

    def append(self, records: Iterable[Mapping[str, Any]]) -> None:
        """Add records; on return they survive a power cut."""
        text = "".join(f"{json.dumps(record, allow_nan=False)}\n" for record in records)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with self.path.open("ab") as file:
                file.write(text.encode())
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:  # of a full disk names no file
            raise OSError(error.errno, error.strerror, str(self.path)) from error

    def cut_torn(self) -> None:
        """Cut off a line that a kill left half written."""
        if self.path.is_file():
            os.truncate(self.path, len(self._whole_lines()))

    def remove(self) -> None:
        """Forget all of it."""
        self.path.unlink(missing_ok=True)

    def _whole_lines(self) -> bytes:
        try:
            content = read_bytes(self.path, _LARGEST)
        except FileNotFoundError:
            return b""
        except FileRefusedError as error:
            raise StoreError(str(error)) from error
        return content[: content.rfind(b"\n") + 1]
