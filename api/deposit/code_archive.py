"""The code in a bundle: its source distribution, and the script that measures scores again with it.

The project's build backend makes the archive of a checkout, the same bytes each time. An
installation has no sources to pack: it is handed the archive.
"""

from __future__ import annotations

import gzip
import shutil
import subprocess
import sys
from pathlib import Path

from api.metadata.identity import ROOT

FOLDER = "code"
SCRIPT = "rescore.py"
SUFFIX = ".tar.gz"
_BUILD = "import sys, hatchling.build; hatchling.build.build_sdist(sys.argv[1])"


class CodeArchiveError(ValueError):
    """There is no archive of the code; the message says what to do."""


def write_code(bundle: Path, archive: Path | None = None) -> None:
    """Write the archive of the code to code/, and the script beside the README.

    Parameters
    ----------
    bundle : its directory
    archive : source distribution to take; made of this checkout by default

    Raises
    ------
    CodeArchiveError
        Where the archive is none, this is no checkout or the build backend fails.
    """
    folder = bundle / FOLDER
    folder.mkdir()
    if archive is None:
        _build(folder)
    elif not (archive.name.endswith(SUFFIX) and archive.is_file()):
        raise CodeArchiveError(f"{archive}: expected a source distribution (*{SUFFIX})")
    else:
        shutil.copyfile(archive, folder / archive.name)
    shutil.copyfile(Path(__file__).with_name("rescore_script.py"), bundle / SCRIPT)


def archive_of(bundle: Path) -> str | None:
    """Return the path in a bundle of its archive of the code; None where it has none."""
    found = sorted((bundle / FOLDER).glob(f"*{SUFFIX}"))
    return f"{FOLDER}/{found[0].name}" if len(found) == 1 else None


def write_code_as_in(bundle: Path, made: Path) -> None:
    """Write the code beside what verification makes again, to be compared with a bundle.

    The bundle's own archive, but where this checkout packs other files.
    """
    name = archive_of(bundle)
    if name is None or (ROOT / "pyproject.toml").is_file():
        write_code(made)
        if name is not None and (made / name).is_file() and _same(bundle / name, made / name):
            shutil.copyfile(bundle / name, made / name)
    else:
        write_code(made, bundle / name)


def _same(one: Path, other: Path) -> bool:
    """Say whether archives hold the same, however their zlib packed it."""
    try:
        with gzip.open(one) as first, gzip.open(other) as second:
            return first.read() == second.read()
    except (OSError, EOFError, ValueError):
        return False


def _build(folder: Path) -> None:
    if not (ROOT / "pyproject.toml").is_file():
        raise CodeArchiveError(
            "an installation has no sources to put into the bundle: build it in a checkout, or "
            "name a source distribution of this version with --code"
        )
    done = subprocess.run(  # noqa: S603 - the build backend of this project, on this project
        [sys.executable, "-P", "-c", _BUILD, str(folder.absolute())],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["nothing said"])[-1]
        raise CodeArchiveError(
            f"the build backend does not pack {ROOT}: {said}; "
            "install hatchling (`pip install 'sun-sensor-atlas[deposit]'`)"
        )
