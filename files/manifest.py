"""What commands wrote: digests of a folder's files, so that a change by hand is named by its cell.

`manifest.json` beside the files has of each the SHA-256, and two bytes of a digest of every line
and three of every column: enough to say where a file that is not as it was written differs. A
command that writes files takes them into the manifest (`write_recorded`), and no others. Checking
costs what reading the bytes does, hundredths of a second.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
from base64 import b64decode, b64encode
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from files.atomic import replace_all, replace_file
from files.problems import Problem
from files.reading import FileRefusedError, path_exists, read_bytes
from files.strict_json import read_json, require_members

FILE = "manifest.json"
#: What the files are about to be: written before them and renamed to `FILE` after the last, so
#: that what a kill leaves half done is not taken for a change by hand.
NEXT = ".manifest.json.next"
SCHEMA = 1
BY_HAND = "not as its command wrote it"

_ROW, _COLUMN = 2, 3  # bytes of their digests
_MOST = 5  # places named of a file


@dataclass(frozen=True)
class Entry:
    """Digests of one file: of its bytes, its lines and, where it is a table, its columns."""

    sha256: str
    rows: bytes
    columns: bytes

    @classmethod
    def of(cls, name: str, data: bytes) -> Entry:
        """Digest what a file of this name holds; of one that is not text, only the bytes."""
        if name.endswith(".parquet"):
            return cls(hashlib.sha256(data).hexdigest(), b"", b"")
        rows = b"".join(_short(line, _ROW) for line in data.split(b"\n"))
        table = _columns(data) if name.endswith(".csv") else []
        columns = b"".join(_short(cells, _COLUMN) for _, cells in table)
        return cls(hashlib.sha256(data).hexdigest(), rows, columns)

    def text(self) -> str:
        """Spell the entry as the file has it."""
        return json.dumps(
            {
                "sha256": self.sha256,
                "columns": b64encode(self.columns).decode(),
                "rows": b64encode(self.rows).decode(),
            }
        )


def read_manifest(folder: Path, name: str = FILE) -> dict[str, Entry] | None:
    """Return the entries of a folder's manifest by file; None where there is none.

    Raises
    ------
    FileRefusedError
        For what is no manifest.
    """
    path = folder / name
    try:
        held = require_members(read_json(path), path, {"schema": int, "files": dict})
    except FileNotFoundError:
        return None
    if held["schema"] != SCHEMA:
        raise FileRefusedError(path, f"expected schema {SCHEMA}, got {held['schema']}")
    found = {}
    for file, entry in held["files"].items():
        require_members(entry, path, dict.fromkeys(("sha256", "columns", "rows"), str))
        try:
            rows, columns = (b64decode(entry[k], validate=True) for k in ("rows", "columns"))
        except ValueError as error:
            raise FileRefusedError(path, f"{file}: not base 64 ({error})") from error
        found[file] = Entry(entry["sha256"], rows, columns)
    return found


def differences(folder: Path, names: Collection[str], *, required: bool = False) -> list[Problem]:
    """Say what of a folder is not as commands wrote it; an empty list where all is.

    Parameters
    ----------
    folder
        With a manifest.
    names
        Files that should be there, relative to the folder, POSIX.
    required
        Whether it is a problem that there is no manifest; else nothing is known and nothing said.
    """
    try:
        entries = read_manifest(folder)
        # A damaged one of these tells nothing: the files are then held against the other alone.
        coming = read_manifest(folder, NEXT) if path_exists(folder / NEXT) else None
    except FileRefusedError as error:
        return [Problem(FILE, error.line, None, error.reason)]
    if entries is None:
        return [Problem(FILE, None, None, "the file is missing")] if required else []
    found: list[Problem] = []
    for name in sorted({*names, *entries}):
        summary = list(_of_file(folder, name, entries.get(name), name in names))
        if (
            summary
            and coming is not None
            and not list(_of_file(folder, name, coming.get(name), name in names))
        ):
            continue  # a killed command had come this far
        found += summary
    return found


def write_recorded(
    folder: Path,
    contents: Mapping[str, str | bytes | None],
    *,
    start: bool = False,
    together: str | None = None,
) -> bool:
    """Write files of a folder, each whole or not at all, and take them into its manifest.

    Parameters
    ----------
    folder
        Made where there is none.
    contents
        By name relative to the folder; None takes the file away.
    start
        Begin a manifest where there is none. Without it files beside which there is none are
        just written.
    together
        Sub-folder that all of them stand in: it changes places with a new one in one step
        (`atomic.replace_all`), so that no kill leaves some of them new and others old.

    Returns
    -------
    bool
        Whether a file changed; the manifest is none of them.

    Raises
    ------
    FileRefusedError
        The manifest there is cannot be read; nothing has been written.
    OSError
        A file cannot be written.
    """
    entries = read_manifest(folder)
    recorded = entries is not None or start
    entries = _as_left(folder, entries or {}) if recorded else {}
    encoded = {k: v.encode() if isinstance(v, str) else v for k, v in contents.items()}
    for name, data in encoded.items():
        if data is None:
            entries.pop(name, None)
        elif name not in entries or entries[name].sha256 != hashlib.sha256(data).hexdigest():
            entries[name] = Entry.of(name, data)
    if recorded and not _is(folder / FILE, manifest_text(entries)):
        replace_file(folder / NEXT, manifest_text(entries))
    if together is not None:
        changed = _replace_folder(folder, together, encoded)
        encoded = {}
    else:
        changed = False
    for name, data in encoded.items():
        if data is not None:
            changed |= replace_file(folder / name, data)
        elif path_exists(folder / name):
            (folder / name).unlink()
            changed = True
    if recorded:
        finish_interrupted_write(folder)
    return changed


def _replace_folder(folder: Path, name: str, contents: Mapping[str, bytes | None]) -> bool:
    """Replace files of a sub-folder all at once; say whether one changed."""
    old = folder / name
    known = {path.name: path.read_bytes() for path in old.iterdir() if path.is_file()}
    coming = {PurePosixPath(file).name: data for file, data in contents.items()}
    wanted = {file: data for file, data in {**known, **coming}.items() if data is not None}
    if wanted == known:
        return False
    with replace_all(old) as (new,):
        new.mkdir(mode=0o777 & old.stat().st_mode)
        for file, data in wanted.items():
            (new / file).write_bytes(data)
            if file in known:
                (new / file).chmod((old / file).stat().st_mode & 0o777)
    return True


def _as_left(folder: Path, entries: Mapping[str, Entry]) -> dict[str, Entry]:
    """Return a manifest's entries, and of files that a killed command has dealt with its own.

    The next command need not deal with them again: a file that is taken away is away.
    """
    found = dict(entries)
    try:
        coming = read_manifest(folder, NEXT)
    except FileRefusedError:
        return found  # damaged, it tells nothing
    if coming is None:
        return found
    for name in {*entries, *coming}:
        entry = coming.get(name)
        if entry == entries.get(name) or list(_of_file(folder, name, entry, False)):
            continue
        if entry is None:
            del found[name]
        else:
            found[name] = entry
    return found


def rewrite_manifest(folder: Path, names: Collection[str]) -> list[str]:
    """Take all the files of a folder as they are into its manifest; return those that were not.

    For a change by hand that is meant; whether the files are sound is for the caller to know.
    """
    try:
        known = read_manifest(folder) or {}
    except FileRefusedError:
        known = {}
    entries = {name: Entry.of(name, read_bytes(folder / name)) for name in names}
    replace_file(folder / FILE, manifest_text(entries))
    (folder / NEXT).unlink(missing_ok=True)
    return sorted(name for name in {*entries, *known} if entries.get(name) != known.get(name))


def manifest_digest(folder: Path) -> str | None:
    """Return the SHA-256 of a folder's manifest, which names all that is in it; None without."""
    path = folder / FILE
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None


