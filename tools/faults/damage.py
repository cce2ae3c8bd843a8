"""Ways to damage a file, drawn at random: bytes, lines, cells, JSON, what it is at all."""

from __future__ import annotations

import csv
import io
import json
import os
import random
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

Bytes = Callable[[random.Random, bytes], bytes]

WORDS = (
    *("nan", "NaN", "inf", "-inf", "1e999", "-1", "1_29", "0x10", "１２", ">0.1", "<0.1", "#N/A"),
    *("\ufffd", "", " ", "true", "text", "x" * 200_000, "(," * 40_000, "=1+1", "\x00", "0.1.2"),
)


def flip(rng: random.Random, data: bytes) -> bytes:
    at = rng.randrange(len(data))
    return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]


def truncate(rng: random.Random, data: bytes) -> bytes:
    return data[: len(data) - rng.choice((1, 2, rng.randrange(1, len(data))))]


def empty(_rng: random.Random, _data: bytes) -> bytes:
    return b""


def in_other_encoding(rng: random.Random, data: bytes) -> bytes:
    text = data.decode("utf-8", "replace")
    marks = (b"\xef\xbb\xbf" + data, text.encode("utf-16"), text.encode("utf-32"), b"\xff" + data)
    return rng.choice((*marks, data + "\ufffd".encode()))


def with_other_line_ends(_rng: random.Random, data: bytes) -> bytes:
    return data.replace(b"\n", b"\r\n")


