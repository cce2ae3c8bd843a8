"""Which conditions of a data set try what a sensor may have to survive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

TRIED: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "albedo": ("albedo", "albedo-clouds"),
        "missing-apertures": ("missing-apertures",),
        "ageing": ("aged", "dead-pixels"),
        "temperature": ("hot", "cold"),
        "misalignment": ("misaligned",),
        "glare": ("glare", "ghosts", "stray-gradient", "stray-light"),
        "saturation": ("saturated", "saturation-clouds"),
        "spin": ("spinning",),
        "noise": ("high-noise",),
    }
)
"""Hazard (`registry.requirements.HAZARDS`) -> names of the conditions that try it."""

#: Where this condition stands, every other one is under the Earth's light, the first too.
_WITHOUT_ALBEDO = "no-albedo"


def hazards(conditions: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Return the hazards that the conditions of a data set try, and by which of them each."""
    found = {
        hazard: tuple(name for name in conditions if name in names)
        for hazard, names in TRIED.items()
    }
    if _WITHOUT_ALBEDO in conditions:
        found["albedo"] = (conditions[0], *found["albedo"])
    return {hazard: names for hazard, names in found.items() if names}
