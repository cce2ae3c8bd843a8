"""Random streams seeded by what they are for, never by when or where they are drawn."""

from __future__ import annotations

import hashlib

import numpy as np


def seed_sequence(*names: str | int) -> np.random.SeedSequence:
    """Return the seed of a named stream: SHA-256 over the names, 256 bits of entropy.

    Parameters
    ----------
    names
        What the stream is for, from general to special, e.g. dataset, version, condition.
        ``("a", "bc")`` and ``("ab", "c")`` are different streams.

    Raises
    ------
    ValueError
        When no name is given: an unnamed stream would be shared by everything.
    """
    if not names:
        raise ValueError("a random stream needs at least one name; got none")
    text = "\x1f".join(f"{type(name).__name__}:{name}" for name in names)
    digest = hashlib.sha256(text.encode()).digest()
    return np.random.SeedSequence(np.frombuffer(digest, dtype="<u4").tolist())


def generator(*names: str | int) -> np.random.Generator:
    """Return a PCG-64 generator of the named stream (see `seed_sequence`)."""
    return np.random.Generator(np.random.PCG64(seed_sequence(*names)))
