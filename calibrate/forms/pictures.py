"""Width and height of a picture by its head: known before room is made for a pixel."""

from __future__ import annotations

import re
import struct

_PNG, _BMP, _JPEG = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", b"BM", b"\xff\xd8"
#: Of TIFF: order of bytes, and whether places in the file are of 8 bytes.
_TIFF = {
    b"II*\0": ("<", False),
    b"MM\0*": (">", False),
    b"II+\0": ("<", True),
    b"MM\0+": (">", True),
}
#: Of its entries: width and height of the picture, and of a tile; codes of types of numbers.
_SIDES, _TILE, _NUMBERS = (256, 257), (322, 323), {3: "H", 4: "I", 16: "Q"}
#: A portable grey map or pixmap: three numbers behind blanks and comments.
_PORTABLE = re.compile(rb"P[1-6]" + 2 * rb"(?:\s|#[^\r\n]*[\r\n])+(\d{1,9})" + rb"\D")
_LONGEST_PORTABLE = 4096
#: Markers of JPEG that begin a frame, and those without a length.
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_BARE = frozenset((0x01, *range(0xD0, 0xD8)))


def picture_size(data: bytes) -> tuple[int, int] | None:
    """Return the width and height that a PNG, JPEG, TIFF, BMP or PGM states; None for others.

    Of a TIFF in tiles that are larger than the picture, those of a tile.
    """
    try:
        if data.startswith(_PNG):
            return _sides(">II", data, 16)
        if data.startswith(_BMP):
            (size,) = struct.unpack_from("<I", data, 14)
            return _sides("<HH" if size == 12 else "<ii", data, 18)
        if data.startswith(_JPEG):
            return _of_jpeg(data)
        if data[:4] in _TIFF:
            return _of_tiff(data, *_TIFF[data[:4]])
    except struct.error:  # the head ends early
        return None
    found = _PORTABLE.match(data[:_LONGEST_PORTABLE])
    return (int(found[1]), int(found[2])) if found else None


def _sides(form: str, data: bytes, at: int) -> tuple[int, int]:
    width, height = struct.unpack_from(form, data, at)
    return abs(width), abs(height)


def _of_jpeg(data: bytes) -> tuple[int, int] | None:
    at = len(_JPEG)
    while True:
        mark, kind = struct.unpack_from("BB", data, at)
        if mark != 0xFF or not kind:  # which decoders pass over, each in its way
            return None
        if kind in _FRAMES:
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        if kind == 0xFF:  # fills
            at += 1
        elif kind in _BARE:
            at += 2
        else:
            at += 2 + max(struct.unpack_from(">H", data, at + 2)[0], 2)


def _of_tiff(data: bytes, order: str, big: bool) -> tuple[int, int] | None:
    (at,) = struct.unpack_from(f"{order}Q" if big else f"{order}I", data, 8 if big else 4)
    (count,) = struct.unpack_from(f"{order}Q" if big else f"{order}H", data, at)
    first, length, value = (8, 20, 12) if big else (2, 12, 8)
    stated: dict[int, int] = {}
    for entry in range(at + first, at + first + min(count, 2**16) * length, length):
        tag, kind = struct.unpack_from(f"{order}HH", data, entry)
        if tag in (*_SIDES, *_TILE):
            if kind not in _NUMBERS:
                return None
            (number,) = struct.unpack_from(order + _NUMBERS[kind], data, entry + value)
            stated[tag] = max(number, stated.get(tag, 0))  # of several
    if not stated.keys() >= set(_SIDES):
        return None
    width, height = (stated[tag] for tag in _SIDES)
    return max(width, stated.get(_TILE[0], 0)), max(height, stated.get(_TILE[1], 0))
