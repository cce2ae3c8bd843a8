"""Rules of built sensors: what makes rows one product, and what feeds a sensor."""

from __future__ import annotations

from collections.abc import Iterator

from survey_data.problems import Problem
from survey_data.tables import FIRST_ROW
from survey_data.validation.cells import Frames, Rule, problem, texts


def _families_are_of_one_kind(frames: Frames) -> Iterator[Problem]:
    """Check that the rows of a family that give detector, mask or supply agree on it."""
    columns = ("detector", "mask", "supply")
    first: dict[tuple[str, str], tuple[int, str]] = {}
    for index, (family, *cells) in texts(frames["hardware"], "family", *columns):
        for column, cell in zip(columns, cells, strict=True):
            at, held = first.setdefault((family, column), (index, cell)) if cell else (index, cell)
            if cell != held:
                message = f"{family} has {cell} here and {held} in row {at + FIRST_ROW}"
                yield problem("hardware", index, column, message)


def _no_power_has_a_supply(frames: Frames) -> Iterator[Problem]:
    """Check that a supply is given where power is 0, and nowhere beside another power."""
    for index, (power, supply) in texts(frames["hardware"], "power_mw", "supply"):
        if power and (float(power) == 0.0) != bool(supply):
            message = f"power is {float(power):g} mW, yet the supply is {supply!r}"
            yield problem("hardware", index, "supply", message)


RULES: tuple[tuple[tuple[str, ...], Rule], ...] = (
    (("hardware",), _families_are_of_one_kind),
    (("hardware",), _no_power_has_a_supply),
)
