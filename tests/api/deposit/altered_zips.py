"""Zips that are not that of their bundle, each altered in one way."""

from __future__ import annotations

import struct
import unicodedata
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

TOP = "sun-sensor-atlas-0.1.0"
README = f"{TOP}/README.md"

Entries = list[tuple[zipfile.ZipInfo, bytes]]


def entries(path: Path) -> Entries:
    with zipfile.ZipFile(path) as archive:
        return [(entry, archive.read(entry)) for entry in archive.infolist()]


def write(path: Path, listed: Entries) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        for entry, content in listed:
            archive.writestr(entry, content, compresslevel=9)


def like(entry: zipfile.ZipInfo, name: str) -> zipfile.ZipInfo:
    """An entry of another name, in all else as this one."""
    made = zipfile.ZipInfo(name, entry.date_time)
    made.create_system, made.external_attr = entry.create_system, entry.external_attr
    made.compress_type = entry.compress_type
    return made


def rewritten(edit: Callable[[Entries], Entries]) -> Callable[[Path], None]:
    return lambda path: write(path, edit(entries(path)))


def renamed(name: str) -> Callable[[Path], None]:
    """README.md under another name."""
    return rewritten(
        lambda listed: [
            (like(e, name) if e.filename == README else e, content) for e, content in listed
        ]
    )


def added(
    name: str, content: bytes | None = None, *, first: bool = False
) -> Callable[[Path], None]:
    """One entry more; by default with what README.md holds."""

    def edit(listed: Entries) -> Entries:
        readme, held = next((e, c) for e, c in listed if e.filename == README)
        more = [(like(readme, name), held if content is None else content)]
        return [*more, *listed] if first else [*listed, *more]

    return rewritten(edit)


def top(listed: Entries) -> Entries:
    return [(like(e, f"other/{e.filename.partition('/')[2]}"), content) for e, content in listed]


def link(listed: Entries) -> Entries:
    for entry, _ in listed:
        if entry.filename == README:
            entry.external_attr = 0o120777 << 16
    return listed


def bytes_of(edit: Callable[[bytes], bytes]) -> Callable[[Path], None]:
    def alter(path: Path) -> None:
        path.write_bytes(edit(path.read_bytes()))

    return alter


def patched(
    local: tuple[int, str, int] | None, central: tuple[int, str, int] | None, name: str = README
) -> Callable[[Path], None]:
    """A field of the headers of an entry: (offset, struct format, value)."""

    def alter(path: Path) -> None:
        data = bytearray(path.read_bytes())
        encoded = name.encode()
        places = []
        at = data.find(encoded)
        while at >= 0:
            places.append(at)
            at = data.find(encoded, at + 1)
        for place, length, what in ((places[0], 30, local), (places[-1], 46, central)):
            if what is not None:
                struct.pack_into(f"<{what[1]}", data, place - length + what[0], what[2])
        path.write_bytes(data)

    return alter


def zip64(path: Path) -> None:
    """Sizes in an extra field that says so, true or not."""
    with zipfile.ZipFile(path) as archive:
        listed = [(e, archive.read(e)) for e in archive.infolist()]
    with zipfile.ZipFile(path, "w") as archive:
        for entry, content in listed:
            with archive.open(entry, "w", force_zip64=True) as file:
                file.write(content)


def streamed(path: Path) -> None:
    """Sizes behind the content, of which one is false."""
    data = path.read_bytes()
    where = data.find(README.encode())
    start = where - 30
    crc, packed, size = struct.unpack_from("<3L", data, start + 14)
    content = data[where + len(README) : where + len(README) + packed]
    head = bytearray(data[start : where + len(README)])
    struct.pack_into("<H", head, 6, 8)
    struct.pack_into("<3L", head, 14, 0, 0, 0)
    described = struct.pack("<4s3L", b"PK\x07\x08", crc, packed, size + 1)
    after = data[where + len(README) + packed :]
    path.write_bytes(data[:start] + bytes(head) + content + described + after)


def overlapping(path: Path) -> None:
    """Two entries of the directory that are one and the same in the file."""
    data = bytearray(path.read_bytes())
    first = data.find(b"PK\x01\x02")
    other = data.find(README.encode(), first)
    offset = struct.unpack_from("<L", data, other - 46 + 42)[0]
    struct.pack_into("<L", data, first + 42, offset)
    path.write_bytes(data)


