"""Writing files and directories whole or not at all.

Everything is made beside its place and renamed into it: who reads meanwhile sees the earlier
content or the new one, and a process that is killed leaves no half of either.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path


def replace_file(path: Path, content: str | bytes) -> bool:
    """Write a file whole or not at all; on return it survives a power cut.

    Directories above it are made. An earlier file keeps its permissions, a new one may be read
    by everybody.

    Parameters
    ----------
    path
        Of the file.
    content
        Text is written as UTF-8, its line ends as they are.

    Returns
    -------
    bool
        Whether the content changed; a file that holds it already is not written.
    """
    wanted = content.encode() if isinstance(content, str) else content
    known = path.is_file()
    if known and path.read_bytes() == wanted:
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    scratch = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(wanted)
            file.flush()
            os.fsync(file.fileno())
        scratch.chmod(path.stat().st_mode & 0o777 if known else 0o644)
        scratch.replace(path)
    except BaseException:
        scratch.unlink(missing_ok=True)
        raise
    return True


@contextmanager
def replacing(*targets: Path) -> Iterator[tuple[Path, ...]]:
    """Make files and directories elsewhere; they take their places when the block ends.

    An error in the block leaves the targets as they are, and so does one in putting the new ones
    in place: what had been there is put back. Where even that fails, the error names the hidden
    directory beside the targets in which the earlier content lies; there it is found as well
    after a kill between two renames.

    Parameters
    ----------
    targets
        Paths in one directory, which exists; what each holds is replaced.

    Yields
    ------
    tuple of Path
        For each target the path to make it at.
    """
    # Beside the targets: a rename is only atomic within a file system.
    first = targets[0]
    scratch = Path(tempfile.mkdtemp(dir=first.parent, prefix=f".{first.name}."))
    made, before = scratch / "made", scratch / "before"
    try:
        made.mkdir()
        before.mkdir()
        new = tuple(made / target.name for target in targets)
        yield new
        with ExitStack() as undo:
            for path, target in zip(new, targets, strict=True):
                earlier = before / target.name
                if os.path.lexists(target):
                    target.rename(earlier)
                    undo.callback(earlier.rename, target)
                path.rename(target)
                undo.callback(target.rename, path)
            undo.pop_all()
    except BaseException:
        if not any(before.iterdir()):
            shutil.rmtree(scratch)
        raise
    shutil.rmtree(scratch)
