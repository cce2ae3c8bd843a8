"""Corrections of a saved calibration: numbers checked by name, and the settings they make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from algorithms.calibration.saving import UnreadableCalibrationError
from algorithms.contract import Floats
from calibrate.readings import MATRICES, raw_of
from calibrate.settings import Settings

#: Number that no reading reaches, and how far rows of a rotation may be from one.
_LARGEST, _ROTATES = 1e15, 1e-6


@dataclass(frozen=True)
class Corrected:
    """Features are now ``gain`` times what they were, plus ``offset``, and directions turned.

    Gain and offset are (F,) or one number.
    """

    offset: Floats
    gain: Floats
    rotation: Floats

    @classmethod
    def of(cls, stored: Any, settings: Settings) -> Self:
        """Return what a document has as its correction.

        UnreadableCalibrationError if one of its numbers is none; the message names it.
        """
        if not isinstance(stored, Mapping):
            raise UnreadableCalibrationError(f"correction must be a table; got {str(stored)[:60]}")
        count = features_in(settings)
        return cls(
            _one_or_each(stored.get("offset", 0.0), count, "correction.offset"),
            _one_or_each(stored.get("gain", 1.0), count, "correction.gain", above=0.0),
            _rotation(stored.get("rotation", np.eye(3).tolist())),
        )

    def then(self, offset: Floats, gain: Floats, rotation: Floats) -> Corrected:
        """Return the correction that this and a later one make together."""
        return Corrected(offset + gain * self.offset, gain * self.gain, rotation @ self.rotation)

    def settings(self, old: Settings) -> Settings:
        """Return settings whose dark level and gain have offset and gain; what is left is a turn.

        For flight software, which takes ``(reading - dark) / gain`` of every reading.
        """
        count = len(old.readings.columns)
        offset, gain = np.broadcast_to(self.offset, count), np.broadcast_to(self.gain, count)
        for transform in reversed(old.apply if count == 2 else ()):
            matrix = np.asarray(MATRICES[transform])  # axes changed places or signs, so its
            offset, gain = offset @ matrix, gain @ np.abs(matrix)  # transpose takes them back
        return with_changes(old, offset, gain)


def features_in(settings: Settings) -> int:
    """Count the features of a sample."""
    return len(settings.readings.columns) if settings.readings.kind == "channels" else 2


def of_features(settings: Settings, offset: Floats, gain: Floats) -> tuple[Floats, Floats]:
    """Return the offset and gain of features that those of two readings are."""
    for transform in settings.apply if len(gain) == 2 else ():
        matrix = np.asarray(MATRICES[transform])
        offset, gain = matrix @ offset, np.abs(matrix) @ gain
    return offset, gain


def with_changes(settings: Settings, offset: Floats, gain: Floats) -> Settings:
    """Return settings whose signals are less an offset (K,), over a gain (K,)."""
    stated = settings.readings
    made = stated.model_copy(
        update={
            "dark": tuple(float(v) for v in raw_of(offset, stated)),
            "gain": tuple(float(v) for v in np.asarray(stated.gain) * gain),
        }
    )
    return settings.model_copy(update={"readings": made})


def numbers(value: Any, shape: tuple[int, ...], name: str, above: float = -np.inf) -> Floats:
    """Return numbers of a document as an array.

    UnreadableCalibrationError if they are not of that shape, or one is no number, not above a
    limit, or so large that no reading is: 1e15 and more.
    """
    if not all(_is_number(one, above) for one in _flat(value)) or np.shape(value) != shape:
        wanted = " by ".join(str(size) for size in shape) or "one"
        limit = "" if np.isinf(above) else f" above {above:g}"
        raise UnreadableCalibrationError(
            f"{name} must be {wanted} finite number{'s' if shape else ''}{limit}; "
            f"got {str(value)[:60]}"
        )
    return np.asarray(value, dtype=np.float64)


def temperatures(value: Any) -> tuple[float, float]:
    """Return the lowest and the highest temperature of a document, as `numbers` does."""
    low, high = numbers(value, (2,), "fit.temperature_K").tolist()
    if not low <= high:
        raise UnreadableCalibrationError(f"fit.temperature_K must rise; got {low:g}, {high:g}")
    return low, high


def _is_number(value: Any, above: float) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return max(above, -_LARGEST) < value < _LARGEST


def _flat(value: Any) -> list[Any]:
    if not isinstance(value, list):
        return [value]
    return [one for inner in value for one in _flat(inner)]


def _one_or_each(value: Any, count: int, name: str, above: float = -np.inf) -> Floats:
    return numbers(value, (count,) if isinstance(value, list) else (), name, above)


def _rotation(value: Any) -> Floats:
    found = numbers(value, (3, 3), "correction.rotation")
    off = float(np.abs(found @ found.T - np.eye(3)).max())
    if not (off < _ROTATES and np.linalg.det(found) > 0):
        raise UnreadableCalibrationError(
            f"correction.rotation must be a rotation; rows are off from it by {off:.3g}"
        )
    return found
