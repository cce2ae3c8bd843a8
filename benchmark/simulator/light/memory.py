"""Light kept between calls that render the same scene.

Conditions of a dataset see the same Suns, and differ in pixels and noise more often than in what
stands in front of them; the bound moves the Sun alike under each. Nothing is kept until
`cache_for` is called; kept light is the rendered one to the last bit.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections import OrderedDict
from collections.abc import Callable, Hashable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.canonical import to_plain

#: Large frames take from it (`benchmark.running.condition_data`): a worker stays below 1.2 GB.
LIMIT_BYTES = 256 * 2**20
#: Shares of it: what runs may take, and what the latest of them take besides where they find none.
_OF_RUNS, _LATEST = 0.625, 0.0625

#: Runs (R, 2) of light in a flattened array, first and past-last place, and its values there.
Runs = tuple[NDArray[np.int32], NDArray[np.float32]]
#: Places of light other than 0 (None: everywhere), the values, the array's shape.
_Kept = tuple[NDArray[np.int32] | None, NDArray[Any], tuple[int, ...]]
Light = TypeVar("Light", bound=NDArray[Any])
Function = TypeVar("Function", bound=Callable[..., Any])


class LightMemory:
    """Rendered arrays by key, for one owner at a time; dark elements take no room."""

    def __init__(self, limit_bytes: int = LIMIT_BYTES) -> None:
        self.limit_bytes = limit_bytes
        self.kept_bytes = 0
        self.runs_bytes = 0
        self.hits = 0
        self._owner: Hashable = None
        self._family: Hashable = None
        self._tables: list[Callable[[], None]] = []
        self._mapped: list[Callable[[], None]] = []
        self._kept: dict[Hashable, _Kept] = {}
        self._runs: dict[Hashable, Runs] = {}
        self._latest: OrderedDict[Hashable, Runs] = OrderedDict()
        self._directory: Path | None = None

    def cache_for(self, owner: Hashable, family: Hashable = None) -> None:
        """Keep light from now on; what was kept for another owner is let go.

        So are tables (`tables`) when owners of another family come, who look up others.
        """
        if owner != self._owner:
            self.forget()
            self._owner = owner
        if family != self._family:
            for let_go in self._tables:
                let_go()
            self._family = family

    def tables(self, most: int, *, mapped: bool = False) -> Callable[[Function], Function]:
        """Keep what a function made for its last so many arguments until `cache_for` lets go.

        What it has from `mapped` goes with `release_mapped`, too.
        """

        def kept(function: Function) -> Function:
            known = lru_cache(maxsize=most)(function)
            self._tables.append(known.cache_clear)
            if mapped:
                self._mapped.append(known.cache_clear)
            return cast("Function", known)

        return kept

    def release_mapped(self) -> None:
        """Let go of tables that the shared directory holds; who asks again has them from there."""
        if self._directory is not None:
            for let_go in self._mapped:
                let_go()

    def share_tables(self, directory: Path) -> None:
        """Keep in a directory what `mapped` makes, for all processes that share it.

        They must be of the same code, and the directory no older than they.
        """
        self._directory = directory

    def mapped(self, named_by: Any, make: Callable[[], Floats]) -> Floats:
        """Return what `make` makes of an object, read-only; from a shared directory if it is there.

        Parameters
        ----------
        named_by
            All that the array depends on: a dataclass, as `benchmark.canonical.to_plain` takes it.
        make
            Makes the array.
        """
        path = None
        if self._directory is not None:
            # to the last bit, unlike digests of the record
            spelt = json.dumps(to_plain(named_by, float.hex, _fields))
            name = hashlib.sha256(f"{type(named_by).__qualname__} {spelt}".encode()).hexdigest()
            path = self._directory / f"{name}.npy"
            if path.is_file():
                return np.asarray(np.load(path, mmap_mode="r"))
        made = make()
        made.flags.writeable = False
        if path is not None:
            with suppress(OSError):  # a full disk: others make it again
                part = path.with_name(f"{path.name}.{os.getpid()}")
                with part.open("wb") as file:
                    np.save(file, made)
                part.replace(path)  # whole, or not there, for who looks for it
        return made

    def forget(self) -> None:
        """Let go of everything and keep nothing more."""
        self._kept.clear()
        self._runs.clear()
        self._latest.clear()
        self.kept_bytes = self.runs_bytes = 0
        self._owner = None

    def render(self, key: Hashable, render: Callable[[], Light]) -> Light:
        """Return what `render` makes, which the key names, as an array of the caller's own.

        Once the limit is reached nothing more is kept: letting go of the oldest would lose
        everything when the same scenes come round in the same order.
        """
        if self._owner is None:
            return render()
        known = self._kept.get(key)  # asked for once: keys are long
        if known is not None:
            self.hits += 1
            places, values, shape = known
            if places is None:
                return cast("Light", values.reshape(shape).copy())
            whole = np.zeros(shape, dtype=values.dtype)
            whole.reshape(-1)[places] = values
            return cast("Light", whole)
        light = render()
        kept = _pack(light)
        if self._has_room(kept[1].nbytes + (0 if kept[0] is None else kept[0].nbytes)):
            self._kept[key] = kept
        return light

    def runs(self, key: Hashable, render: Callable[[], Runs]) -> Runs:
        """Return what `render` makes, as `render`, for frames too large to be filled twice.

        Not the caller's own: to be read only. Where there is no room the latest few are kept
        nevertheless, for passes over the same poses.
        """
        if self._owner is None:
            return render()
        known = self._runs.get(key) or self._latest.get(key)
        if known is not None:
            self.hits += 1
            return known
        found = render()
        size = _size(found)
        # the rest of the room is left to what bounds ask for more often
        if self.runs_bytes + size <= _OF_RUNS * self.limit_bytes and self._has_room(size):
            self.runs_bytes += size
            self._runs[key] = found
            return found
        self._latest[key] = found
        while sum(map(_size, self._latest.values())) > _LATEST * self.limit_bytes:
            self._latest.popitem(last=False)
        return found

    def _has_room(self, size: int) -> bool:
        if self.kept_bytes + size > self.limit_bytes:
            return False
        self.kept_bytes += size
        return True


def _fields(value: Any) -> dict[str, object]:
    return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}


def _size(runs: Runs) -> int:
    return runs[0].nbytes + runs[1].nbytes


def digest_of(*arrays: NDArray[Any]) -> bytes:
    """Name arrays by their content, for keys: shorter than their bytes."""
    state = hashlib.blake2b(digest_size=16)
    for array in arrays:
        state.update(repr((array.dtype.str, array.shape)).encode())
        state.update(np.ascontiguousarray(array).tobytes())
    return state.digest()


def _pack(light: NDArray[Any]) -> _Kept:
    """Copy `light` in whichever form is smaller."""
    flat = light.reshape(-1)
    places = np.flatnonzero(flat)
    if (4 + flat.itemsize) * len(places) >= flat.nbytes:
        return None, flat.copy(), light.shape
    return places.astype(np.int32), flat[places], light.shape


#: This process's memory.
memory = LightMemory()
