"""The file of pins: how it is written and read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from benchmark.datasets.pins import Pin, Place
from benchmark.results.tables import StoreError, number, read, text_of, whole, word

_COLUMNS = {
    "dataset": word,
    "condition": word,
    "split": word,
    "version": whole,
    "n": whole,
    "observable": whole,
    "bound_deg": number,
    "head_bound_deg": number,
    "data_hash": word,
    "head_hash": word,
}


def pins_text(pins: Iterable[Pin]) -> str:
    """Spell pins as their file has them, sorted."""
    ordered = sorted(pins, key=lambda pin: pin.place)
    return text_of(list(_COLUMNS), map(asdict, ordered))


def read_pins(path: Path) -> dict[Place, Pin]:
    """Read pins by place; StoreError naming the line that is none, or that is there twice."""
    found: dict[Place, Pin] = {}
    for line, row in read(path, _COLUMNS):
        missing = [name for name in ("version", "n") if row[name] is None]
        if missing:
            raise StoreError(f"{path}, line {line}: expected a number in {', '.join(missing)}")
        pin = Pin(**row)
        if pin.place in found:
            raise StoreError(f"{path}, line {line}: {'/'.join(pin.place)} is there twice")
        found[pin.place] = pin
    return found
