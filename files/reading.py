"""Reading a file's bytes: regular files only, and only so many.

A named pipe would keep its reader waiting for ever, a device would never end, and a directory, or
a link to nothing, is not the same as no file. What cannot be read is refused with its reason.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

#: More than any table or document of the project holds, and less than hurts.
LARGEST = 50_000_000

_KINDS = (
    (stat.S_ISDIR, "a directory"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


class FileRefusedError(ValueError):
    """A file cannot be taken; `reason` says why, the message names the file before it.

    Parameters
    ----------
    path
        Of the file.
    reason
        What was expected and what came.
    line
        Where in the file, counted from 1; None where no line is at fault.
    """

    def __init__(self, path: Path, reason: str, line: int | None = None) -> None:
        self.path = path
        self.reason = reason
        self.line = line
        place = f"{path}" if line is None else f"{path}, line {line}"
        super().__init__(f"{place}: {reason}")


def path_exists(path: Path) -> bool:
    """Say whether anything has this name, be it a directory or a link to nothing."""
    return os.path.lexists(path)


def read_bytes(path: Path, largest: int = LARGEST) -> bytes:
    """Return what a regular file holds.

    Raises
    ------
    FileNotFoundError
        Nothing has this name.
    FileRefusedError
        It is no regular file, cannot be opened, or is larger than `largest` bytes.
    """
    if not path_exists(path):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    try:
        # Never waits: a pipe that nobody writes to would else be waited for.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | _binary())
    except OSError as error:
        raise FileRefusedError(path, f"cannot be read: {error.strerror or error}") from error
    found = os.fstat(handle)
    if not stat.S_ISREG(found.st_mode):
        os.close(handle)
        kind = next((name for test, name in _KINDS if test(found.st_mode)), "something else")
        raise FileRefusedError(path, f"expected a file, got {kind}")
    with os.fdopen(handle, "rb") as file:
        if found.st_size > largest:
            raise FileRefusedError(
                path, f"expected at most {largest} bytes, got {found.st_size} bytes"
            )
        try:
            data = file.read(largest + 1)
        except OSError as error:
            raise FileRefusedError(path, f"cannot be read: {error.strerror or error}") from error
    if len(data) > largest:
        raise FileRefusedError(path, f"expected at most {largest} bytes, got more")
    return data


def read_text(path: Path, largest: int = LARGEST) -> str:
    """Return what a text file holds, line ends as they are; UTF-8 without a byte-order mark.

    Raises as `read_bytes`, and FileRefusedError naming the line for what is no such text: other
    encodings, null characters, and U+FFFD, which stands where an earlier program lost a letter.
    """
    data = read_bytes(path, largest)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        reason = f"not UTF-8 text: byte 0x{data[error.start]:02x}"
        raise FileRefusedError(path, reason, line) from error
    for mark, name in _MARKS.items():
        at = text.find(mark)
        if at >= 0:
            raise FileRefusedError(path, f"holds {name}", text.count("\n", 0, at) + 1)
    return text


_MARKS = {
    "\ufeff": "a byte-order mark; expected plain UTF-8",
    "\x00": "a null character",
    "\ufffd": "U+FFFD, which stands for a letter that was lost",
}


def _binary() -> int:
    return getattr(os, "O_BINARY", 0)  # Windows would else translate line ends
