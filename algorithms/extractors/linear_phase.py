"""Shift of a spot from the slope of its spectrum's phase (linear-phase)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, Self, get_args

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import FeatureKind, Floats, Observation, Origin, SensorGeometry
from algorithms.extractors.profile_peaks import require_one_spot
from algorithms.extractors.slit_lines import SlitLines, box_means, dark_level
from algorithms.extractors.spot_spectra import SpotSpectra
from algorithms.inputs import as_frames, require_positive

Shape = Literal["round", "square"]

#: Fits in turn, each in windows about the shift found before: the second already stays.
_PASSES = 2


@dataclass(frozen=True)
class LinearPhase(SlitLines):
    """Shift of the slits' light by the slope of its phase against a reference's.

    A shift multiplies a spectrum by a phase that grows linearly with frequency. Light blurred or
    narrowed evenly on both sides keeps its phase, so the reference need not have its width right.

    Parameters
    ----------
    line_axes, line_pixels, slits
        The lines and what is before them: see `SlitLines`.
    reach_px, margin_px
        Largest displacement, and how much a spot is wider than its slit: see `SlitLines`.
    lobes : float
        Frequencies are fitted up to this many times the first zero of the slit's spectrum.
        Ours: the study gives no limit. Above, light is as weak as its noise, and blur turns signs.

    Notes
    -----
    Implements: alg:linearphase (fe:linearphase, Enright2007b): ``Y[k] = S_a[k] / S_0[k]``, its
    phase ``Psi[k] = -2 pi a k / N``, the slope a by least squares, ``tau = a`` in pixels (Delta X
    = 1). Survey prints a plain fit over all k; corrected because bins without signal hold phases
    of noise only: each counts by ``|S_0[k]|^2``, and only low ones do. The reference S_0 is
    the spectrum of even light over the slit's width, known from the design; ``S_a conj(S_0)``
    has the phase of the ratio and no division. The shift is first found to about a pixel as the
    place where the pattern of slits is brightest (as PD does, on means over a slit's width), and
    the transform is that of a window about each spot, whose phases are summed over the slits of
    one slant: what is left to unwrap is a fraction of a turn, and the other spots stay out.

    Shapes: profiles (N, A L) of A lines, any unit, to ``(x_px, y_px)`` (N, 2), counted from the
    first pixel of a line whose middle is the sensor's.

    Failure: a NaN row for a profile without contrast (all dark or all saturated), one that holds
    a NaN or infinity, where a slit's spot is missing, cut by the line's end or covered by
    another's, and where light elsewhere is half as bright (a second Sun, noise alone).

    Cost: 2 operations a pixel and slit, the median of each line, and 8 a frequency and pixel of
    the windows, of which there are some 2 and 50.
    """

    name: ClassVar[str] = "linear-phase"
    taxonomy: ClassVar[str] = "Linear-phase"
    studies: ClassVar[tuple[str, ...]] = ("Enright2007b",)
    labels: ClassVar[tuple[str, ...]] = ("fe:linearphase", "alg:linearphase")
    origin: ClassVar[Origin] = "survey"
    version: ClassVar[int] = 1
    observation: ClassVar[Observation] = Observation.PROFILES
    kind: ClassVar[FeatureKind] = FeatureKind.SPOT

    lobes: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self.name, lobes=self.lobes)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in profiles (N, A L); ValueError on wrong input."""
        lines = self.lines(observations)
        floors = dark_level(lines)
        spectra = SpotSpectra.behind(self, padded=False, lobes=self.lobes)
        shifts = self.locate(lines, floors, smooth=True)
        return self.spots(_refined(spectra, lines, floors, shifts))


def _refined(spectra: SpotSpectra, lines: Floats, floors: Floats, shifts: Floats) -> Floats:
    """Shifts (R, G) moved by what is left of the phase's slope there."""
    from algorithms.kernels import slit_patterns  # noqa: PLC0415 - Numba, at first use

    step = np.empty(shifts.shape)
    for _ in range(_PASSES):
        cross = spectra.cross(lines, floors, shifts)
        slit_patterns.phase_slopes(cross, spectra.powers, spectra.period, step)
        shifts = shifts + step
    return shifts
