"""The working store: what this user measured on this machine, beside the published results."""

from __future__ import annotations

from pathlib import Path

from api.user_cache import user_cache


def working_directory(given: Path | None = None) -> Path:
    """Return the directory of the working store.

    $SUNATLAS_STORE, else sunatlas/ in the user's cache directory ($XDG_CACHE_HOME or ~/.cache).

    Parameters
    ----------
    given : a directory to use instead
    """
    return given or user_cache()
