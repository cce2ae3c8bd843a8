"""Pictures of the data sets: published with the code, and drawn where the code is another.

Drawing simulates, which takes up to 20 s of a processor, as optics are tabulated first. So every
picture lies in `PUBLISHED`, named by what it shows: the data set's digest and that of the code that
draws. `python -m api.previews --publish` draws those that lack and removes those of other code.

Where the code has been changed since, a picture is drawn when somebody asks for it, by a process
of its own (within the service it would hold up all other answers), and kept in the working store:
`python -m api.previews DIRECTORY NAME...` draws those that are not there yet. They are named as the
published ones are, and may be deleted at any time.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import threading
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path

from benchmark.processes import call_to_end, for_coordinator
from files.atomic import replace_file, temporary_directory
from files.locks import wait_for_lock

#: Pictures that come with the code, ``<data set>.<digest of what it shows>.png``.
PUBLISHED = Path(__file__).resolve().parents[1] / "benchmark" / "datasets" / "previews"
FOLDER = "previews"
#: Pictures that are drawn at once for whoever asks.
AT_ONCE = 2

_ROOT = Path(__file__).resolve().parents[1]
#: What a picture is made by, beside the data set.
_DRAWN_BY = "benchmark.datasets.preview"


def place(directory: Path, name: str) -> Path:
    """Return where the picture of a data set is kept in a working store."""
    return directory / FOLDER / f"{name}.{_show(name)}.png"


def published_preview(name: str) -> Path:
    """Return where the published picture of a data set lies, if it is of today's code."""
    return PUBLISHED / f"{name}.{_show(name)}.png"


@cache
def _show(name: str) -> str:
    from benchmark import datasets  # noqa: PLC0415 - slow, and not needed to find what is kept
    from benchmark.canonical import digest as digest_of  # noqa: PLC0415 - as above
    from benchmark.results.digests import condition_digests  # noqa: PLC0415 - as above
    from benchmark.results.modules import modules_digest  # noqa: PLC0415 - as above

    shown = condition_digests(datasets.get(name))["nominal"]
    return digest_of([shown, modules_digest(_DRAWN_BY)])[:16]


class Pictures:
    """Pictures as the service gives them.

    Parameters
    ----------
    directory : the working store; None keeps nothing
    """

    def __init__(self, directory: Path | None) -> None:
        self._directory = directory
        self._turns = threading.BoundedSemaphore(AT_ONCE)
        self._locks: dict[str, threading.Lock] = {}

    def png(self, name: str) -> bytes:
        """Return the picture of a data set; waits where it has to be drawn.

        Raises
        ------
        RuntimeError
            Where the process that draws it fails; its message is in the log of the service.
        """
        with suppress(OSError):
            return published_preview(name).read_bytes()
        with self._locks.setdefault(name, threading.Lock()):
            if self._directory is not None:
                with suppress(OSError):
                    return place(self._directory, name).read_bytes()
            with self._turns, temporary_directory() as made:
                keep = made if self._directory is None else self._directory
                for store in dict.fromkeys((keep, made)):  # a store that takes no file is no reason
                    _drawn_beside(store, name)
                    with suppress(OSError):
                        return place(store, name).read_bytes()
        raise RuntimeError(f"the picture of {name} was not drawn")


def _drawn_beside(directory: Path, name: str) -> None:
    subprocess.run(  # noqa: S603 - this module itself
        [sys.executable, "-m", "api.previews", str(directory), name],
        cwd=_ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        env={**os.environ, **for_coordinator()},
        check=False,
    )


def draw(directory: Path, names: Iterable[str]) -> None:
    """Draw the pictures of data sets that are not kept yet, each in its turn."""
    from benchmark import datasets  # noqa: PLC0415 - slow, and not needed to find what is kept
    from benchmark.datasets.preview import preview_png  # noqa: PLC0415 - as above

    for name in names:
        path = place(directory, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        with wait_for_lock(path):
            if not path.is_file():
                replace_file(path, preview_png(datasets.get(name)))


def publish() -> None:
    """Draw the pictures that are not published as the code is now; remove all others."""
    from benchmark import datasets  # noqa: PLC0415 - as in `draw`
    from benchmark.datasets.preview import preview_png  # noqa: PLC0415 - as in `draw`
    from benchmark.progress import console_progress  # noqa: PLC0415 - Rich

    PUBLISHED.mkdir(exist_ok=True)
    wanted = {name: published_preview(name) for name in datasets.names()}
    lacking = [name for name, path in wanted.items() if not path.is_file()]
    with console_progress("drawing") as report:
        for done, name in enumerate(lacking):
            report(done, len(lacking), name)
            replace_file(wanted[name], preview_png(datasets.get(name)))
    for found in set(PUBLISHED.glob("*.png")) - set(wanted.values()):
        found.unlink()


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m api.previews", description="Draw data sets.")
    parser.add_argument("directory", nargs="?", type=Path, help="of the working store")
    parser.add_argument("names", nargs="*", metavar="NAME", help="data sets")
    parser.add_argument("--publish", action="store_true", help="those that come with the code")
    given = parser.parse_args(arguments)
    if given.publish == bool(given.names):
        parser.error("either --publish, or a directory and names have to be given")
    if given.publish:
        publish()
        return 0
    draw(given.directory, given.names)
    return 0


if __name__ == "__main__":
    call_to_end(main)
