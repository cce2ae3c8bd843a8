"""Measure scores of this deposit again, from nothing but the deposit and a package registry.

    python rescore.py --cells 20 --seed 1

Needs Python 3.11 or later. It makes a virtual environment, installs the packages that the code's
lock file pins from the registry that pip is configured with, then the code from code/, and runs
`sunatlas deposit rescore` on this directory: cells are drawn by the seed, fitted and scored from
the deposited samples, and compared with benchmark/scores.csv to the last digit. Exit code 1 where a
digit differs. The environment is deleted at the end; --environment DIR keeps it for another run.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tarfile
import tempfile
import time
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
LOCK = "requirements.lock"
CHECKSUMS = "checksums-sha256.txt"


def main() -> int:
    """Install and measure; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=20, help="how many scores (default: 20)")
    parser.add_argument("--seed", type=int, default=1, help="draws them (default: 1)")
    parser.add_argument("--environment", type=Path, help="where to keep the virtual environment")
    asked = parser.parse_args()
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as temporary:
        place = asked.environment or Path(temporary) / "environment"
        ready = place / "installed"
        if not ready.is_file():
            install(place, Path(temporary))
            ready.touch()
        say(f"installed after {time.monotonic() - started:.0f} s")
        command = [python_of(place), "-I", "-m", "api.cli.command_line", "deposit", "rescore"]
        command += [str(HERE), "--cells", str(asked.cells), "--seed", str(asked.seed)]
        code = subprocess.run(command, check=False).returncode  # noqa: S603 - installed above
    say(f"done after {time.monotonic() - started:.0f} s")
    return code


def install(place: Path, temporary: Path) -> None:
    """Make a virtual environment with the code of this deposit and what its lock file pins."""
    archive = code_archive()
    lock = temporary / LOCK
    with tarfile.open(archive) as code:
        (member,) = (one for one in code if one.name.split("/")[1:] == [LOCK])
        found = code.extractfile(member)
        lock.write_bytes(b"" if found is None else found.read())
    say(f"making a virtual environment in {place}")
    venv.create(place, with_pip=True, clear=True)
    pip = [python_of(place), "-I", "-m", "pip", "install", "--quiet"]
    say("installing what the lock file pins")
    subprocess.run([*pip, "--require-hashes", "-r", str(lock)], check=True)  # noqa: S603 - pip
    say(f"installing {archive.name}")
    subprocess.run([*pip, "--no-deps", "--no-build-isolation", str(archive)], check=True)  # noqa: S603


def code_archive() -> Path:
    """Return the archive of the code, once its digest is that of the list of checksums."""
    (archive,) = (HERE / "code").glob("*.tar.gz")
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    line = f"{digest}  {archive.relative_to(HERE).as_posix()}"
    if line not in (HERE / CHECKSUMS).read_text("utf-8").splitlines():
        sys.exit(f"{archive}: SHA-256 is not that of {CHECKSUMS}")
    return archive


def python_of(environment: Path) -> str:
    """Return the interpreter of a virtual environment."""
    folder = "Scripts" if os.name == "nt" else "bin"
    return str(environment / folder / "python")


def say(text: str) -> None:
    """Write a line to standard error."""
    sys.stderr.write(f"rescore: {text}\n")


if __name__ == "__main__":
    sys.exit(main())
