"""The zip of a bundle: the same bytes each time, with one zlib."""

from __future__ import annotations

import zipfile
from datetime import date
from pathlib import Path

from files.checksums import contents

_UNIX, _PLAIN_FILE = 3, 0o100644 << 16


class PackingError(ValueError):
    """A bundle cannot be packed; the message says why."""


def pack(bundle: Path, target: Path, top: str, released: date) -> None:
    """Pack a bundle.

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
                entry.create_system = _UNIX  # on every machine, for the permissions below
                entry.external_attr = _PLAIN_FILE
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, (bundle / name).read_bytes(), compresslevel=9)
    except zipfile.LargeZipFile as error:
        raise PackingError(f"{bundle}: too large for a zip; expected less than 4 GiB") from error
