"""How the kernels are compiled: one thread, exact floating point, kept on disk where possible."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def compiled(function: Kernel) -> Kernel:
    """Compile a kernel at its first call, for the array types it is called with.

    Arithmetic is neither reordered nor contracted (``fastmath`` off), so a frame gives the same
    numbers alone, in a batch and on every run. The machine code is cached beside the source, else
    in the user's cache directory; where neither can be written, it is compiled in each process.
    Numba does not notice a change in a kernel of another file: kernels call only their own file.
    """
    try:
        kernel = numba.njit(cache=True, nogil=True, fastmath=False)(function)
    except RuntimeError:  # Numba: "cannot cache function: no locator available"
        kernel = numba.njit(cache=False, nogil=True, fastmath=False)(function)
    return cast("Kernel", kernel)