def nested(path: Path) -> None:
    """A thousand times as much as there should be, in as many bytes."""
    bomb = path.with_name("bomb.zip")
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.zip", bytes(50 << 20))
    added(f"{TOP}/more.zip", bomb.read_bytes())(path)
    bomb.unlink()


def swollen(path: Path) -> None:
    """An entry of the bundle that unpacks to 50 MB."""
    write(path, [(e, bytes(50 << 20) if e.filename == README else c) for e, c in entries(path)])


def two_forms(path: Path) -> None:
    """Two names that are one where letters are composed."""
    for form in ("NFC", "NFD"):
        added(unicodedata.normalize(form, f"{TOP}/\u00e9.txt"), form.encode())(path)


def padded(path: Path) -> None:
    """Bytes between what is packed and its end: deflate ends before."""
    data = path.read_bytes()
    where = data.find(README.encode())
    packed = struct.unpack_from("<L", data, where - 30 + 18)[0]
    end = where + len(README) + packed
    made = bytearray(data[:end] + b"evil" + data[end:])
    struct.pack_into("<L", made, where - 30 + 18, packed + 4)
    path.write_bytes(made)


def thirteen() -> Mapping[str, Callable[[Path], None]]:
    """Return the alterations that a review of the client tried."""
    return {
        "../README.md": renamed("../README.md"),
        "an absolute name": renamed("/README.md"),
        "a duplicate, the first another": added(README, b"another", first=True),
        "another top folder": rewritten(top),
        "a link": rewritten(link),
        "bytes behind": bytes_of(lambda data: data + b"more"),
        "encrypted": patched((6, "H", 1), (8, "H", 1)),
        "an unknown compression": patched((8, "H", 99), (10, "H", 99)),
        "a file missing": rewritten(lambda listed: listed[1:]),
        "a file more": added(f"{TOP}/more.txt", b"more"),
        "another content": rewritten(
            lambda listed: [(e, b"x" if e.filename == README else c) for e, c in listed]
        ),
        "cut short": bytes_of(lambda data: data[:-30]),
        "a flipped byte": bytes_of(lambda data: data[:70] + bytes([data[70] ^ 1]) + data[71:]),
    }


def more() -> Mapping[str, Callable[[Path], None]]:
    """Return further alterations."""
    return {
        "../README.md beside": added(f"{TOP}/../README.md"),
        "a folder": added(f"{TOP}/folder/", b""),
        "another case": added(f"{TOP}/readme.md"),
        "two forms of a letter": two_forms,
        "a device": added(f"{TOP}/NUL.txt", b""),
        "a backslash": renamed(f"{TOP}\\README.md"),
        "a drive": renamed("C:/README.md"),
        "no top folder": renamed("README.md"),
        "an empty name": renamed(f"{TOP}/"),
        "a name cut by a null": patched((30, "B", 0), None),
        "two names for one entry": patched((30, "B", ord("t")), None),
        "ZIP64 without need": zip64,
        "a size of ZIP64": patched((22, "L", 0xFFFFFFFF), (24, "L", 0xFFFFFFFF)),
        "a size that is false": patched(None, (24, "L", 5)),
        "a checksum that is false": patched((14, "L", 5), (16, "L", 5)),
        "overlapping entries": overlapping,
        "a data descriptor that is false": streamed,
        "bytes before": bytes_of(lambda data: b"#!/bin/sh\n" + data),
        "a comment": bytes_of(lambda data: data[:-2] + b"\4\0evil"),
        "a comment of an entry": patched(None, (32, "H", 4)),
        "bytes behind what is packed": padded,
        "a bomb more": nested,
        "a bomb instead": swollen,
        "an executable": patched(None, (38, "L", 0o100755 << 16)),
        "another order": rewritten(lambda listed: listed[::-1]),
        "another date": rewritten(lambda listed: [(_later(e), content) for e, content in listed]),
        "nothing": bytes_of(lambda _: b""),
        "an empty zip": lambda path: write(path, []),
        "no zip": bytes_of(lambda data: bytes(len(data))),
        "spanned": bytes_of(lambda data: data[:-18] + b"\1\0\1\0" + data[-14:]),
    }


def _later(entry: zipfile.ZipInfo) -> zipfile.ZipInfo:
    entry.date_time = (2030, 1, 1, 0, 0, 0)
    return entry
