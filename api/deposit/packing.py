"""The zip of a bundle, and whether a zip is that of a bundle to the last byte.

All of such a zip but the compressed bytes follows from the files that it holds, so that it is
checked by what it has to be: no entry, name, attribute, comment or byte between entries that
`pack` would not write. What the compressed bytes unpack to is compared with the files; other
releases of zlib may pack the same otherwise.
"""

from __future__ import annotations

import struct
import zipfile
import zlib
from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import IO

from benchmark.datasets.checksums import contents

# APPNOTE.TXT 6.3.10, 4.3.7, 4.3.12 and 4.3.16
_LOCAL = struct.Struct("<4s5H3L2H")
_CENTRAL = struct.Struct("<4s6H3L5H2L")
_END = struct.Struct("<4s4H2LH")
_FIELDS = ("version", "flags", "method", "time", "date", "crc", "packed", "size", "name", "extra")
_CENTRAL_FIELDS = (
    *("signature", "system", "version", "flags", "method", "time", "date", "crc", "packed", "size"),
    *("name length", "extra length", "comment length", "disk", "internal attributes"),
    *("attributes", "offset"),
)
_VERSION, _UNIX, _PLAIN_FILE = 20, 3 << 8, 0o100644 << 16
_ENCRYPTED, _UTF8 = 1, 0x800
_STORED, _DEFLATED = 0, 8
_CHUNK = 1 << 16


class PackingError(ValueError):
    """A bundle cannot be packed, or a zip is not that of a bundle; the message says where."""


def pack(bundle: Path, target: Path, top: str, released: date) -> None:
    """Pack a bundle; the same bytes each time, with one zlib.

    Parameters
    ----------
    bundle : its directory
    target : the zip to write
    top : the one directory in the zip, which holds all
    released : date of every entry

    Raises
    ------
    PackingError
        For a bundle of 4 GiB or more.
    """
    moment = (released.year, released.month, released.day, 0, 0, 0)
    try:
        with zipfile.ZipFile(target, "w", allowZip64=False) as archive:
            for name in contents(bundle):
                entry = zipfile.ZipInfo(f"{top}/{name}", moment)
                entry.create_system = _UNIX >> 8  # on every machine, for the permissions below
                entry.external_attr = _PLAIN_FILE
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, (bundle / name).read_bytes(), compresslevel=9)
    except zipfile.LargeZipFile as error:
        raise PackingError(f"{bundle}: too large for a zip; expected less than 4 GiB") from error


def check(packed: Path, bundle: Path, top: str, released: date) -> None:
    """Hold a zip against the directory that it should be of; parameters as of `pack`.

    Raises
    ------
    PackingError
        At the first byte that differs, with what came and what was expected.
    """
    moment = (0, (released.year - 1980) << 9 | released.month << 5 | released.day)
    directory = b""
    with packed.open("rb") as file:
        names = contents(bundle)
        for number, name in enumerate(names, start=1):
            where = f"entry {number} of {len(names)}"
            directory += _checked_entry(file, where, f"{top}/{name}", bundle / name, moment)
        start = file.tell()
        found = file.read(len(directory))
        if found[:4] == b"PK\3\4":
            length = _LOCAL.unpack_from(found)[_FIELDS.index("name") + 1]
            name = found[_LOCAL.size : _LOCAL.size + length].decode("utf-8", "backslashreplace")
            raise PackingError(f"it has a further entry, {name[:120]!r}; expected {len(names)}")
        if found != directory:
            raise PackingError(_unlike(found, directory, len(names)))
        count = len(names)
        end = _END.pack(b"PK\5\6", 0, 0, count, count, len(directory), start, 0)
        found = file.read(len(end))
        if found != end:
            raise PackingError(
                f"its end record differs from that of {count} entries without a comment: "
                f"{found.hex()}, expected {end.hex()}"
            )
        if file.read(1):
            raise PackingError("it goes on behind its end; expected no further byte")


