"""Parameters of a dataset as plain JSON values: exact numbers, and what type each object is."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from algorithms.contract import SensorGeometry
from benchmark.canonical import to_plain

#: Fields of the geometry that are written even where they are None; later ones are not.
_FIRST_GEOMETRY = frozenset(
    {
        "focal_length_mm",
        "pixel_pitch_mm",
        "centre_px",
        "aperture_width_mm",
        "aperture_shape",
        "face_normals",
        "half_fov_deg",
    }
)


def describe(value: object) -> Any:
    """Return dataclasses, mappings and tuples as JSON objects and arrays.

    A dataclass names its type.
    TypeError for a value without a spelling; ValueError for a number that is not finite.
    """
    return to_plain(value, _exact, _members)


def _exact(value: float) -> float:
    if not math.isfinite(value):
        raise ValueError(f"parameters must be finite; got {value!r}")
    return value


def _members(instance: Any) -> Mapping[str, object]:
    members = {f.name: getattr(instance, f.name) for f in dataclasses.fields(instance)}
    if isinstance(instance, SensorGeometry):
        # a field added for one architecture must not change the parameters of the others
        members = {
            name: item
            for name, item in members.items()
            if item is not None or name in _FIRST_GEOMETRY
        }
    return {"type": type(instance).__name__, **members}
