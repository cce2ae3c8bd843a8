"""A runner's journal: a line of JSON for each thing measured, on disk before more is awaited.

A line torn by a kill, at the end, is dropped.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from benchmark.results.csv_tables import StoreError
from files.reading import FileRefusedError, parse_json, read_bytes

_LARGEST = 2_000_000_000


class Journal:
    """The journal at a path.

    Attributes
    ----------
    path
        Of the file; it need not be there.
    """

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
