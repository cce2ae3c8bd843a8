"""Reticles of equal slits read by the phase of all of their light (Periodic)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.rulers.lines import raster, spots_of
from algorithms.calibration.slit_sensor import NEEDS
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.inputs import require_positive
from algorithms.models.geometric.single_slit import DeflectedSlits


@documented
@dataclass
class ReticlePhase(DeflectedSlits):
    """A reticle of equal slits over a line of pixels, placed by the phase of all of its light.

    All slits are read together: the light is correlated with the reticle's period, so that N slits
    are as precise as N measurements of one. The reticle's ends tell which slit is which.

    Parameters
    ----------
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of each slit over a line; equal, on one
        raster without gaps.
    smallest_contrast : float
        Length of the phase over the light, in [0, 1), below which it says nothing;
        a half-open reticle gives 0.64 less what diffraction and the Sun's width take.

    Attributes
    ----------
    vector_ : ndarray, shape (10,)
        Of the assembly, as of the slit model: focal length, deflection and inclination of each
        line, mm and degrees; centre (x, y) in px; tilts about x and y in degrees.

    Notes
    -----
    Implements: model:multiplex, model:periodic (Tsuno2019, Kondo2024). The survey prints no
    equation: ``phi = arg sum(I(u) exp(2 pi j u / p))``, over whole periods p, is the slits' common
    phase; of the shifts that it leaves open, whole periods apart, that is taken under which the
    reticle as a whole has most light, ours.
    The shifts of both lines make a spot, and height, deflection and inclination of the slits over
    each line, zero points and tilts are fitted to it as in the slit model (eq:slit).

    Shapes: signals (N, 2 L), the light of L pixels of one line and then the other, in any unit, to
    unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, outside the cone of calibrated directions, where no
    place of the reticle has most light by 0.4 of a slit's, where a slit has less than 0.3 of their
    mean light, as beyond the end of a line, and where the phase has no contrast.
    fit raises UnusableDataError below 6 samples, and where they do not settle the parameters.

    Cost: 12 operations a pixel.

    References
    ----------
    Tsuno2019, Kondo2024; survey model:multiplex, model:periodic, model:slit, eq:slit.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> from algorithms.examples import slit_light, sun_grid
    >>> places = (-1.5, -0.5, 0.5, 1.5)  # mm
    >>> design = dict(slits=tuple((place, 0.0, 0.5) for place in places), pixel_pitch_mm=0.1)
    >>> design |= dict(centre_px=(99.5, 99.5), line_axes=("x", "y"), line_pixels=200)
    >>> sun = sun_grid(range(-50, 51, 10))
    >>> model = ReticlePhase(2.9, **design).fit(slit_light(sun, 3.0, **design), sun)
    >>> found = model.predict(slit_light(sun_from_angles([[12.3, -4.5]]), 3.0, **design))
    >>> angles_from_sun(found).round(1)
    array([[12.3, -4.5]])
    """

    about: ClassVar = AboutModel(
        name="reticle",
        taxonomy="Periodic",
        studies=("Tsuno2019", "Kondo2024"),
        labels=("model:multiplex", "model:periodic"),
        origin="survey",
        needs=(*NEEDS, "line_pixels"),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    line_pixels: int = field(kw_only=True)
    smallest_contrast: float = field(default=0.05, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self.about.name, line_pixels=self.line_pixels)
        if not 0.0 <= self.smallest_contrast < 1.0:
            raise ValueError(
                f"{self.about.name}: smallest_contrast must be in [0, 1); "
                f"got {self.smallest_contrast!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model of the sensor's slits.

        UnsuitableDesignError where they are no reticle, or narrower than four pixels a period.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls(
            focal_length_mm=geometry.focal_length_mm or 0.0,
            pixel_pitch_mm=geometry.pixel_pitch_mm or 0.0,
            centre_px=geometry.centre_px or (0.0, 0.0),
            line_axes=geometry.line_axes or (),
            slits=geometry.slits or (),
            cover_glass=geometry.cover_glass or (),
            line_pixels=geometry.line_pixels or 0,
        )

    def require_slits(self) -> None:
        """Equal slits, two pixels or more each, none missing."""
        super().require_slits()
        found = raster(self.slits, self.pixel_pitch_mm, self.about.name)
        if len(found.gaps) or found.period < 4.0:
            raise UnsuitableDesignError(
                f"{self.about.name} needs a raster of slits without gaps, four pixels a period or "
                f"more; got {self.slits!r}"
            )

    def columns(self) -> int:
        """Pixels of both lines."""
        return 2 * self.line_pixels

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the assembly to the shifts of the pattern."""
        spots = self.spots(features)
        seen = np.isfinite(spots[:, 0])
        super().learn(spots[seen], sun[seen], context)

    def answer(self, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of signals (N, 2 L)."""
        return super().answer(self.spots(features), context)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the assembly's errors make, rad^2."""
        return super().variance(self.spots(features), context)

    def spots(self, features: Floats) -> Floats:
        """(N, 2) px of the pattern's middle in signals (N, 2 L); NaN where it is not seen."""
        from algorithms.calibration.rulers import phase_kernel  # noqa: PLC0415 - Numba, at first use

        lines = np.ascontiguousarray(features).reshape(-1, self.line_pixels)
        found = raster(self.slits, self.pixel_pitch_mm, self.about.name)
        middle = (self.line_pixels - 1) / 2.0
        shifts = np.empty(len(lines))
        phase_kernel.correlate(
            lines,
            found.slits + middle,
            found.period,
            phase_kernel.waves(self.line_pixels, found.period),
            self.smallest_contrast,
            shifts,
        )
        return spots_of(shifts.reshape(-1, 2), self.line_axes, middle)
