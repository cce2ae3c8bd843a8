"""Reticles of equal slits read by the phase of all of their light (Periodic)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from algorithms.calibration.periodic_slits.model import PeriodicSlitModel
from algorithms.calibration.periodic_slits.pattern_fit import Raster
from algorithms.calibration.slit_sensor import NEEDS
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    UnsuitableDesignError,
)
from algorithms.documented import documented


@documented
@dataclass
class ReticlePhase(PeriodicSlitModel):
    """Reticle of equal slits over a line of pixels, located by the phase of its light.

    The light of all slits is correlated with the period of the reticle, so N slits are as precise
    as N measurements of one slit. The ends of the reticle identify the slits.

    Parameters
    ----------
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of each slit over a line; equal, on one
        raster without gaps.
    smallest_contrast : float
        Smallest contrast of the pattern that is accepted, in [0, 1); a half-open reticle has a
        contrast of 0.64, reduced by diffraction and the width of the Sun.

    Notes
    -----
    Implements: model:multiplex, model:periodic (Tsuno2019, Kondo2024). The survey prints no
    equation: ``phi = arg sum(I(u) exp(2 pi j u / p))``, over whole periods p, is the slits' common
    phase; of the shifts that it leaves open, whole periods apart, that is taken under which the
    reticle as a whole has most light, ours.
    The shifts of both lines make a spot, and height, deflection and inclination of the slits over
    each line, zero points and tilts are fitted to it as in the slit model (eq:slit).

    Failure: a NaN row for a NaN feature row, outside the cone of calibrated directions, where no
    place of the reticle has most light by 0.4 of a slit's, where a slit has less than 0.3 of their
    mean light, as beyond the end of a line, and where the phase has no contrast. fit raises
    UnusableDataError below 6 samples, and where they do not determine the parameters.

    Cost: 12 operations per pixel.

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

    def require_slits(self) -> None:
        """Equal slits, two pixels or more each, none missing."""
        super().require_slits()
        found = self.raster()
        if len(found.gaps) or found.period < 4.0:
            raise UnsuitableDesignError(
                f"{self.about.name} needs a raster of slits without gaps, four pixels a period or "
                f"more; got {self.slits!r}"
            )

    def read(self, lines: Floats, found: Raster, middle: float, shifts: Floats) -> None:
        """Write into `shifts` (M,) the pattern's, px, on lines (M, L) whose middle is given."""
        from algorithms.calibration.periodic_slits import phase_kernel  # noqa: PLC0415 - Numba, at first use

        waves = phase_kernel.waves(self.line_pixels, found.period)
        slits, contrast = found.slits + middle, self.smallest_contrast
        phase_kernel.correlate(lines, slits, found.period, waves, contrast, shifts)
