"""A pattern found once for all methods that look for it in the same frames.

Finding which spot is which aperture's costs as much as, and often far more than, what a method then
does with the spots. Whoever runs several methods on one batch of frames, and does not time them,
says so (`shared_patterns`); the numbers do not depend on it.
"""

from __future__ import annotations

import weakref
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

#: Batches whose patterns are kept: the splits of a data set.
_MOST = 4

Found = TypeVar("Found")


@dataclass
class _Memory:
    """What was found, by batch and settings, while somebody shares."""

    sharing: int = 0
    kept: OrderedDict[Hashable, tuple[weakref.ref[NDArray[Any]], Any]] = field(
        default_factory=OrderedDict
    )


_memory = _Memory()


@contextmanager
def shared_patterns() -> Iterator[None]:
    """Within it, patterns found in an array that nobody can write to are found once.

    Such is an array whose own ``flags.writeable`` is off, and that of what it is a view of.
    """
    _memory.sharing += 1
    try:
        yield
    finally:
        _memory.sharing -= 1
        if not _memory.sharing:
            _memory.kept.clear()


def found_once(frames: NDArray[Any], settings: Hashable, find: Callable[[], Found]) -> Found:
    """Return what `find` finds in the frames with these settings, or found before.

    Parameters
    ----------
    frames
        Any shape.
    settings
        Everything beside the frames that the result depends on.
    find
        Called where nothing is known; its result is not to be written to.
    """
    owner = _constant_owner(frames) if _memory.sharing else None
    if owner is None:
        return find()
    place = frames.__array_interface__["data"][0], frames.shape, frames.strides, frames.dtype.str
    key = (place, settings)
    known = _memory.kept.get(key)
    # an address may be another array's by now
    if known is not None and known[0]() is owner:
        _memory.kept.move_to_end(key)
        result: Found = known[1]
        return result
    result = find()
    _memory.kept[key] = weakref.ref(owner), result
    while len(_memory.kept) > _MOST:
        _memory.kept.popitem(last=False)
    return result


def _constant_owner(array: NDArray[Any]) -> NDArray[Any] | None:
    """Return the array whose memory this one is a view of; None where it can be written to."""
    owner: Any = array
    while isinstance(owner, np.ndarray) and not owner.flags.writeable:
        if owner.base is None:
            return owner
        owner = owner.base
    return None  # can be written to, or is memory of something that may change
