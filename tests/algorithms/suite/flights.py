"""A body that turns with its sensor: features of the Sun in the order of time, and a gyroscope."""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.angles import sun_from_angles
from algorithms.contract import FeatureKind, SensorGeometry

STEPS, STEP_S = 120, 10.0


def path(kind: FeatureKind) -> np.ndarray:
    """(T, 3) the Sun in the body: all over the sphere for faces, else ahead."""
    k = np.arange(STEPS)
    if kind is FeatureKind.SIGNALS:
        turn, height = 0.13 * k, np.radians(80.0) * np.sin(0.037 * k)
        level = np.cos(height)
        return np.column_stack([level * np.cos(turn), level * np.sin(turn), np.sin(height)])
    return sun_from_angles(25.0 * np.column_stack([np.sin(0.071 * k), np.cos(0.113 * k)]))


def rates_deg_s(sun: np.ndarray) -> np.ndarray:
    """(T, 3) the shortest turn of the body from each Sun to the next, over the step."""
    before = np.vstack([sun[:1], sun[:-1]])
    axis = np.cross(before, sun)
    sine = np.linalg.norm(axis, axis=1, keepdims=True)
    angle = np.arctan2(sine, (before * sun).sum(axis=1, keepdims=True))
    # the body turns one way, what it sees the other
    return -np.degrees(angle * axis / np.where(sine > 0, sine, 1.0)) / STEP_S


def features_of(kind: FeatureKind, sun: np.ndarray, geometry: SensorGeometry) -> np.ndarray:
    """What the sensor as drawn reads, with a thousandth of noise."""
    rng = np.random.default_rng(23)
    if kind is FeatureKind.SIGNALS:
        lit = np.maximum(sun @ np.array(geometry.face_normals).T, 0.0)
        return lit + 1e-3 * rng.standard_normal(lit.shape)
    tangents = sun[:, :2] / sun[:, 2:]
    if kind is FeatureKind.BALANCE:
        balances = 2.0 * geometry.focal_length_mm / geometry.aperture_width_mm * tangents
        return balances + 1e-3 * rng.standard_normal(balances.shape)
    scale = geometry.focal_length_mm / geometry.pixel_pitch_mm
    spots = np.array(geometry.centre_px) + scale * tangents
    return spots + 0.1 * rng.standard_normal(spots.shape)


def flight(kind: FeatureKind, geometry: SensorGeometry) -> dict[str, Any]:
    """Features, Suns and context of a flight in sunlight, over a black Earth."""
    sun, k = path(kind), np.arange(STEPS)
    height, turn = np.sin(0.05 * k), 0.21 * k
    level = np.sqrt(1.0 - height**2)
    return {
        "features": features_of(kind, sun, geometry),
        "sun": sun,
        "context": {
            "time_s": STEP_S * k,
            "rate_deg_s": rates_deg_s(sun),
            "eclipse": np.zeros(STEPS),
            "nadir": np.column_stack([level * np.cos(turn), level * np.sin(turn), height]),
            "temperature_K": 290.0 + 10.0 * np.sin(0.09 * k),
        },
    }
