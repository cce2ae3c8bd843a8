"""JSON documents with a digest over what they hold, read strictly: what is damaged is refused."""

from __future__ import annotations

import hashlib
import json
import os
import stat
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

#: Member that holds the digest of all the others.
DIGEST = "digest"
#: Far beyond the largest calibration (tables of 10 MB), and little for any machine.
LARGEST_BYTES = 200_000_000
#: Deeper than any document, and far from where Python gives up.
_DEEPEST = 50


class DocumentError(ValueError):
    """A file or document that cannot be taken; the message says what was expected and what came."""


def digest_of(document: Mapping[str, Any]) -> str:
    """Return the first 32 digits of the SHA-256 of what a document holds, its digest left out.

    Of its JSON with sorted keys and without spaces, so that how a file is laid out is no matter.
    """
    held = {name: value for name, value in document.items() if name != DIGEST}
    text = json.dumps(held, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def require_whole(document: Mapping[str, Any], known: Collection[str]) -> None:
    """Raise DocumentError where a document is not what its digest is of, or has none.

    And where it has a member that is none of the known ones.
    """
    digest = document.get(DIGEST)
    if not isinstance(digest, str):
        raise DocumentError(f"the member {DIGEST!r} is missing")
    try:
        found = digest_of(document)
    except (TypeError, ValueError, RecursionError) as error:
        raise DocumentError(f"expected what JSON can say ({error})") from error
    if found != digest:
        raise DocumentError(
            f"the digest of what it holds is {found}, and it says {digest[:40]!r}: something in it "
            "was changed after it was saved"
        )
    if unknown := sorted(set(document) - set(known)):
        raise DocumentError(f"the member {unknown[0]!r} is unknown")


def read_document(path: Path) -> Any:
    """Return the value that a JSON file holds.

    Raises
    ------
    DocumentError
        For what is no regular file, is too large, is no JSON in UTF-8, or has a key twice, a number
        that is not finite, or arrays and objects nested deeper than 50.
    OSError
        If it cannot be opened.
    """
    data = _bytes(path)
    try:
        value = json.loads(
            data.decode("utf-8"),
            object_pairs_hook=_unique,
            parse_constant=_refuse,
            parse_float=_finite,
        )
    except json.JSONDecodeError as error:
        raise DocumentError(f"not JSON: {error.msg}, line {error.lineno}") from error
    except RecursionError as error:
        raise DocumentError(f"not JSON: nested deeper than {_DEEPEST}") from error
    except ValueError as error:
        raise DocumentError(f"not JSON: {str(error)[:200]}") from error
    if _is_deep(value):
        raise DocumentError(f"not JSON: nested deeper than {_DEEPEST}")
    return value


def _bytes(path: Path) -> bytes:
    # Never waits: a pipe that nobody writes to would else be waited for.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    handle = os.open(path, flags)
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise DocumentError("expected a file, got a directory, a pipe or a device")
    with os.fdopen(handle, "rb") as file:
        data = file.read(LARGEST_BYTES + 1)
    if len(data) > LARGEST_BYTES:
        raise DocumentError(f"expected at most {LARGEST_BYTES} bytes, got more")
    return data


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise ValueError(f"the key {name[:40]!r} stands twice in an object")
        found[name] = value
    return found


def _refuse(word: str) -> Any:
    raise ValueError(f"{word} is no number")


def _finite(text: str) -> float:
    number = float(text)
    if number in (float("inf"), float("-inf")):
        raise ValueError(f"{text[:40]} is out of range")
    return number


def _is_deep(value: Any) -> bool:
    """Say whether arrays and objects nest too deep; level by level, as recursion has its limit."""
    level = [value]
    for _ in range(_DEEPEST + 1):
        level = [
            inner
            for one in level
            if isinstance(one, dict | list)
            for inner in (one.values() if isinstance(one, dict) else one)
        ]
    return bool(level)
