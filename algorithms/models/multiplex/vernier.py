"""Optical verniers: slits that gain on the marks of a fixed scale of pixels (Periodic)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

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
class OpticalVernier(PeriodicSlitModel):
    """Vernier: slits slightly farther apart than marks of three pixels each.

    As the Sun moves, one slit after the other passes its mark, so few large pixels resolve fine
    steps. Omitted slits form a position code, which gives the number of whole marks.

    Parameters
    ----------
    slits : tuple of (float, float, float)
        Position mm, slant deg and width mm of each slit over a line; equal, on one
        raster, some left out.

    Notes
    -----
    Implements: model:multiplex, model:periodic (Chen2006). The survey prints no equation. The
    position code ``sum(I at slits) - sum(I at gaps)`` tells the primary place to a pixel. Of each
    slit k at ``x_k`` the phase among marks of m pixels, m the whole pixels of its period, is ``arg
    sum(I(u) exp(2 pi j u / m))``; less what the vernier has gained, ``2 pi x_k / m``, it is the
    same for all slits, and their sum the pinpoint place. A slit's light in so few pixels has an
    error that depends on its phase; the slits of a vernier stand evenly over all phases, which
    cancels that. The shifts of both lines make a spot, and height, deflection and inclination of
    the slits over each line, zero points and tilts are fitted to it as in the slit model
    (eq:slit).

    Failure: a NaN row for a NaN feature row, outside the cone of calibrated directions, where no
    place shows the code by 0.4 of a slit's light more than all others, where a slit has less than
    0.3 of their mean light, and where the phase has no contrast. fit raises UnusableDataError
    below 6 samples, and where they do not determine the parameters.

    Cost: 20 operations per slit and place, a place a pixel: some 20 000 of 16 slits on 100 pixels.

    References
    ----------
    Chen2006; survey model:multiplex, model:periodic, model:slit, eq:slit.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> from algorithms.examples import slit_light, sun_grid
    >>> places = [0.32 * (k - 7.5) for k in range(16) if k not in (2, 11)]  # mm
    >>> design = dict(slits=tuple((place, 0.0, 0.15) for place in places), pixel_pitch_mm=0.1)
    >>> design |= dict(centre_px=(51.5, 51.5), line_axes=("x", "y"), line_pixels=104)
    >>> sun = sun_grid(range(-60, 61, 12))
    >>> model = OpticalVernier(1.02, **design).fit(slit_light(sun, 1.0, **design), sun)
    >>> found = model.predict(slit_light(sun_from_angles([[12.3, -4.5]]), 1.0, **design))
    >>> angles_from_sun(found).round(1)
    array([[12.3, -4.5]])
    """

    about: ClassVar = AboutModel(
        name="vernier",
        taxonomy="Periodic",
        studies=("Chen2006",),
        labels=("model:multiplex", "model:periodic"),
        origin="survey",
        needs=(*NEEDS, "line_pixels"),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    def require_slits(self) -> None:
        """Equal slits, some missing, that gain a part of a mark on each."""
        super().require_slits()
        found = self.raster()
        mark = int(found.period)
        if not (len(found.gaps) and mark >= 3 and 0.01 * mark < found.period - mark < 0.5):
            raise UnsuitableDesignError(
                f"{self.about.name} needs slits on a raster with gaps, a little farther apart than "
                f"three whole pixels or more; got {self.slits!r}"
            )

    def read(self, lines: Floats, found: Raster, middle: float, shifts: Floats) -> None:
        """Write into `shifts` (M,) the pattern's, px, on lines (M, L) whose middle is given."""
        from algorithms.calibration.periodic_slits import phase_kernel  # noqa: PLC0415 - Numba, at first use

        ends = np.array([found.slits[0] - found.period, found.slits[-1] + found.period])
        mark = int(found.period)
        phase_kernel.read_vernier(
            lines,
            found.slits + middle,
            np.append(found.gaps, ends) + middle,
            found.period,
            mark,
            phase_kernel.waves(self.line_pixels, mark),
            self.smallest_contrast,
            shifts,
        )
