"""Words that a shell completes: those of the closed lists that parameters take."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any, get_args

from api.schema.parameters import OneOf

VARIABLE = "_SUNATLAS_COMPLETE"  # that a shell sets when it asks


def complete(kind: Any) -> Callable[[str], list[str]]:
    """Return what completes a word of a closed list, or of a type of one, as Typer takes it."""
    word: OneOf = kind if isinstance(kind, OneOf) else get_args(kind)[1]

    def completed(incomplete: str) -> list[str]:
        return _quoted([one for one in word.words() if one.startswith(incomplete)])

    return completed


def _quoted(words: Sequence[str]) -> list[str]:
    """Return words as they are typed: bash takes what is completed as it is."""
    if os.environ.get(VARIABLE) != "complete_bash":
        return list(words)
    return [word.replace(" ", "\\ ") for word in words]
