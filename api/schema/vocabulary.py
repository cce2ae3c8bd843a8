"""What members of answers and columns of tables mean, where several models have them.

They stand in vocabulary.csv; a model says itself what only it has, or what means something else in
it.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from pathlib import Path

MEANINGS: Mapping[str, str] = dict(
    csv.reader(Path(__file__).with_suffix(".csv").read_text("utf-8").splitlines()[1:])
)

#: An error in a ring of the field (`benchmark.metrics.rings.Ring.column`).
_RING = re.compile(r"rms_(\d+)_(\d+)_deg")
#: Ends at a semicolon or full stop, not at the point of a number.
_CLAUSE = re.compile(r"^(.+?)(; |\. |\.$)")
#: By the end of a name.
_UNITS: Mapping[str, str] = {"deg": "degrees", "us": "microseconds"}


def meaning(name: str, said: str | None = None) -> str:
    """Return what a member means, with the unit that its name ends in.

    Parameters
    ----------
    name
        Of the member.
    said
        Description in its model. The vocabulary describes a member without one.
    """
    if ring := _RING.fullmatch(name):
        return f"RMS error {ring[1]} to {ring[2]} degrees off the axis."
    text = said or MEANINGS.get(name, "")
    unit = _UNITS.get(name.rpartition("_")[2])
    if unit and unit not in text:
        return add_to_first_clause(text, f" ({unit})")
    return text


def add_to_first_clause(text: str, words: str) -> str:
    """Return a text with words behind its first clause; what is empty stays empty."""
    return _CLAUSE.sub(lambda found: f"{found[1]}{words}{found[2]}", text, count=1)
