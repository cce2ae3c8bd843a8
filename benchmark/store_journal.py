"""Progress of a runner, safe against being killed: append, flush, sync; and one runner a store.

A journal line is one finished cell (score and run) or one pinned split. A last line torn by a kill
is dropped when the journal is read and cut off before more is appended.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path

from benchmark.content_key import canonical_json
from benchmark.plan import Cell
from benchmark.store import Pin, Row, Store, StoreError, cell_of, pin_of


class StoreLockedError(RuntimeError):
    """Another runner is writing to the store."""


@dataclass
class Progress:
    """What a store and its journal hold together."""

    rows: dict[Cell, Row] = field(default_factory=dict)
    runs: dict[str, Row] = field(default_factory=dict)
    pins: dict[tuple[str, str, str], Pin] = field(default_factory=dict)

    def add(self, record: Row, where: str) -> None:
        """Take in one journal record; StoreError naming `where` for an unknown one."""
        if set(record) == {"pin"}:
            pin = pin_of(record["pin"], where)
            self.pins[pin.place] = pin
        elif set(record) == {"score", "run"}:
            self.rows[cell_of(record["score"])] = record["score"]
            self.runs[record["run"]["key"]] = record["run"]
        else:
            raise StoreError(f"{where}: not a journal record; found fields {sorted(record)}")


class Journal:
    """Append-only record of finished cells beside a store. Use within `locked(store)`."""

    def __init__(self, store: Store) -> None:
        self.path = store.work_directory / "journal.jsonl"
        self._store = store

    def progress(self) -> Progress:
        """Everything stored, journal included."""
        store = self._store
        progress = Progress({cell_of(row): row for row in store.rows()}, store.runs(), store.pins())
        whole = _whole_lines(self.path.read_bytes() if self.path.is_file() else b"")
        for number, line in enumerate(whole.splitlines(), start=1):
            where = f"{self.path}, line {number}"
            try:
                record = json.loads(line)
            except ValueError as error:
                raise StoreError(f"{where}: not JSON ({error})") from error
            progress.add(record, where)
        return progress

    def append(self, pins: Iterable[Pin], finished: Iterable[tuple[Row, Row]]) -> None:
        """Record pins and (score, run) pairs; on return they survive a power cut."""
        records: list[object] = [{"pin": asdict(pin)} for pin in pins]
        records += [{"score": score, "run": run} for score, run in finished]
        text = "".join(canonical_json(record) + "\n" for record in records)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab") as file:
            file.write(text.encode())
            file.flush()
            os.fsync(file.fileno())

    def cut_torn_line(self) -> None:
        """Remove an unfinished last line, so that the next record starts on its own."""
        if self.path.is_file():
            content = self.path.read_bytes()
            whole = _whole_lines(content)
            if len(whole) < len(content):
                os.truncate(self.path, len(whole))

    def exists(self) -> bool:
        """Whether there is anything that the store's files do not hold yet."""
        return self.path.is_file()

    def remove(self) -> None:
        """Forget the journal, once its content is in the store's files."""
        self.path.unlink(missing_ok=True)


@contextmanager
def locked(store: Store) -> Iterator[None]:
    """Hold the store for writing; released by the system when the process ends, however it ends.

    Raises
    ------
    StoreLockedError
        At once, when another process holds it.
    """
    path: Path = store.work_directory / "lock"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a+") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            file.seek(0)
            raise StoreLockedError(
                f"another runner (process {file.read().strip() or 'unknown'}) is writing to "
                f"{store.directory}; wait for it or use another store"
            ) from error
        file.seek(0)
        file.truncate()
        file.write(str(os.getpid()))
        file.flush()
        yield


def _whole_lines(content: bytes) -> bytes:
    return content[: content.rfind(b"\n") + 1]
