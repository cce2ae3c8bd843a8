"""The user's directory for what can be made again."""

from __future__ import annotations

import os
from pathlib import Path


def user_cache() -> Path:
    """Return $SUNATLAS_STORE, else sunatlas/ in the user's cache directory.

    That is $XDG_CACHE_HOME or ~/.cache. It need not exist.
    """
    named = os.environ.get("SUNATLAS_STORE")
    if named:
        return Path(named)
    cache = os.environ.get("XDG_CACHE_HOME")
    return (Path(cache) if cache else Path.home() / ".cache") / "sunatlas"
