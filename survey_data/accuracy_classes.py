"""The class of an accuracy by the one limit of each class, and the cells that contradict it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pandas as pd

#: Bases of what the survey or its authors print: it stands even where it contradicts the limits.
PRINTED = frozenset({"survey-table", "authors-table", "survey-text"})
#: How a number of three digits may lie beside the limit that it is.
_ROUNDED = (0.995, 1.0, 1.005)


@dataclass(frozen=True)
class ClassDisagreement:
    """A reported accuracy that lies outside the limits of the class its study is filed under.

    `printed` says whether the survey or its authors print the class or the number; only then may
    the two differ.
    """

    study: str
    accuracy_deg: float
    filed: str
    by_limits: str
    printed: bool


def accuracy_class(taxonomy: pd.DataFrame, accuracy_deg: float) -> str:
    """Return the accuracy class of an accuracy in degrees (min_deg <= accuracy < max_deg).

    Raises
    ------
    LookupError
        No class holds it (negative or not a number).
    """
    return _within(_limits(taxonomy), accuracy_deg)


def _limits(taxonomy: pd.DataFrame) -> list[tuple[str, float, float]]:
    """Return name, least and upper limit of each class; the last has none above."""
    classes = taxonomy[taxonomy["attribute"] == "accuracy"]
    upper = classes["max_deg"].fillna(float("inf"))
    return list(zip(classes["value"].map(str), classes["min_deg"], upper, strict=True))


def _within(classes: list[tuple[str, float, float]], accuracy_deg: float) -> str:
    for name, least, upper in classes:
        if least <= accuracy_deg < upper:
            return name
    raise LookupError(f"no accuracy class holds {accuracy_deg} deg")


def class_disagreements(
    taxonomy: pd.DataFrame, attributes: pd.DataFrame
) -> Iterator[tuple[int, ClassDisagreement]]:
    """Yield the row of each class that its study's number contradicts, and the two.

    Numbers are compared as printed, whatever their kind; a study without one, or with a cell that
    is no angle, contradicts nothing. A number that is the limit of two classes, as
    rounded, contradicts neither: "better than one arcminute" is written 0.0167, of the finer.
    """
    known = attributes[attributes["value"].notna()]
    reported = known[known["attribute"] == "accuracy_deg"]
    reported = reported.assign(degrees=pd.to_numeric(reported["value"], errors="coerce"))
    angles = reported[reported["degrees"].between(0, 180, inclusive="right")]
    numbers = {row.study: row for row in angles.itertuples(index=False)}
    at = known["attribute"] == "accuracy"
    classes = _limits(taxonomy)
    rows = known[at].itertuples(index=False)
    for index, row in zip(known.index[at].tolist(), rows, strict=True):
        number = numbers.get(row.study)
        if number is None:
            continue
        degrees = float(str(number.degrees))
        by_limits = _within(classes, degrees)
        if row.value not in {_within(classes, degrees * by) for by in _ROUNDED}:
            printed = not PRINTED.isdisjoint({row.basis, number.basis})
            yield (
                index,
                ClassDisagreement(str(row.study), degrees, str(row.value), by_limits, printed),
            )
