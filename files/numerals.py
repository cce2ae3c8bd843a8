"""Numbers as the project's tables spell them: ASCII digits, finite, nothing that Python adds.

`float` and `int` read ``1_29``, ``nan``, digits of other scripts and space around; here they are
refused.
"""

from __future__ import annotations

import math
import re

_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", re.ASCII)
_WHOLE = re.compile(r"[+-]?[0-9]+", re.ASCII)
_LONGEST = 40


def parse_decimal(text: str) -> float:
    """Read a finite decimal number; ValueError for anything else."""
    if len(text) > _LONGEST or _NUMBER.fullmatch(text) is None:
        raise ValueError(f"expected a number, got {text[:_LONGEST]!r}")
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"expected a finite number, got {text!r}")
    return number


def parse_integer(text: str) -> int:
    """Read a whole number; ValueError for anything else."""
    if len(text) > _LONGEST or _WHOLE.fullmatch(text) is None:
        raise ValueError(f"expected a whole number, got {text[:_LONGEST]!r}")
    return int(text)
