"""What a kind of files is: where sound ones come from, and what a command says of them."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

#: Why a file that is not as it was may be taken.
SAME = "reads as before, because the damaged bytes have no meaning"
OFFERED = (
    "the damaged table is valid: the plan shows every cell that differs, and nothing is written "
    "without --apply"
)
OTHERS = "the damaged tables are valid, and there is no manifest to compare them with; ours has one"
OWN = "the damaged file is valid; running times are no part of the record"


class RefusedError(ValueError):
    """What the command says in other ways than by an error."""


@dataclass(frozen=True)
class Kind:
    """One kind of files.

    Attributes
    ----------
    name
        Of the kind.
    share
        Of the cases, in hundredths.
    make
        Puts sound files into a directory; returns those to damage.
    read
        What the command reads of the directory; raises where it refuses.
    differing
        Why a result that differs may be taken; empty where it may not.
    may
        Whether this one may (what was read, what is read of the sound files).
    forge
        Changes something and makes all digests fit, and returns how; None for plain damage.
    """

    name: str
    share: int
    make: Callable[[Path], list[Path]]
    read: Callable[[Path], Any]
    differing: str = ""
    may: Callable[[Any, Any], bool] = lambda _result, _reference: True
    forge: Callable[[random.Random, Path], str] | None = None
