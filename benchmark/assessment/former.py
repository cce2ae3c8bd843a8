"""What the first version of the definitions scored, kept beside the second's outcomes.

The scores in `former.csv` were computed once, from the record of 22 November 2026, by the
definitions that stood until then; those of the second version were first computed from the same
record. They are history: nothing renews them.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from benchmark.assessment.assess import AGREEMENTS, NOT_MEASURED


@cache
def scores() -> Mapping[tuple[str, str], int | None]:
    """Return 2, 1, 0 or None (not measured) by method and property."""
    text = files("benchmark.assessment").joinpath("former.csv").read_text("utf-8")
    return MappingProxyType(
        {
            (row["method"], row["property"]): int(row["measured"]) if row["measured"] else None
            for row in csv.DictReader(text.splitlines())
        }
    )


def agreement(method: str, name: str, survey: int) -> str:
    """Return the verdict that the first version gave on a property of a method.

    Parameters
    ----------
    method, name
        As in the survey's table.
    survey
        2, 1 or 0, as the survey scores it.

    Raises
    ------
    KeyError
        For a method or property that the first version did not have.
    """
    measured = scores()[method, name]
    return NOT_MEASURED if measured is None else AGREEMENTS[abs(survey - measured)]
