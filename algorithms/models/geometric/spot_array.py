"""Beyond the survey: an array of apertures seen at once, each of which has a place of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.coded.built_places import BuiltMask
from algorithms.contract import AboutModel, FeatureKind, Floats, SensorGeometry
from algorithms.documented import documented
from algorithms.parameters import require_positive
from algorithms.spot_arrays import require_seen_at_once
from algorithms.spot_lists import SPOT_COLUMNS


@documented
@dataclass
class SpotArray(BuiltMask):
    """Direction of all spots together, freed of what apertures and pixels do to each.

    Apertures of a built mask are off by a micron; the calibration tells by how much, so that it
    does not matter which of them are seen. What the pixels' grid does to spots is alike for all of
    a frame but for their places on it, and is fitted with the direction.

    Parameters
    ----------
    apertures_px : tuple of (x, y, width)
        Positions of the apertures of the mask, px from its middle, in the order of the spots.
    focal_length_mm, pixel_pitch_mm : float
        Nominal distance from mask to detector, and distance between pixels; positive.
    centre_px : tuple of two float
        Point where the boresight meets the detector.
    layers : tuple of (thickness mm, index)
        Cover glass, as `algorithms.compensations.optics.refraction` has it.

    Notes
    -----
    Implements: nothing printed in the survey; see `algorithms.calibration.coded.built_places`. A
    frame's displacement D solves ``p_i - a_i - o_i = D + b sin(2 pi p_i)`` by weighed least
    squares, each axis by itself, with p the spots, a the drawn places and o the learned offsets;
    the sine is the bias of a first moment of light that pixels sample, b has a prior of 0.005 px.
    D is cast by ``c + t (f (1 + ...) ) / pitch`` through the cover glass, t the tangents, with
    three terms for light that lands farther outwards, as diffraction and windows make it.

    Shapes: ``(x_px, y_px, light)`` of the spot of each of A apertures (N, 3 A), light 0 where it is
    not seen, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, without spots, and outside the cone of calibrated
    directions. fit raises UnusableDataError below 5 samples, and where they do not determine the
    parameters.

    Cost: 20 operations per spot; the fit, 12 inversions of a matrix of all apertures.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> from algorithms.examples import sun_grid
    >>> holes = ((-20.0, -20.0, 5.0), (20.0, -18.0, 5.0), (0.0, 20.0, 5.0))
    >>> places = np.array(holes)[:, :2] + 100.0
    >>> def spots(sun):
    ...     at = places + 200.0 * (sun[:, :2] / sun[:, 2:])[:, None]
    ...     return np.dstack([at, np.ones(at.shape[:2])]).reshape(len(sun), -1)
    >>> sun = sun_grid(range(-30, 31, 10))
    >>> model = SpotArray(holes, 2.0, 0.01, (100.0, 100.0)).fit(spots(sun), sun)
    >>> angles_from_sun(model.predict(spots(sun_from_angles([[12.3, -4.5]])))).round(3)
    array([[12.3, -4.5]])
    """

    about: ClassVar = AboutModel(
        name="spot-array",
        taxonomy="None",
        origin="ours",
        needs=("focal_length_mm", "pixel_pitch_mm", "centre_px", "apertures"),
        accepts=frozenset({FeatureKind.SPOTS}),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        by, rows = self.about.name, np.array(self.apertures_px, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != 3 or not np.isfinite(rows).all():
            raise ValueError(
                f"{by}: apertures_px must be rows of finite x, y, width; got {rows.shape}"
            )
        require_positive(
            by, focal_length_mm=self.focal_length_mm, pixel_pitch_mm=self.pixel_pitch_mm
        )
        if not np.isfinite(self.centre_px).all() or np.shape(self.centre_px) != (2,):
            raise ValueError(f"{by}: centre_px must be two finite numbers; got {self.centre_px!r}")
        if any(not (thickness > 0 and index >= 1) for thickness, index in self.layers):
            raise ValueError(
                f"{by}: layers must be positive thicknesses with indices of at least 1; "
                f"got {self.layers!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the unfitted model of the sensor's mask.

        UnsuitableDesignError where the mask is larger than the detector.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        require_seen_at_once(geometry, cls.about.name)
        pitch = geometry.pixel_pitch_mm or 1.0
        return cls(
            apertures_px=tuple(
                (round(x / pitch, 6), round(y / pitch, 6), round(width / pitch, 6))
                for x, y, width in geometry.apertures or ()
            ),
            focal_length_mm=geometry.focal_length_mm or 0.0,
            pixel_pitch_mm=pitch,
            centre_px=geometry.centre_px or (0.0, 0.0),
            layers=geometry.cover_glass or (),
        )

    def columns(self) -> int:
        """Three an aperture."""
        return SPOT_COLUMNS * len(self.apertures_px)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Place apertures and fit the assembly by turns."""
        del context
        self.settle(*self._told(features), self._drawn(), sun)

    def answer(self, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of spots (N, 3 A)."""
        return super().answer(self._displaced(features), context)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the assembly's errors make, rad^2."""
        return super().variance(self._displaced(features), context)

    def _displaced(self, features: Floats) -> Floats:
        return self.displacements(*self._told(features), self._drawn())

    def _drawn(self) -> Floats:
        return np.array(self.apertures_px, dtype=np.float64)[:, :2]

    def _told(self, features: Floats) -> tuple[Floats, NDArray[np.int64]]:
        """Spots (N, A, 2) and the apertures (N, A) that cast them, -1 for none."""
        lists = features.reshape(len(features), -1, SPOT_COLUMNS)
        holes = np.where(lists[:, :, 2] > 0.0, np.arange(len(self.apertures_px)), -1)
        return lists[:, :, :2], holes
