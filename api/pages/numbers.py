"""Numbers as pages write them: three significant digits, never an exponent, a dash for none."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from markupsafe import Markup

from api.figures.wording import plural, studies
from benchmark.leaderboard import summaries
from survey_data.reported import UNSPECIFIED, statistics

NOTHING = "–"


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with so many significant digits, as commands and documents spell it."""
    return summaries.digits(value, digits, NOTHING)


def degrees(value: float | None) -> str:
    """Return an error in degrees."""
    text = number(value)
    return text if text == NOTHING else f"{text}°"


def own_error(row: Mapping[str, Any]) -> Markup:
    """Return the own error of a row, marked so that a reader of pages finds it."""
    if row["own_error_deg"] is None:
        return Markup.escape(NOTHING)
    of = "|".join(row[name] for name in ("dataset", "extractor", "model"))
    shown = Markup('<data class="own-error" value="{}" data-of="{}">{}</data>')
    return shown.format(row["own_error_deg"], of, degrees(row["own_error_deg"]))


def wide(value: float | None) -> str:
    """Return a field of view: 60°, where an error would be 60.0°."""
    return NOTHING if value is None else f"{value:.4g}°"


def times(value: float | None) -> str:
    """Return a ratio."""
    text = number(value)
    return text if text == NOTHING else f"{text}×"


def percent(share: float | None) -> str:
    """Return a share, rounded down: only what is whole is 100 %."""
    if share is None or not math.isfinite(share):
        return NOTHING
    return "100 %" if share == 1 else f"{math.floor(share * 1000) / 10:.1f} %"


def upfirst(text: str) -> str:
    """Return a text with a capital first letter, all others as they are."""
    return f"{text[:1].upper()}{text[1:]}"


def sentence(text: str) -> str:
    """Return a text with a capital and a full stop."""
    return f"{upfirst(text)}{'' if text.endswith(('.', '!', '?')) else '.'}"


_UNITS = {"mm": "mm", "um": "µm", "px": "px", "deg": "°", "us": "µs"}


def unit_name(name: str) -> str:
    """Return a name with its unit in words: `focal_length_mm` is "Focal length, mm"."""
    if name == "half_fov_deg":
        return "Half of the field of view, °"
    words, _, last = name.rpartition("_")
    if last not in _UNITS:
        return name.replace("_", " ").capitalize()
    return f"{words.replace('_', ' ').capitalize()}, {_UNITS[last]}"


def kind_said(kind: str) -> str:
    """Return of which kind a published accuracy is said to be, in words."""
    return "of which kind is not said" if kind == UNSPECIFIED else statistics()[kind].name


GIVEN = (
    *(number, degrees, own_error, wide, times, percent, plural, studies),
    *(sentence, upfirst, unit_name, kind_said),
)
"""What templates are given as filters."""
