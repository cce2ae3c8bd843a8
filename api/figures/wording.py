"""What levels and values are called in figures. "None" never stands bare."""

from __future__ import annotations

from registry.taxonomy import Taxonomy, attribute_of

NONE = "None"
WITHOUT = {
    "mask": "no mask",
    "extractor": "no feature extraction",
    "model": "no calibration model",
    "error": "no error named",
}
"""What the survey's "None" says of an attribute."""
LEVELS = {
    "task": "Task",
    "error": "Error addressed",
    "accuracy": "Accuracy class",
    "detector": "Detector",
    "mask": "Mask",
    "model": "Model",
    "extractor": "Feature extraction",
    "model_category": "Model category",
    "calibration": "Calibration",
    "extractor_family": "Extraction family",
}
"""Level -> heading."""


def display_name(level: str, value: str) -> str:
    """Return a value as a label writes it."""
    return WITHOUT.get(attribute_of(level), value) if value == NONE else value


def value_name(taxonomy: Taxonomy, level: str, value: str) -> str:
    """Return the full name of a value."""
    return display_name(level, value) if value == NONE else taxonomy.name(level, value)


def value_label(taxonomy: Taxonomy, level: str, value: str) -> str:
    """Return a value with its name behind it where the name says more: CMOS (…)."""
    short, full = display_name(level, value), value_name(taxonomy, level, value)
    return short if short.casefold() == full.casefold() else f"{short} ({full})"


def amount(count: float) -> str:
    """Return a count, or a sum of fractions with one decimal."""
    return f"{count:.0f}" if float(count).is_integer() else f"{count:.1f}"


def plural(count: float, one: str, many: str | None = None) -> str:
    """Return a count with its noun: 1 study, 2 studies."""
    return f"{amount(count)} {one if count == 1 else many or one + 's'}"


def studies(count: float) -> str:
    """Return a number of studies in words."""
    return plural(count, "study", "studies")


def join_words(words: list[str]) -> str:
    """Return words as a sentence lists them: a, b and c."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} and {words[-1]}"