def finish_interrupted_write(folder: Path) -> None:
    """Finish what a killed command left: the coming manifest is the manifest if the files are so.

    Where the files are still those of the manifest there is, the coming one is dropped. Where they
    are some of both, both stay: the command is to be run again.
    """
    path = folder / NEXT
    if not path_exists(path):
        return
    coming, present = read_manifest(folder, NEXT) or {}, read_manifest(folder) or {}
    for entries, act in ((coming, lambda: path.replace(folder / FILE)), (present, path.unlink)):
        names = {*coming, *present}
        if not any(list(_of_file(folder, n, entries.get(n), n in entries)) for n in names):
            act()
            return


def manifest_text(entries: Mapping[str, Entry]) -> str:
    """Spell a manifest: a line a file, sorted."""
    lines = ",\n".join(f"{json.dumps(name)}: {entries[name].text()}" for name in sorted(entries))
    return f'{{"schema": {SCHEMA}, "files": {{\n{lines}\n}}}}\n'


def _of_file(folder: Path, name: str, entry: Entry | None, wanted: bool) -> Iterator[Problem]:
    """Tell of one file in what it is not as its entry says."""
    try:
        data = read_bytes(folder / name)
    except FileNotFoundError:
        if entry is not None or wanted:
            yield Problem(name, None, None, "the file is missing")
        return
    except FileRefusedError as error:
        yield Problem(name, None, None, error.reason)
        return
    if entry is None:
        yield Problem(name, None, None, f"the file is not in {FILE}: no command wrote it")
    elif hashlib.sha256(data).hexdigest() != entry.sha256:
        if not entry.rows:
            yield Problem(name, None, None, f"the file is {BY_HAND}")
            return
        yield from _places(name, data, entry)


