"""The working store: what this user measured on this machine, beside the published results."""

from __future__ import annotations

import os
from pathlib import Path


def working_directory(given: Path | None = None) -> Path:
    """Return the directory of the working store.

    $SUNATLAS_STORE, else sunatlas/ in the user's cache directory ($XDG_CACHE_HOME or ~/.cache).

    Parameters
    ----------
    given : a directory to use instead
    """
    named = os.environ.get("SUNATLAS_STORE")
    if given is not None or named:
        return given or Path(str(named))
    cache = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache) if cache else Path.home() / ".cache") / "sunatlas"
