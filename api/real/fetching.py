"""Fetching a public set of real readings by address and checksum."""

from __future__ import annotations

import hashlib
import http.client
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from threading import Thread
from urllib.error import URLError
from urllib.request import Request, urlopen

import numpy as np
from numpy.typing import NDArray

from api.real.sets import RealSet, Source
from files.atomic import replace_file

#: Most bytes of a file, and seconds for it.
_LARGEST, _LONGEST_S = 50_000_000, 60.0


class FetchError(ValueError):
    """A file that was not to be had, or is another than the one that is known."""


def fetch(
    real: RealSet, directory: Path, download: Callable[[str], bytes] | None = None
) -> list[Path]:
    """Write a set's files, its licence and its citation to a directory; returns their paths.

    Parameters
    ----------
    real : RealSet
    directory : Path
        Made where it does not exist.
    download : callable, optional
        Returns the bytes at an address; by default over HTTPS.

    Raises
    ------
    FetchError
        If a file cannot be reached, or its SHA-256 is another; nothing is written then.
    """
    get = download or _download
    texts: dict[str, str] = {}
    for source in real.sources:
        data = get(real.address + source.path)
        found = hashlib.sha256(data).hexdigest()
        if found != source.sha256:
            raise FetchError(
                f"{real.address}{source.path}: expected SHA-256 {source.sha256}; got {found}"
            )
        texts[source.written] = _text(data, source)
    texts["CITATION.txt"] = (
        f"{real.about}\n\nLicence: {real.licence}\nCitation: {real.citation}\n"
        f"Address: {real.address}\nConverted to CSV, nothing left out.\n"
    )
    directory.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        replace_file(directory / name, text)
    return [directory / name for name in texts]


def _text(data: bytes, source: Source) -> str:
    if not source.blocks:
        return data.decode("utf-8")
    columns: dict[str, NDArray[np.float64]] = {}
    for block in source.blocks:
        count = len(block.columns) * block.rows
        numbers = np.frombuffer(data, "<f8", count, block.offset).reshape(-1, block.rows)
        columns |= dict(zip(block.columns, numbers, strict=True))
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(repr(float(v)) for v in row) for row in rows)]
    return "\n".join(lines) + "\n"


def _download(address: str) -> bytes:
    """Return what stands at an address; in a thread, as each byte of a server may be waited for."""
    answered = Future[bytes]()

    def read() -> None:
        try:
            answered.set_result(_read(address))
        except BaseException as error:  # noqa: BLE001 - raised where it is waited for
            answered.set_exception(error)

    Thread(target=read, daemon=True).start()
    try:
        return answered.result(_LONGEST_S)
    except TimeoutError:
        raise FetchError(f"{address}: expected a whole answer within {_LONGEST_S:g} s") from None


def _read(address: str) -> bytes:
    if not address.startswith("https://"):
        raise FetchError(f"{address}: expected an address of https")
    try:
        with urlopen(Request(address), timeout=_LONGEST_S) as reply:  # noqa: S310 - https alone
            data = bytes(reply.read(_LARGEST + 1))
    except (URLError, OSError, http.client.HTTPException) as error:
        raise FetchError(f"{address}: {error}") from None
    if len(data) > _LARGEST:
        raise FetchError(f"{address}: expected at most {_LARGEST} bytes; got more")
    return data
