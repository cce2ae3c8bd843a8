"""The question of the home page: its form, and requirements in words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from api.pages.study import NAMES
from api.pages.terms import display_text
from api.service.knowledge import Knowledge
from registry.ranking import SORTS
from registry.requirements import HAZARDS, MISSIONS, NEEDS, PARAMETERS, SETTINGS
from registry.taxonomy import ATTRIBUTES

#: What is not asked in the sentence but is a number: label, unit, largest value.
NUMBERS = {
    "min_availability": ("Availability at least, as a share", "", 1),
    "max_latency_us": ("Time per sample at most", "µs", None),
    "max_mass_g": ("Mass at most", "g", None),
    "max_power_mw": ("Power at most", "mW", None),
    "min_rate_hz": ("Updates a second at least", "Hz", None),
    "sun_distance_au": ("Distance from the Sun", "au", 100),
}
SHARES = {
    "": "9 of 10",
    "0.5": "5 of 10",
    "0.8": "8 of 10",
    "0.95": "19 of 20",
    "0.99": "99 of 100",
}
ORDERS = dict(zip(SORTS, ("evidence, then error", "error", "number of studies"), strict=True))
KINDS = {"reported": "reported", "measured": "measured here", "both": "both reported and measured"}
LEVELS_SAID = {"own": "own, of sensor and method"}
_SAID = {
    "max_error_deg": "error at most {:g}°",
    "min_fov_deg": "full field of at least {:g}°",
    "min_availability": "availability at least {:g}",
    "max_latency_us": "at most {:g} µs a sample",
    "max_mass_g": "mass at most {:g} g",
    "max_power_mw": "power at most {:g} mW",
    "min_rate_hz": "at least {:g} updates a second",
    "bench_deg": "calibration bench good to {:g}°",
    "confidence": "{:g} of units and benches",
    "sun_distance_au": "{:g} au from the Sun",
    "processor": "processor {}",
    "evidence": "evidence {}",
    "level": "{} error",
    "mission": "mission {}",
}
_LISTS = {
    "tolerate": ("tolerates", "and"),
    "properties": ("extractor property", "and"),
    "exclude_needs": ("without", "or"),
}


def said(name: str, value: Any) -> str:
    """Return a requirement in words."""
    if name in _SAID:
        return _SAID[name].format(value)
    if name in _LISTS:
        words, join = _LISTS[name]
        return f"{words} {f' {join} '.join(value)}"
    subject = NAMES[name.removeprefix("exclude_")].lower()
    unwanted = name.startswith("exclude_")
    return f"{subject} {'not ' if unwanted else ''}{(' nor ' if unwanted else ' or ').join(value)}"


def clauses(requirements: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield name and words of each requirement, in the order of the document."""
    for name in ("mission", *PARAMETERS, *SETTINGS):
        if name in requirements:
            yield name, said(name, requirements[name])


def form(
    known: Knowledge, fields: Sequence[tuple[str, str]], requirements: Mapping[str, Any]
) -> dict[str, Any]:
    """Return what the form is made of.

    Parameters
    ----------
    known : whose taxonomy
    fields : of the address, which fill the form
    requirements : as they were read, with those of a mission; empty for a refused question
    """
    filled: dict[str, list[str]] = {}
    for name, value in fields:
        filled.setdefault(name, []).append(value)
    values = {name: _values(known, name) for name in ATTRIBUTES}
    checks = [
        *((name, f"{NAMES[name]}, one of", values[name]) for name in ("task", "accuracy", "error")),
        ("tolerate", "Must tolerate all of", [(h, f"{h}: {w}") for h, w in HAZARDS.items()]),
        *((name, f"{NAMES[name]}, one of", values[name]) for name in ("model", "extractor")),
        ("properties", "Extractor properties, all of", _same(known.facts.properties)),
        ("exclude_needs", "Do without", _same(NEEDS)),
        *((name, f"Further {NAMES[name].lower()}s", values[name]) for name in ("detector", "mask")),
        *((f"exclude_{name}", f"Exclude {NAMES[name].lower()}", values[name]) for name in values),
    ]
    # The sentence asks for the first detector and mask; the boxes for the others.
    boxes = {**filled, **{name: filled.get(name, [])[1:] for name in ("detector", "mask")}}
    asked_for = [name for name, _, _ in checks if boxes.get(name)]
    return {
        "filled": filled,
        "boxes": boxes,
        "implied": {
            name: f"{value:g}" if isinstance(value, float) else value
            for name, value in requirements.items()
        },
        "detector": _short(known, "detector"),
        "mask": _short(known, "mask"),
        "checks": checks,
        "numbers": NUMBERS,
        "shares": SHARES,
        "orders": ORDERS,
        "kinds": KINDS,
        "levels": LEVELS_SAID,
        "missions": _same(MISSIONS),
        "more": len(asked_for) + sum(name in filled for name in (*NUMBERS, *_CHOSEN)),
    }


_CHOSEN = ("processor", "evidence", "level", "sort", "edition")


def _values(known: Knowledge, attribute: str) -> list[tuple[str, str]]:
    entries = known.taxonomy.to_dict()[attribute]
    return [(e["value"], _with_name(e["value"], e["name"], attribute)) for e in entries]


def _short(known: Knowledge, attribute: str) -> list[tuple[str, str]]:
    return [(v, display_text(v, attribute)) for v in known.taxonomy.values(attribute)]


def _with_name(value: str, name: str, attribute: str) -> str:
    shown = display_text(value, attribute)
    return shown if name in {"", value} or shown != value else f"{value}: {name}"


def _same(words: Iterable[str]) -> list[tuple[str, str]]:
    return [(word, word) for word in words]
