"""JSON documents with a digest over what they hold, read strictly: what is damaged is refused."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from files.reading import FileRefusedError, read_json

#: Member that holds the digest of all the others.
DIGEST = "digest"
#: Thrice the largest calibration (tables of 10 MB); what is so large is refused within 2 s.
LARGEST_BYTES = 30_000_000
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
        As `files.reading.read_json` refuses, or for arrays and objects nested deeper than 50.
    OSError
        If nothing has this name.
    """
    try:
        value = read_json(path, LARGEST_BYTES)
    except FileRefusedError as error:
        place = "" if error.line is None else f", line {error.line}"
        raise DocumentError(f"{error.reason}{place}") from error
    if _is_deep(value):
        raise DocumentError(f"not JSON: nested deeper than {_DEEPEST}")
    return value


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
