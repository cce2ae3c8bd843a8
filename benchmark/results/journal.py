"""A runner's journal: a line of JSON for each thing measured, on disk before more is awaited.

Each line ends with a digest of itself and of the digest before it, so that one that was changed,
taken out, doubled or moved is named by its number. A line torn by a kill, at the end, is dropped;
whole lines lost there cannot be distinguished from a run that ended sooner, and are measured again.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from benchmark.results.csv_tables import StoreError
from files.reading import FileRefusedError, parse_json, read_bytes

_LARGEST = 2_000_000_000
_CHAIN = re.compile(rb'(.*), "chain": "([0-9a-f]{16})"\}', re.DOTALL)


class Journal:
    """The journal at a path.

    Attributes
    ----------
    path
        Of the file; it need not be there.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._last = ""

    def read(self) -> list[tuple[int, Any]]:
        """Return (number of the line, record) of every whole line.

        Raises
        ------
        StoreError
            For what is no such file, and naming the first line that no runner wrote there.
        """
        self._last = ""
        return [
            (number, self._read(line, number))
            for number, line in enumerate(self._whole_lines().splitlines(), start=1)
        ]

    def append(self, records: Iterable[Mapping[str, Any]]) -> None:
        """Add records, after what was read or appended last; on return they survive a power cut."""
        text, last = "", self._last
        for record in records:
            line, last = chain_rows(json.dumps(record, allow_nan=False), last)
            text += f"{line}\n"
        self.path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with self.path.open("ab") as file:
                file.write(text.encode())
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:  # of a full disk names no file
            raise OSError(error.errno, error.strerror, str(self.path)) from error
        self._last = last

    def cut_torn(self) -> None:
        """Cut off a line that a kill left half written."""
        if self.path.is_file():
            os.truncate(self.path, len(self._whole_lines()))

    def remove(self) -> None:
        """Forget all of it."""
        self.path.unlink(missing_ok=True)
        self._last = ""

    def _read(self, line: bytes, number: int) -> Any:
        where = f"{self.path}, line {number}"
        try:
            record = parse_json(line.decode("utf-8"), self.path)
        except FileRefusedError as error:
            raise StoreError(f"{where}: {error.reason}") from error
        except UnicodeDecodeError as error:
            raise StoreError(f"{where}: not UTF-8 text") from error
        found = _CHAIN.fullmatch(line)
        if found is None or not isinstance(record, dict):
            raise StoreError(
                f"{where}: not a record of the journal, it has no digest at its end; remove the "
                "file if an earlier version wrote it: what it holds is measured again"
            )
        _, chain = chain_rows(f"{found[1].decode()}}}", self._last)
        if chain != found[2].decode():
            raise StoreError(
                f"{where}: not as a runner wrote it, or not after the line before it; remove the "
                "file: what it holds is measured again"
            )
        self._last = chain
        del record["chain"]
        return record

    def _whole_lines(self) -> bytes:
        try:
            content = read_bytes(self.path, _LARGEST)
        except FileNotFoundError:
            return b""
        except FileRefusedError as error:
            raise StoreError(str(error)) from error
        return content[: content.rfind(b"\n") + 1]


def chain_rows(text: str, before: str) -> tuple[str, str]:
    """Return a line of JSON with its digest, and the digest.

    Parameters
    ----------
    text
        The record: an object as JSON.
    before
        Digest of the line before; empty for the first.
    """
    chain = hashlib.sha256(f"{before}{text}".encode()).hexdigest()[:16]
    return f'{text[:-1]}, "chain": "{chain}"}}', chain