def without_a_line(rng: random.Random, data: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    del lines[rng.randrange(len(lines))]
    return b"".join(lines)


def with_a_line_twice(rng: random.Random, data: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    at = rng.randrange(len(lines))
    return b"".join([*lines[: at + 1], *lines[at:]])


def header_alone(_rng: random.Random, data: bytes) -> bytes:
    return data.splitlines(keepends=True)[0]


def _rows(data: bytes) -> list[list[str]]:
    return list(csv.reader(io.StringIO(data.decode("utf-8"), newline="")))


def _spelt(rows: list[list[str]]) -> bytes:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode("utf-8", "surrogatepass")


def with_cells_swapped(rng: random.Random, data: bytes) -> bytes:
    rows = _rows(data)
    row = rng.choice(rows)
    one, other = rng.randrange(len(row)), rng.randrange(len(row))
    row[one], row[other] = row[other], row[one]
    return _spelt(rows)


def with_another_cell(rng: random.Random, data: bytes) -> bytes:
    rows = _rows(data)
    row = rows[rng.randrange(1, len(rows))]
    row[rng.randrange(len(row))] = rng.choice(WORDS)
    return _spelt(rows)


def with_a_column_swapped(rng: random.Random, data: bytes) -> bytes:
    rows = _rows(data)
    one, other = rng.randrange(len(rows[0])), rng.randrange(len(rows[0]))
    for row in rows:
        row[one], row[other] = row[other], row[one]
    return _spelt(rows)


def with_another_value(rng: random.Random, data: bytes) -> bytes:
    """Change a leaf, a key or a type of JSON."""
    value = json.loads(data)
    node, places = value, []
    while isinstance(node, dict | list) and node:
        key = rng.choice(list(node)) if isinstance(node, dict) else rng.randrange(len(node))
        places.append((node, key))
        node = node[key]
    holder, key = rng.choice(places)
    new: Any = rng.choice(
        (None, -1, True, "text", [], {}, float("nan"), float("inf"), 1e300, [[1]], "", "9" * 5000)
    )
    if rng.random() < 0.3 and isinstance(holder, dict):
        holder[f"{key}x"] = holder.pop(key)
    elif rng.random() < 0.2:
        del holder[key]
    else:
        holder[key] = new
    return json.dumps(value).encode()


def nest_deeply(_rng: random.Random, _data: bytes) -> bytes:
    return b"[" * 200_000 + b"]" * 200_000


def with_a_key_twice(rng: random.Random, data: bytes) -> bytes:
    text = data.decode()
    keys = [at for at, mark in enumerate(text) if mark == "{"]
    at = rng.choice(keys)
    name = text[at + 1 :].lstrip()
    if not name.startswith('"'):
        return b"{}"
    key = name[: name.index('"', 1) + 1]
    return (text[: at + 1] + f"{key}: 0, " + text[at + 1 :]).encode()


def _zipped(data: bytes, change: Callable[[str, bytes], bytes]) -> bytes:
    made = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(data)) as archive,
        zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for name in archive.namelist():
            new.writestr(name, change(name, archive.read(name)))
    return made.getvalue()


def with_a_part_damaged(rng: random.Random, data: bytes) -> bytes:
    """Damage the bytes of one member of an archive, whose checksum holds again."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        chosen = rng.choice(archive.namelist())
    how = rng.choice((flip, truncate, empty))
    return _zipped(data, lambda name, held: how(rng, held) if name == chosen and held else held)


def bomb(rng: random.Random, data: bytes) -> bytes:
    """Make one member unpack to 200 MB: of space, of cells, or of rows."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        chosen = rng.choice(archive.namelist())
    filling = rng.choice((b" ", b"<c/>", b'<row r="1"/>', b"\x00"))
    return _zipped(
        data,
        lambda name, held: (
            held + filling * (200_000_000 // len(filling)) if name == chosen else held
        ),
    )


def with_a_far_cell(rng: random.Random, data: bytes) -> bytes:
    row, cell = rng.choice(
        (
            ('r="1048576"', '<c r="XFD1048576" t="inlineStr"><is><t>x</t></is></c>'),
            ('r="900000"', '<c r="A900000"><v>1</v></c>'),
            ('r="9"', '<c r="A9" t="e"><v>#N/A</v></c>'),
            ('r="9"', '<c r="A9"><f>1+1</f></c>'),
            ('r="9"', '<c r="A9" t="s"><v>99999999</v></c>'),
            ('r="-9"', '<c r="A9"><v>1e999</v></c>'),
            ('r="9"', '<c r="B9" t="b"><v>1</v></c>'),
        )
    )
    new = f"<row {row}>{cell}</row></sheetData>".encode()
    return _zipped(data, lambda _name, held: held.replace(b"</sheetData>", new))


ANY: tuple[Bytes, ...] = (flip, flip, truncate, empty)
TEXT: tuple[Bytes, ...] = (*ANY, in_other_encoding, with_other_line_ends, without_a_line)
TABLE: tuple[Bytes, ...] = (
    *(*TEXT, with_a_line_twice, header_alone, with_cells_swapped, with_another_cell),
    *(with_another_cell, with_another_cell, with_a_column_swapped),
)
JSON: tuple[Bytes, ...] = (*TEXT, *(with_another_value,) * 4, nest_deeply, with_a_key_twice)
ARCHIVE: tuple[Bytes, ...] = (*ANY, with_a_part_damaged, with_a_part_damaged, bomb)
WORKBOOK: tuple[Bytes, ...] = (*ARCHIVE, with_a_far_cell, with_a_far_cell)


def ways(name: str) -> tuple[Bytes, ...]:
    """Return what can be done to the content of a file of this name."""
    by_ending = {"csv": TABLE, "json": JSON, "xlsx": WORKBOOK, "npz": ARCHIVE}
    return by_ending.get(name.rpartition(".")[2], TEXT)


def replace(rng: random.Random, path: Path) -> str:
    """Put something else in the place of a file; return what."""
    path.unlink()
    what = rng.choice(("nothing", "directory", "loop", "dangling link", "named pipe"))
    if what == "directory":
        path.mkdir()
    elif what == "loop":
        path.symlink_to(path.name)
    elif what == "dangling link":
        path.symlink_to("nowhere")
    elif what == "named pipe":
        os.mkfifo(path)
    return what


def damage(rng: random.Random, path: Path) -> str:
    """Damage one file in place; return how, in a word or two."""
    if rng.random() < 0.12:
        return f"replaced by {replace(rng, path)}"
    data = path.read_bytes()
    while True:
        how = rng.choice(ways(path.name))
        try:
            new = how(rng, data)
        except (ValueError, IndexError, KeyError):  # this file gives no hold for it
            continue
        if new != data:
            path.write_bytes(new)
            return how.__name__.replace("_", " ")
