"""The file of pins: how it is written and read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from benchmark.contract import SPLITS
from benchmark.datasets.pins import BOARD_FACTS, Pin, Place
from benchmark.results.csv_tables import (
    StoreError,
    above_zero,
    count,
    read_csv,
    size,
    text_of,
    word,
)

_COLUMNS = {
    "dataset": word,
    "condition": word,
    "split": word,
    "version": count,
    "n": count,
    "observable": count,
    "bound_deg": above_zero,
    "head_bound_deg": above_zero,
    **dict.fromkeys(BOARD_FACTS, size),
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
    for line, row in read_csv(path, _COLUMNS):
        missing = [name for name in ("version", "n") if row[name] is None]
        if missing:
            raise StoreError(f"{path}, line {line}: expected a number in {', '.join(missing)}")
        pin = Pin(**row)
        if said := _contradiction(pin):
            raise StoreError(f"{path}, line {line}: {said}")
        if pin.place in found:
            raise StoreError(f"{path}, line {line}: {'/'.join(pin.place)} is there twice")
        found[pin.place] = pin
    return found


def _contradiction(pin: Pin) -> str:
    """Say in what a pin contradicts itself; empty for nothing."""
    if pin.split not in SPLITS:
        return f"expected a split of {', '.join(SPLITS)}, got {pin.split!r}"
    if pin.split != "test":
        given = [
            name
            for name in ("observable", "bound_deg", "head_bound_deg", *BOARD_FACTS)
            if getattr(pin, name) is not None
        ]
        return f"{given[0]} belongs to the split test alone" if given else ""
    if pin.observable is None or pin.observable > pin.n:
        return f"expected at most {pin.n} observable samples, got {pin.observable}"
    if pin.bound_deg is not None and pin.observable == 0:
        return "a bound and no observable samples contradict each other"
    return ""
