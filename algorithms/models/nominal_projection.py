"""Where the design says a spot falls: from features to tangents of the Sun angles, uncalibrated.

A feature displaced from the centre by u moves the spot by ``u * unit_mm`` on the detector: the
pixel pitch for spots in pixels, half the aperture's width for balances of a quadrant photodiode.
"""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from algorithms.contract import AboutCompensation, AboutModel, FeatureKind, Floats, SensorGeometry
from algorithms.parameters import require_positive

POSITIONS = frozenset({FeatureKind.SPOT, FeatureKind.BALANCE})
"""The kinds of features that place one spot on a plane."""


class NominalProjection(TypedDict):
    """The design numbers every planar geometric model is made from."""

    focal_length_mm: float
    unit_mm: float
    centre: tuple[float, float]


def nominal_projection(
    geometry: SensorGeometry, kind: FeatureKind, about: AboutModel | AboutCompensation
) -> NominalProjection:
    """Focal length, unit and centre of a sensor's features.

    Raises
    ------
    UnsuitableDesignError
        If the model does not accept `kind` or the geometry lacks a field it takes:
        ``focal_length_mm`` always, ``pixel_pitch_mm`` and ``centre_px`` for spots,
        ``aperture_width_mm`` for balances.
    """
    about.require_kind(kind)
    if kind is FeatureKind.SPOT:
        geometry.require("focal_length_mm", "pixel_pitch_mm", "centre_px", by=about.name)
        unit, centre = geometry.pixel_pitch_mm, geometry.centre_px
    else:
        geometry.require("focal_length_mm", "aperture_width_mm", by=about.name)
        unit, centre = (geometry.aperture_width_mm or 0.0) / 2.0, (0.0, 0.0)
    return NominalProjection(
        focal_length_mm=geometry.focal_length_mm or 0.0,
        unit_mm=unit or 0.0,
        centre=centre or (0.0, 0.0),
    )


def require_projection(
    by: str, focal_length_mm: float, unit_mm: float, centre: tuple[float, float]
) -> None:
    """Raise ValueError unless lengths are positive and the centre is two finite numbers."""
    require_positive(by, focal_length_mm=focal_length_mm, unit_mm=unit_mm)
    if np.shape(centre) != (2,) or not np.isfinite(centre).all():
        raise ValueError(f"{by}: centre must be two finite numbers; got {centre!r}")


def nominal_tangents(
    features: Floats, focal_length_mm: float, unit_mm: float, centre: tuple[float, float]
) -> Floats:
    """``(tan(alpha), tan(beta))`` (N, 2) of features (x, y) (N, 2): alpha with y, beta with x."""
    tangents = np.empty_like(features)
    for column, middle in enumerate(centre):
        np.subtract(features[:, column], middle, out=tangents[:, 1 - column])
    tangents *= unit_mm / focal_length_mm
    return tangents
