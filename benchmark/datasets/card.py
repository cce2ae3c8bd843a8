"""Parameters of a dataset's conditions on its card: what they share is said once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def differences(base: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Any]:
    """Return the members of `other` that `base` does not have alike.

    Objects of the same members are compared member by member; anything else stands whole. Both
    are plain JSON objects; `other` has at least the members of `base`, else ValueError.
    """
    if not base.keys() <= other.keys():
        raise ValueError(
            f"no member of the first may be missing; got {sorted(base)} and {sorted(other)}"
        )
    found: dict[str, Any] = {}
    for name, value in other.items():
        if name not in base:
            found[name] = value
            continue
        before = base[name]
        if value == before:
            continue
        alike = isinstance(value, dict) and isinstance(before, dict)
        alike = alike and value.keys() == before.keys() and value.get("type") == before.get("type")
        found[name] = differences(before, value) if alike else value
    return found


def merge(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with what `differences` found in the place of what it has."""
    whole = dict(base)
    for name, value in changes.items():
        before = base.get(name)
        # a type among the changes says that the object stands whole
        if isinstance(value, dict) and isinstance(before, dict) and "type" not in value:
            whole[name] = merge(before, value)
        else:
            whole[name] = value
    return whole


def without_repeats(
    parameters: Mapping[str, Mapping[str, Any]], geometry: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """Return what conditions share, and by condition what it has of its own.

    Shared are the parameters of the first condition, without the geometry; `parameters_of` puts
    all together.
    """
    shared: dict[str, Any] = {}
    own: dict[str, dict[str, Any]] = {}
    for name, whole in parameters.items():
        plain = {member: value for member, value in whole.items() if member != "geometry"}
        shared = shared or plain
        own[name] = {"parameters": differences(shared, plain)}
        if whole["geometry"] != geometry:
            own[name]["geometry"] = whole["geometry"]
    return shared, own


def stream_names(name: str, version: int) -> dict[str, Any]:
    """Return the names of a dataset's random streams."""
    return {
        "generator": "NumPy PCG64, SeedSequence over the SHA-256 of the stream's names",
        "unit": [name, version, "unit"],
        "samples": [name, version, "<split>"],
        "noise": [name, version, "<condition>", "<split>"],
        "references": [name, version, "<condition>", "references"],
        "calibration": [name, version, "bench"],
        "other_units": 'unit, noise and calibration: [..., "unit", <number>]',
    }


def parameters_of(card: Mapping[str, Any], condition: str) -> dict[str, Any]:
    """Return the parameters of a condition from a dataset's card, as `Preset.parameters`."""
    about = card["conditions"][condition]
    whole = merge(card["parameters"], about["parameters"])
    return {**whole, "geometry": about.get("geometry", card["geometry"])}
