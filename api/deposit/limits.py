"""What a bundle may be for an archive and for every system to take it: sizes, numbers, names."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from pathlib import Path

#: Bytes of one record on Zenodo (help.zenodo.org, "Quota"); of its 100 files a bundle takes five.
LARGEST = 50_000_000_000
#: Bytes of a list or a description, which are read whole.
LARGEST_DOCUMENT = 50_000_000
_DOCUMENTS = ("checksums-sha256.txt", "datapackage.json", "ro-crate-metadata.json", "CITATION.cff")
_DEVICE = re.compile(
    r"(?:con|prn|aux|nul|conin\$|conout\$|(?:com|lpt)[0-9¹²³])(?:\..*)?", re.IGNORECASE
)
_NOT_IN_NAMES = re.compile(r'[\x00-\x1f\x7f<>:"\\|?*]')


def excess_size(directory: Path, names: Iterable[str]) -> tuple[str, str] | None:
    """Name what makes a directory too large for an archive, before a byte of it is read.

    Parameters
    ----------
    directory : of the bundle
    names : of its files
    """
    sizes = {name: (directory / name).lstat().st_size for name in names}
    total = sum(sizes.values())
    if total > LARGEST:
        name = max(sizes, key=sizes.__getitem__)
        return name, (
            f"has {sizes[name]:,} of {total:,} bytes in all; expected at most {LARGEST:,}, which "
            "is what an archive takes"
        )
    for name in _DOCUMENTS:
        if sizes.get(name, 0) > LARGEST_DOCUMENT:
            return name, f"has {sizes[name]:,} bytes; expected at most {LARGEST_DOCUMENT:,}"
    return None


def unfit_names(names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Name the files whose names not every system takes, or takes for those of others."""
    known: dict[str, str] = {}
    for name in sorted(names):
        folded = unicodedata.normalize("NFC", name.casefold())
        if folded in known:
            yield name, f"is {known[folded]!r} to systems that fold letters"
        known.setdefault(folded, name)
        for part in name.split("/"):
            if _DEVICE.fullmatch(part):
                yield name, f"{part!r} is a device on Windows"
            elif _NOT_IN_NAMES.search(part) or part != part.rstrip(" ."):
                yield name, f"{part!r} is no name of a file on every system"
