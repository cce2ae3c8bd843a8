"""A bundle that cannot change any more: a private copy, verified, whose bytes are sent.

What is checked and what is sent are the same bytes: those of a copy that only this user can reach,
and that are summed again while they go out.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from api.deposit import limits
from api.deposit.archives.contract import ArchiveError
from api.deposit.archives.metadata import Description, description
from api.deposit.archives.transport import Content
from api.deposit.package import NAME
from api.deposit.packing import PackingError, check
from api.deposit.verification import verify
from benchmark.datasets.checksums import contents
from files.temporary import temporary_directory_beside

#: Files that are also sent by themselves, to be read or searched without the zip.
APART = ("README.md", "sun-sensor-atlas.sqlite", "studies.bib", "studies.ris")
_CHUNK = 1 << 20


class BundleError(ArchiveError):
    """What is to be uploaded is no whole bundle."""


class ChangedError(ArchiveError):
    """A file is not the one that was verified."""


@dataclass(frozen=True)
class SealedFile:
    """A file with the checksums of the bytes that were verified.

    Attributes
    ----------
    path : of the private copy
    size : in bytes
    sha256, md5 : in hexadecimal; the second is what archives tell
    """

    path: Path
    size: int
    sha256: str
    md5: str

    @property
    def content(self) -> Content:
        """The body of a request."""
        return Content(self.chunks, self.size)

    def chunks(self) -> Iterator[bytes]:
        """Yield the bytes; the last of them only once all are known to be the verified ones.

        Raises
        ------
        ChangedError
            Where they are not; no archive has a whole file then.
        """
        summed, left, last = hashlib.sha256(), self.size, b""
        with self.path.open("rb") as file:
            while chunk := file.read(min(_CHUNK, left)):
                if last:
                    yield last
                summed.update(chunk)
                left -= len(chunk)
                last = chunk
            more = file.read(1)
        if left or more or summed.hexdigest() != self.sha256:
            raise ChangedError(
                f"{self.path.name}: changed after it was verified; expected the bytes of SHA-256 "
                f"{self.sha256}; nothing whole was sent"
            )
        yield last


@dataclass(frozen=True)
class SealedBundle:
    """A bundle as it was verified.

    Attributes
    ----------
    files : that an archive is sent, by name
    description : metadata sent to the archive
    """

    files: Mapping[str, SealedFile]
    description: Description


@contextmanager
def seal(directory: Path) -> Iterator[SealedBundle]:
    """Verify a private copy of a bundle and of its zip; it is there for as long as the block.

    Raises
    ------
    BundleError
        Where the zip is missing or is not that of the directory, anything in the bundle does not
        hold, or it is larger than an archive takes.
    """
    directory = Path(os.path.abspath(directory))  # noqa: PTH100 - a link stays one
    packed = directory.with_name(f"{directory.name}.zip")
    if not packed.is_file() or packed.is_symlink():
        raise BundleError(
            f"{packed}: missing, or no plain file; build the bundle again with "
            "`sunatlas deposit build`"
        )
    names = contents(directory)
    if (wrong := limits.excess_size(directory, names)) is not None:
        raise BundleError(f"{directory}: {wrong[0]} {wrong[1]}; nothing was sent")
    if (size := packed.stat().st_size) > limits.LARGEST:
        raise BundleError(
            f"{packed}: has {size:,} bytes; expected at most {limits.LARGEST:,}; nothing was sent"
        )
    with temporary_directory_beside(directory) as private:
        copy = private / directory.name
        copied_zip = private / packed.name
        for name in names:
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(directory / name, copy / name, follow_symlinks=False)
        shutil.copyfile(packed, copied_zip, follow_symlinks=False)
        try:
            yield _verify(copy, copied_zip, directory)
        except (OSError, ValueError) as error:
            if str(private) not in str(error):
                raise
            raise BundleError(str(error).replace(str(private), str(directory.parent))) from error


def _verify(copy: Path, packed: Path, directory: Path) -> SealedBundle:
    if wrong := verify(copy):
        raise BundleError(f"{directory}: {wrong[0][0]}: {wrong[0][1]}; nothing was sent")
    metadata = description(copy)
    top = f"{NAME}-{metadata.version}"
    try:
        check(packed, copy, top, date.fromisoformat(metadata.released))
    except PackingError as error:
        raise BundleError(
            f"{packed}: not the zip of {directory}: {error}; build the bundle again"
        ) from error
    apart = {Path(name).name: copy / name for name in contents(copy)}
    lacking = sorted(set(APART) - apart.keys())
    if lacking:
        raise BundleError(f"{directory}: {lacking[0]} is missing; nothing was sent")
    paths = {f"{top}.zip": packed, **{name: apart[name] for name in APART}}
    return SealedBundle({name: _seal(path) for name, path in paths.items()}, metadata)


def _seal(path: Path) -> SealedFile:
    sha256, md5, size = hashlib.sha256(), hashlib.md5(usedforsecurity=False), 0
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK):
            sha256.update(chunk)
            md5.update(chunk)
            size += len(chunk)
    return SealedFile(path, size, sha256.hexdigest(), md5.hexdigest())
