"""How the kernels are compiled: one thread, exact floating point, kept on disk where possible."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.core.registry import CPUDispatcher

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

#: Division by zero gives infinity or NaN, as in NumPy: a loop that might raise is not vectorised.
_OPTIONS: dict[str, Any] = {"nogil": True, "fastmath": False, "error_model": "numpy"}


def compiled(function: Kernel) -> Kernel:
    """Compile a kernel at its first call, for the array types it is called with.

    Arithmetic is neither reordered nor contracted (``fastmath`` off), so a frame gives the same
    numbers alone, in a batch and on every run. Division by zero gives infinity or NaN; it
    does not raise. The machine code is cached beside the source, else in the user's cache
    directory; where neither can be written, it is compiled in each process.
    A kernel may call kernels that its module imports: it is compiled again when their files change.
    Numbers that a module imports from another one do not count. With ``NUMBA_DISABLE_JIT=1`` in the
    environment nothing is compiled, for debuggers and for coverage.
    """
    try:
        kernel = numba.njit(cache=True, **_OPTIONS)(function)
    except RuntimeError:  # Numba: "cannot cache function: no locator available"
        return cast("Kernel", numba.njit(cache=False, **_OPTIONS)(function))
    if not isinstance(kernel, CPUDispatcher):
        return function
    index = _index(kernel)
    stamps = {
        other.py_func.__module__: _index(other)._source_stamp for other in _imported(function)
    }
    index._source_stamp = (index._source_stamp, stamps, tuple(_OPTIONS.items()))
    return cast("Kernel", kernel)


def _imported(function: Callable[..., Any]) -> list[Any]:
    """Kernels of other modules among the names that a kernel can call."""
    values = function.__globals__.values()
    kernels = [value for value in values if isinstance(value, CPUDispatcher)]
    return [kernel for kernel in kernels if kernel.py_func.__module__ != function.__module__]


# Numba stamps machine code with its kernel's own file alone, and has no public way to add to that.
# ruff: noqa: SLF001
def _index(kernel: Any) -> Any:
    """Index of a kernel's machine code on disk, which is stale where the stamps differ."""
    return kernel._cache._cache_file