def _places(name: str, data: bytes, entry: Entry) -> Iterator[Problem]:
    lines = data.split(b"\n")
    now = [_short(line, _ROW) for line in lines]
    then = [entry.rows[k : k + _ROW] for k in range(0, len(entry.rows), _ROW)]
    columns = _changed_columns(data, entry) if name.endswith(".csv") else ()
    if len(now) == len(then):
        changed = [
            row for row, pair in enumerate(zip(now, then, strict=True), 1) if len({*pair}) > 1
        ]
        for row in changed[:_MOST]:
            yield Problem(
                name, row, ", ".join(columns) or None, _said(lines[row - 1], columns, data)
            )
        if len(changed) > _MOST:
            yield Problem(name, None, None, f"{len(changed) - _MOST} more rows are {BY_HAND}")
        if not changed:  # two bytes of a digest happen to agree
            yield Problem(name, None, ", ".join(columns) or None, f"the file is {BY_HAND}")
        return
    same = 0
    while same < min(len(now), len(then)) and now[same] == then[same]:
        same += 1
    end = 0
    while end < min(len(now), len(then)) - same and now[-1 - end] == then[-1 - end]:
        end += 1
    here, there = len(now) - same - end, len(then) - same - end
    summary = f"{here or 'no'} rows where there were {there or 'none'}"
    yield Problem(name, same + 1, None, f"{summary}: {BY_HAND}")


def _said(line: bytes, columns: tuple[str, ...], data: bytes) -> str:
    cells, header = _cells(line), _cells(data.partition(b"\n")[0])
    if len(columns) == 1 and len(cells) == len(header):
        return f"{BY_HAND}: now {cells[header.index(columns[0])][:80]!r}"
    return BY_HAND


def _changed_columns(data: bytes, entry: Entry) -> tuple[str, ...]:
    then = [entry.columns[k : k + _COLUMN] for k in range(0, len(entry.columns), _COLUMN)]
    now = _columns(data)
    if len(now) != len(then):
        return ()
    return tuple(
        name for (name, cells), was in zip(now, then, strict=True) if _short(cells, _COLUMN) != was
    )


def _columns(data: bytes) -> list[tuple[str, bytes]]:
    """Return (name, cells in one text) of each column; nothing for what is no even table."""
    rows = [_cells(line) for line in data.split(b"\n") if line]
    if not rows or len({len(row) for row in rows}) != 1:
        return []
    return [
        (name, "\x1f".join(cells).encode("utf-8", "surrogateescape"))
        for name, *cells in zip(*rows, strict=True)
    ]


def _cells(line: bytes) -> list[str]:
    try:
        return next(csv.reader(io.StringIO(line.decode("utf-8", "surrogateescape"))), [])
    except csv.Error:
        return []


def _short(data: bytes, size: int) -> bytes:
    return hashlib.blake2b(data, digest_size=size).digest()


def _is(path: Path, text: str) -> bool:
    return path.is_file() and path.read_bytes() == text.encode()