def _checked_entry(
    file: IO[bytes], where: str, name: str, path: Path, moment: tuple[int, int]
) -> bytes:
    """Check the entry at the place of a file; return what the zip's directory has to say of it."""
    offset, size = file.tell(), path.stat().st_size
    head = file.read(_LOCAL.size)
    if len(head) < _LOCAL.size or head[:4] != b"PK\3\4":
        raise PackingError(f"{where}: no entry begins at byte {offset}; expected {name}")
    found = dict(zip(_FIELDS, _LOCAL.unpack(head)[1:], strict=True))
    text = file.read(found["name"]).decode("utf-8", "backslashreplace")
    if text != name:
        raise PackingError(f"{where} is {text[:120]!r}, expected {name!r}")
    if found["flags"] & _ENCRYPTED:
        raise PackingError(f"{where}, {name}, is encrypted; expected that it is not")
    if found["method"] not in {_STORED, _DEFLATED}:
        raise PackingError(
            f"{where}, {name}, is packed by method {found['method']}; expected "
            f"{_DEFLATED} (deflate) or {_STORED} (as it is)"
        )
    encoded = name.encode()
    expected = {
        "version": _VERSION,
        "flags": 0 if encoded.isascii() else _UTF8,
        "time": moment[0],
        "date": moment[1],
        "size": size,
        "extra": 0,
    }
    for field, value in expected.items():
        if found[field] != value:
            raise PackingError(f"{where}, {name}: {field} is {found[field]}, expected {value}")
    crc = _compare(file, found["packed"], found["method"], path, f"{where}, {name}")
    if found["crc"] != crc:
        raise PackingError(f"{where}, {name}: crc is {found['crc']:08x}, expected {crc:08x}")
    values = (found[field] for field in _FIELDS[:-2])
    central = (b"PK\1\2", _UNIX | _VERSION, *values, len(encoded), 0, 0, 0, 0, _PLAIN_FILE, offset)
    return _CENTRAL.pack(*central) + encoded


def _compare(file: IO[bytes], packed: int, method: int, path: Path, what: str) -> int:
    """Compare what an entry unpacks to with a file; return the CRC-32 of both."""
    crc = 0
    with path.open("rb") as other:
        for piece in _unpack(file, packed, method, what):
            if piece != other.read(len(piece)):
                raise PackingError(f"{what}, unpacks to other bytes than the bundle has")
            crc = zlib.crc32(piece, crc)
        if other.read(1):
            raise PackingError(f"{what}, ends before the file of the bundle does")
    return crc


def _unpack(file: IO[bytes], packed: int, method: int, what: str) -> Iterator[bytes]:
    """Unpack so many bytes, a small piece at a time."""
    unpacker = zlib.decompressobj(-zlib.MAX_WBITS)
    while packed:
        chunk = file.read(min(packed, _CHUNK))
        if not chunk:
            raise PackingError(f"{what}, is cut short: {packed} bytes are missing")
        packed -= len(chunk)
        if method == _STORED:
            yield chunk
            continue
        try:
            while chunk and not unpacker.eof:
                yield unpacker.decompress(chunk, _CHUNK)
                chunk = unpacker.unconsumed_tail
        except zlib.error as error:
            raise PackingError(f"{what}, cannot be unpacked ({error})") from error
        if chunk or unpacker.unused_data:
            raise PackingError(f"{what}, has bytes behind the end of what is packed")
    if method == _DEFLATED and not unpacker.eof:
        raise PackingError(f"{what}, is cut short: what is packed does not end")


def _unlike(found: bytes, expected: bytes, count: int) -> str:
    """Say at which entry the directory of a zip differs from what its entries make it."""
    pairs = zip(found, expected, strict=False)
    at = next((i for i, (a, b) in enumerate(pairs) if a != b), None)
    if at is None:
        return f"it is cut short: {len(expected) - len(found)} bytes of its directory are missing"
    place = number = 0
    while (end := place + _CENTRAL.size + _name_length(expected, place)) <= at:
        place, number = end, number + 1
    name = expected[place + _CENTRAL.size : end].decode()
    here, there = (
        _CENTRAL.unpack_from(text.ljust(end, b"\0"), place) for text in (found, expected)
    )
    for field, came, wanted in zip(_CENTRAL_FIELDS, here, there, strict=True):
        if came != wanted:
            what = f"{field} is {came}, expected {wanted}"
            break
    else:
        what = f"name is {found[place + _CENTRAL.size : end].decode('utf-8', 'backslashreplace')!r}"
    return f"its directory differs from entry {number + 1} of {count}, {name}: {what}"


def _name_length(directory: bytes, place: int) -> int:
    return int(_CENTRAL.unpack_from(directory, place)[_CENTRAL_FIELDS.index("name length")])
