"""Matplotlib for pictures that are the same wherever they are drawn."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_ONE = threading.Lock()


@contextmanager
def plain_style(**settings: Any) -> Iterator[None]:
    """Draw by Matplotlib's own defaults, whatever a user has set, and by what is given here.

    One picture at a time: the library's settings are those of the whole process.
    """
    from matplotlib import style  # noqa: PLC0415 - a second that only pictures need

    with _ONE, style.context(["default", settings]):
        yield
