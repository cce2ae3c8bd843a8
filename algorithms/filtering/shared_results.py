"""Results by what they depend on: filters of one sensor share what they learn of it."""

from __future__ import annotations

import copy
import hashlib
import pickle
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

Result = TypeVar("Result")

#: The latest results, by a digest of what they depend on, and how many.
_results: dict[bytes, Any] = {}
_KEPT = 32


def compute_once(given: Sequence[object], compute: Callable[[], Result]) -> Result:
    """Return a copy of what `compute` returns; it is called once for equal `given`.

    Parameters
    ----------
    given : sequence of objects
        All that the result depends on, its function included; they can be pickled.
    compute : callable
        Without arguments. What it raises is not kept.
    """
    key = hashlib.sha256(pickle.dumps(given)).digest()
    if key not in _results:
        result = compute()
        while len(_results) >= _KEPT:
            _results.pop(next(iter(_results)), None)
        _results[key] = result
    found: Result = copy.deepcopy(_results[key])
    return found
