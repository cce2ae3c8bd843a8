"""Shift of a spot from the slope of its spectrum's phase (linear-phase)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.extractors.profiles.single_spot import require_one_spot, spot_size_px
from algorithms.extractors.profiles.slit_lines import NEEDS, SlitLines, box_means
from algorithms.extractors.profiles.spot_spectra import (
    PASSES,
    Shape,
    SpotSpectra,
    require_frequencies,
)
from algorithms.inputs import as_frames
from algorithms.parameters import require_choice, require_positive


@documented
@dataclass(frozen=True)
class LinearPhase(SlitLines):
    """Shift of the slits' light from the slope of its phase relative to a reference.

    A shift multiplies a spectrum by a phase that grows linearly with frequency. Symmetric blur or
    narrowing does not change the phase, so the width of the reference need not be exact.

    Parameters
    ----------
    frequencies : int or None
        How many frequencies from the lowest on are fitted. The study gives no limit. None, ours,
        takes those whose power exceeds nine times the noise, estimated from the spectrum above a
        quarter of the sampling frequency.

    Notes
    -----
    Implements: alg:linearphase (fe:linearphase, Enright2007b): ``Y[k] = S_a[k] / S_0[k]``, its
    phase ``Psi[k] = -2 pi a k / N``, the slope a by least squares, ``tau = a`` in pixels (Delta X
    = 1). The survey prints a plain fit over all k; corrected because bins without signal hold
    phases of noise only: each counts by ``|S_a[k]|^2``, less the noise's, and only those above it
    do. The reference S_0 is the spectrum of even light over the slit's width, known from the
    design; ``S_a conj(S_0)`` has the phase of the ratio and no division. Beyond the reference's
    first zero a little less width turns the sign, so that phases there are known to half a turn.
    The shift is first found to about a pixel as the place where the pattern of slits is brightest
    (as PD does, on means over a slit's width), and the transform is that of a window about each
    spot, whose phases are summed over the slits of one slant: what is left to unwrap is a fraction
    of a turn, and the other spots stay out.

    Cost: 2 operations per pixel and slit, the median of each line, and 8 per frequency and pixel of
    the windows, half as many as pixels.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> LinearPhase(**design).extract(profiles).round(1)
    array([[43.3, 36.8]])
    """

    about: ClassVar = AboutExtractor(
        name="linear-phase",
        taxonomy="Linear-phase",
        studies=("Enright2007b",),
        labels=("fe:linearphase", "alg:linearphase"),
        origin="survey",
        needs=NEEDS,
        version=2,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    frequencies: int | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        require_frequencies(self.frequencies, self.about.name)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in profiles (N, A L); ValueError on wrong input."""
        spectra = SpotSpectra.behind(self, padded=False)
        step = partial(spectra.slopes, last=self.frequencies)
        return self.spots(spectra.shifts(self, observations, step))


@documented
@dataclass(frozen=True)
class FrameLinearPhase(Extractor):
    """Position of a spot from the phase slopes of its column and row sums.

    As `LinearPhase`, once for each axis. The sums of a symmetric spot, blurred or not, have the
    phase of their shift alone.

    Parameters
    ----------
    width_px : float
        Width of the spot, px: the aperture's diameter or side, or more by diffraction.
    shape : {"round", "square"}
        Its shape; a square's sides lie along the pixels.
    margin_px : float
        Widening of the spot beyond that on each side.
    frequencies : int or None
        How many frequencies from the lowest on are fitted; None as in `LinearPhase`.

    Notes
    -----
    Implements: alg:linearphase (fe:linearphase, Enright2007b) on the sums by columns and rows. The
    survey prints a plain fit over all k; corrected because bins without signal hold phases of
    noise only: each counts by ``|S_a[k]|^2``, as in `LinearPhase`. The reference S_0 is the
    spectrum of the aperture's even light, summed. The spot is first found to about a pixel where
    the sums over half of its width are largest; the transform is that of the sums over a square
    window about it, so that pixels without light add no noise.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame without contrast (all dark or all saturated), one that holds a
    NaN or infinity, where the window leaves the frame (spot cut by the edge), and where sums
    elsewhere are half as large as the spot's (a second Sun, noise alone).

    Cost: 2 operations per pixel for the sums, 4 per pixel of the window and 16 per frequency and
    column of it, half as many as columns.

    Examples
    --------
    >>> from algorithms.examples import disc_frame
    >>> frames = disc_frame(16.3, 14.8)
    >>> FrameLinearPhase(width_px=10.0).extract(frames).round(1)
    array([[16.3, 14.8]])
    """

    about: ClassVar = AboutExtractor(
        name="linear-phase-frame",
        taxonomy="Linear-phase",
        studies=("Enright2007b",),
        labels=("fe:linearphase", "alg:linearphase"),
        origin="survey",
        needs=(
            "focal_length_mm",
            "pixel_pitch_mm",
            "aperture_width_mm",
            "aperture_shape",
            "half_fov_deg",
        ),
        version=2,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    width_px: float
    shape: Shape = "round"
    margin_px: float = 3.0
    frequencies: int | None = None

    def __post_init__(self) -> None:
        require_positive(self.about.name, width_px=self.width_px, margin_px=self.margin_px)
        require_frequencies(self.frequencies, self.about.name)
        require_choice(self.about.name, Shape, shape=self.shape)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's aperture as its reference.

        ValueError where a field of `needs` is None, or where the mask has many apertures or
        slits: their spots are not one.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        require_one_spot(geometry, cls.about.name)
        shape = geometry.aperture_shape
        if shape is None:  # said above; for the type checker
            raise UnsuitableDesignError(
                f"{cls.about.name} needs the sensor geometry's aperture_shape; got None"
            )
        width, margin = spot_size_px(geometry, cls.about.name)
        return cls(width, shape, margin)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.kernels import moments, window_sums  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        count, (columns, rows) = len(frames), moments.axis_sums(frames)
        unusable = moments.unusable_frames(frames)
        columns[unusable] = 0
        rows[unusable] = 0
        half = math.ceil(self.width_px / 2.0 + self.margin_px)
        found = np.column_stack(
            [self._near(sums.astype(np.float64), half) for sums in (columns, rows)]
        )
        spectra = SpotSpectra.of(
            np.array([float(half)]),
            np.zeros(1, dtype=np.int64),
            [self.width_px],
            self.shape,
            half,
            padded=False,
        )
        windows = np.empty((count, 2, 2 * half + 1))
        none = np.zeros(2 * count)
        for _ in range(PASSES):
            unseen = np.isnan(found).any(axis=1)
            found[unseen] = -1.0  # a window about no pixel leaves the frame
            centres = np.rint(found).astype(np.int64)
            window_sums.window_profiles(frames, centres, half, windows)
            cross = spectra.cross(windows.reshape(2 * count, -1), none, none[:, None])
            step = spectra.slopes(cross, self.frequencies)
            found = np.asarray(centres + step.reshape(count, 2), dtype=np.float64)
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found

    def _near(self, sums: Floats, half: int) -> Floats:
        """Positions (N,) in sums (N, L) to about a pixel; NaN where no one spot stands out."""
        from algorithms.kernels import slit_patterns  # noqa: PLC0415 - Numba, at first use

        box = 2 * int(self.width_px / 4.0) + 1
        near = np.empty((len(sums), 1))
        slit_patterns.match(
            box_means(sums, box),
            sums.min(axis=1),
            np.zeros(1, dtype=np.int64),
            np.zeros(1, dtype=np.int64),
            np.zeros(1),
            0.0,
            0.0,
            half + box // 2,
            0,
            near,
        )
        return near[:, 0]
