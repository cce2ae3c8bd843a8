"""`Samples`: one split of a dataset; and its hash, which pins name and exports carry."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmark.canonical import DIGITS

Floats = NDArray[np.float64]
Arrays = Mapping[str, NDArray[Any] | None]

#: Samples at the start of a split that have a hash of their own, for a check in seconds.
HEAD = 4


@dataclass(frozen=True)
class Samples:
    """One split of a dataset.

    Attributes
    ----------
    observations
        (N, ...) what the sensor puts out; shape and unit as the dataset's card says.
    sun
        (N, 3) unit vectors from the sensor to the Sun, float64: true ones but in the calibration
        split, where they are what the calibration's reference says, errors and all.
    origin_px
        (N, 2) int64 detector coordinate (x, y) of each window's first pixel, or None.
    context
        What else is known of each sample by column name, e.g. ``time_s``: arrays of N rows. None
        where there is nothing.
    true_sun
        (N, 3) true unit vectors where `sun` has errors, else None. For tests and export: no
        method is given them.
    """

    observations: NDArray[Any]
    sun: Floats
    origin_px: NDArray[np.int64] | None
    context: Mapping[str, NDArray[Any]] | None = None
    true_sun: Floats | None = None

    @property
    def truth(self) -> Floats:
        """(N, 3) where the Sun truly stood."""
        return self.sun if self.true_sun is None else self.true_sun

    def arrays(self) -> dict[str, NDArray[Any] | None]:
        """Everything that hashes cover by name: columns of the context come last, sorted."""
        return arrays_of(self)


def arrays_of(samples: Samples) -> dict[str, NDArray[Any] | None]:
    """Return the arrays of one split by name; columns of a context come last, sorted.

    True directions are among them only where there are others beside.
    """
    arrays: dict[str, NDArray[Any] | None] = {
        name: getattr(samples, name) for name in ("observations", "sun", "origin_px")
    }
    true_sun: Floats | None = getattr(samples, "true_sun", None)
    if true_sun is not None:
        arrays["true_sun"] = true_sun
    context: Mapping[str, NDArray[Any]] = getattr(samples, "context", None) or {}
    arrays.update((f"context.{name}", context[name]) for name in sorted(context))
    return arrays


def samples_hash(samples: Samples) -> str:
    """SHA-256 (32 hexadecimal digits) over the arrays of one split: names, types, shapes, bytes."""
    return _arrays_hash(arrays_of(samples))


def head_hash(samples: Samples) -> str:
    """`samples_hash` of the first `HEAD` samples: those that ``generate(..., n=HEAD)`` gives."""
    return _arrays_hash(
        {name: None if a is None else a[:HEAD] for name, a in arrays_of(samples).items()}
    )


def _arrays_hash(arrays: Arrays) -> str:
    state = hashlib.sha256()
    for name, array in arrays.items():
        if array is None:
            state.update(f"{name} none\n".encode())
            continue
        little = np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<"), copy=False)
        state.update(f"{name} {little.dtype.descr} {little.shape}\n".encode())
        state.update(little.reshape(-1).view(np.uint8).data)  # not copied: frames may be large
    return state.hexdigest()[:DIGITS]
