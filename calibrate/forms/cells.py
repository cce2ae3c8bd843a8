"""Cells as numbers: decimal commas, degrees, minutes and seconds, dates, units behind numbers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from algorithms.contract import Floats
from calibrate.forms.units import unit_of

if TYPE_CHECKING:
    from collections.abc import Callable

#: Cells that say that nothing was measured.
BLANK = frozenset(
    {"", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---", "missing", "+nan", "-nan"}
)
#: Letters of a cell past which it is no number: Python takes no longer ones.
_LONGEST = 400
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
_SEXAGESIMAL = re.compile(
    r"(?P<sign>[+-]?)\s*(?P<whole>\d{1,3})\s*[°ºd:h]\s*(?P<minutes>\d{1,2}(?:\.\d*)?)"
    r"(?:\s*(?:['′m:]|’)\s*(?:(?P<seconds>\d{1,2}(?:\.\d*)?)\s*(?:[\"″s]|''|”|’’)?)?)?",
    re.IGNORECASE,
)
#: From a cell's start: sought at every digit of a long number it would take minutes.
_WITH_UNIT = re.compile(r"^(?P<number>[+-]?[\d.,]+(?:[eE][+-]?\d+)?)\s*(?P<unit>[^\d\s.,+-].*)")
_DATE = re.compile(r"\d{4}[-/.]\d{1,2}[-/.]\d{1,2}([T\s].*)?|\d{1,2}[./-]\d{1,2}[./-]\d{4}(\s.*)?")


@dataclass(frozen=True)
class Numbers:
    """A column of cells as numbers."""

    values: Floats  # (n,), NaN where a cell is blank or none
    unit: str | None  # where the cells themselves say it
    note: str  # how they were read, where not as plain numbers
    wrong: np.ndarray  # (n,), cells that are neither numbers nor blank


def looks_numeric(cell: str) -> bool:
    """Say whether a cell is what a row of data holds: a number, an angle, a date, a time."""
    text = cell.strip().replace("\u2212", "-")
    if _NUMBER.fullmatch(text) or _SEXAGESIMAL.fullmatch(text) or _DATE.fullmatch(text):
        return True
    match = _WITH_UNIT.fullmatch(text)
    return text.lower() in ("inf", "-inf") or bool(match and unit_of(match["unit"]))


def numbers_of(cells: pd.Series[str], decimal: str, *, of_time: bool) -> Numbers:
    """Return a column of stripped cells as numbers, by the form that reads most of them.

    `decimal` is ``"."`` or ``","``; `of_time` says whether three numbers with colons are hours,
    minutes and seconds, in seconds, instead of degrees.
    """
    text = cells.str.replace("\u2212", "-", regex=False)
    blank = text.str.lower().isin(BLANK).to_numpy()
    spelt = text.str.replace(decimal, ".", regex=False) if decimal != "." else text
    plain = _plain(spelt)
    wrong = ~np.isfinite(plain) & ~blank
    if not wrong.any():
        return Numbers(plain, None, "", wrong)
    sample = text[wrong].head(200)
    ways: tuple[Callable[[pd.Series[str]], tuple[Floats, str | None, str]], ...] = (
        _with_units,
        lambda column: _sexagesimal(column, of_time=of_time),
        _dates,
    )
    for way in ways:
        values, unit, note = way(_spelt(sample, decimal))
        if np.isfinite(values).mean() < 0.5:
            continue
        values, unit, note = way(_spelt(text, decimal))
        # a plain number among others of this form is what it says
        values = np.where(np.isfinite(values), values, plain if unit else np.nan)
        return Numbers(values, unit, note, ~np.isfinite(values) & ~blank)
    return Numbers(plain, None, "", wrong)


def _spelt(text: pd.Series[str], decimal: str) -> pd.Series[str]:
    return text.str.replace(decimal, ".", regex=False) if decimal != "." else text


def _plain(spelt: pd.Series[str]) -> Floats:
    short = spelt.where(spelt.str.len() <= _LONGEST, "")
    return np.asarray(pd.to_numeric(short, errors="coerce"), dtype=np.float64)


def _with_units(text: pd.Series[str]) -> tuple[Floats, str | None, str]:
    parts = text.str.extract(_WITH_UNIT)
    units = {unit_of(str(word)) for word in parts["unit"].dropna().unique()}
    if len(units) != 1 or None in units:
        return np.full(len(text), np.nan), None, ""
    unit = units.pop()
    return (
        _plain(parts["number"].fillna("")),
        unit,
        f"numbers with their unit ({unit}) in each cell",
    )


def _sexagesimal(text: pd.Series[str], *, of_time: bool) -> tuple[Floats, str | None, str]:
    whole = text.str.fullmatch(_SEXAGESIMAL)
    parts = text.where(whole, "").str.extract(_SEXAGESIMAL)
    values = sum(
        pd.to_numeric(parts[name], errors="coerce").fillna(0.0 if at else np.nan) / 60.0**at
        for at, name in enumerate(("whole", "minutes", "seconds"))
    )
    signed = np.asarray(values, dtype=np.float64) * np.where(parts["sign"] == "-", -1.0, 1.0)
    if of_time:
        return 3600.0 * signed, "s", "hours, minutes and seconds, read as seconds"
    return signed, "deg", "degrees, minutes and seconds"


def _dates(text: pd.Series[str]) -> tuple[Floats, str | None, str]:
    """Seconds since 1970 of dates; those without a zone are UTC."""
    dated = text.where(text.str.fullmatch(_DATE), "")
    day_first = bool(dated.str.match(r"\d{1,2}\.").any())
    moments = pd.to_datetime(dated, errors="coerce", utc=True, format="mixed", dayfirst=day_first)
    known = moments.notna().to_numpy()
    seconds = np.full(len(text), np.nan)
    stamps = moments[known].dt.as_unit("ns").astype("int64")
    seconds[known] = np.asarray(stamps, dtype=np.float64) / 1e9
    return seconds, "unix", "dates, read as seconds since 1970 (UTC where no zone is said)"
