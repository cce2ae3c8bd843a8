"""What both suites ask of an implementation: what it says of itself, and what it refuses."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from algorithms.contract import SensorGeometry, UnusableDataError


def same(first, second) -> None:
    """Equal to the last bit, NaN where NaN."""
    np.testing.assert_array_equal(first, second, strict=True)


def assert_metadata(implementation: Any) -> None:
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", implementation.about.name)
    assert implementation.about.taxonomy
    assert implementation.about.origin in {"survey", "ours"}
    assert isinstance(implementation.about.version, int)
    assert implementation.about.version >= 1
    fields = {field.name for field in dataclasses.fields(SensorGeometry)}
    assert set(implementation.about.needs) <= fields
    if implementation.about.origin == "survey":
        assert implementation.about.studies
        assert implementation.about.labels
    for key in implementation.about.studies:
        assert re.fullmatch(r"[A-Za-z]+\d{4}[a-z]?", key)
    for label in implementation.about.labels:
        assert re.fullmatch(r"(fe|model|alg|eq):[A-Za-z0-9]+", label)


def assert_documented(implementation: Any) -> None:
    text = implementation.__doc__
    for section in ("Implements:", "Shapes:", "Failure:", "Cost:"):
        assert section in text, f"{section} is missing"
    for mentioned in (*implementation.about.studies, *implementation.about.labels):
        assert mentioned in text, f"{mentioned} is not cited"
    for field in dataclasses.fields(implementation):
        assert re.search(rf"\b{field.name}\b", text) or not field.init, f"{field.name} is missing"


def assert_rejects(call: Callable[[Any], Any], wrong: dict[str, Any]) -> None:
    for what, value in wrong.items():
        with pytest.raises(ValueError, match=r"got|hold|must not be empty") as refusal:
            call(value)
        assert not isinstance(refusal.value, UnusableDataError), f"{what} is the caller's mistake"
        assert len(str(refusal.value)) < 400, what


def wrong_arrays(right: np.ndarray) -> dict[str, Any]:
    return {
        "one dimension too few": right[0],
        "one dimension too many": right[None],
        "a scalar": 3.0,
        "no samples": right[:0],
        "empty samples": right[..., :0],
        "strings": right.astype(str),
        "objects": right.astype(object),
        "complex numbers": right.astype(complex),
        "a mask": np.ma.masked_equal(right, right.ravel()[0]),
        "a ragged list": [[1.0, 2.0], [3.0]],
        "None": None,
    }
