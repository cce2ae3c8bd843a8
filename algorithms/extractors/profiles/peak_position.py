"""Positions of peaks whose image is known, by nonlinear least squares (PPE)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
)
from algorithms.documented import documented
from algorithms.extractors.profiles.single_spot import require_one_spot
from algorithms.extractors.profiles.slit_lines import NEEDS, SlitLines, box_means, dark_level
from algorithms.inputs import as_frames
from algorithms.parameters import require_at_least, require_choice, require_positive

Image = Literal["rational", "gaussian", "diffraction"]
Coefficients = tuple[float, float, float, float, float, float]

#: Rational image of a slit, fitted to a shadow whose edges are blurred by 0.3 of its half width
#: (standard deviation): what the Sun does to a slit some 30 of its widths above the pixels.
SLIT_IMAGE: Coefficients = (0.0, -0.26, 1.0, 0.98, -0.42, 1.0)


@documented
@dataclass(frozen=True)
class PeakPositionEstimate(SlitLines):
    """Joint least-squares fit of all peaks of a line, one per slit.

    All peaks of slits with the same slant move by one shift and keep their known distances; each
    has its own amplitude. All lit pixels are used, not only the brightest; overlapping peaks are
    separated by subtracting the others.

    Parameters
    ----------
    image : {"rational", "gaussian", "diffraction"}
        Light of a peak against u, the distance from its middle in halves of the slit's width: a
        ratio of polynomials; a Gaussian; or the far field of a slit, ``(sin(x) / x)^2``. The
        latter two have their half at ``u = 1``.
    coefficients : tuple of six float
        ``c_1 .. c_6`` of the rational image; its denominator must have no zero. The survey gives
        no values; the default is fitted to a slit's blurred shadow.
    overlap : float
        Distance of peaks of two slants, in half widths, below which they share one amplitude.
    tolerance : float
        The fit ends when a step changes the amplitudes by less than this fraction, and the shifts
        by less than this fraction of a half width.

    Notes
    -----
    Implements: alg:PPE (fe:ppe, Enright2007a): ``I(tau) = a_1 A + a_2 B + b_1 C + b_2 D``, A and B
    the image about ``m_x`` and ``m_x + 2 L_x``, C and D about ``m_y`` and ``m_y + 2 L_y``, the
    image ``(c_1 u^4 + c_2 u^2 + c_3) / (c_4 u^4 + c_5 u^2 + c_6)``, Q its derivatives and ``(Q^T
    Q) d_lambda = Q^T d_beta``. The survey prints no update of the parameters; corrected because
    they move by ``lambda + d_lambda``. The image types are read from the shifts, at the start and
    once more when fitted: 0 where peaks are apart, 1 to 4 where A and C, B and C, A and D, or B
    and D overlap, which then have one amplitude. Shifts are found to a pixel first, as the
    maxi-min of the pattern; a step is held to half a half width. The median of each line is
    subtracted. Ours: any number of slits a slant, lines that see one slant only, and two means to
    make the steps end: the pixels that count are chosen once at the start and once at the end, and
    steps that shrink by a constant ratio are summed at once.

    Failure: a NaN row for a profile without contrast (all dark or all saturated), one that holds
    a NaN or infinity, where a slit's spot is missing or off the line, where light elsewhere is
    half as bright as the pattern's darkest peak (a second Sun, noise alone), and where the fit
    does not end, or not within a spot's width of its start with all amplitudes positive.

    Cost: 1 operation per pixel and slit to start, 40 per pixel near a peak and step, some 8 steps.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> PeakPositionEstimate(**design).extract(profiles).round(1)
    array([[43.3, 36.8]])
    """

    about: ClassVar = AboutExtractor(
        name="ppe",
        taxonomy="PPE",
        studies=("Enright2007a",),
        labels=("fe:ppe", "alg:PPE"),
        origin="survey",
        version=3,
        needs=NEEDS,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    image: Image = "rational"
    coefficients: Coefficients = SLIT_IMAGE
    overlap: float = 1.0
    tolerance: float = 1e-5
    iterations: int = 30

    def __post_init__(self) -> None:
        super().__post_init__()
        _require_image(self.about.name, self.image, self.coefficients)
        _require_limits(self.about.name, self.tolerance, self.iterations)
        if not (math.isfinite(self.overlap) and self.overlap >= 0):
            raise ValueError(
                f"{self.about.name}: overlap must be finite and not negative; got {self.overlap!r}"
            )

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in profiles (N, A L); ValueError on wrong input."""
        shifts, _ = self.fit(observations)
        return self.spots(shifts)

    def image_types(self, observations: ArrayLike) -> NDArray[np.int64]:
        """Overlapping peaks (N A, 2) of each line, as indices of slits; -1 where none overlap.

        Of two pairs of slits, (0, 2), (1, 2), (0, 3) and (1, 3) are the image types 1 to 4.
        """
        return self.fit(observations)[1]

    def fit(self, observations: ArrayLike) -> tuple[Floats, NDArray[np.int64]]:
        """Shifts (N A, G) of each line's slants, px, and its overlapping peaks (N A, 2)."""
        lines = self.lines(observations)
        floors = dark_level(lines)
        # a pixel sees no image narrower than itself
        halves = np.tile([max(slit[2], 1.0) / 2.0 for slit in self.slits], (len(lines), 1))
        return _fit(
            lines,
            floors,
            self._starts(lines, floors),
            places=self.pattern(),
            groups=self.groups,
            halves=halves,
            image=self.image,
            coefficients=self.coefficients,
            overlap=self.overlap,
            tolerance=self.tolerance,
            iterations=self.iterations,
        )

    def _starts(self, lines: Floats, floors: Floats) -> Floats:
        """Shifts (N A, G) to about a pixel; peaks of two slants may lie on each other.

        They may where each slant has several slits, whose distances tell which is which. If some
        peak is then left over, both patterns were put on the brighter one, and have to keep apart.
        """
        if len(self.tangents) == 1 or min(np.bincount(self.groups)) == 1:
            return self.locate(lines, floors)
        starts = self._over_each_other(lines, floors)
        left = np.isnan(starts).any(axis=1)
        if left.any():
            starts[left] = self.locate(lines[left], floors[left])
        return starts

    def _over_each_other(self, lines: Floats, floors: Floats) -> Floats:
        """Shifts (N A, G) as `locate` finds them, with spots that need not keep apart."""
        from algorithms.kernels import slit_patterns  # noqa: PLC0415 - Numba, at first use

        width = min(slit[2] for slit in self.slits)
        box = 2 * int((width - 1.0) // 2.0) + 1 if width >= 1.0 else 1
        starts = np.empty((len(lines), len(self.tangents)))
        slit_patterns.match(
            box_means(lines, box),
            floors,
            np.rint(self.pattern()).astype(np.int64),
            self.groups,
            np.array(self.tangents),
            self.reach_px,
            0.0,
            self.half_px + box // 2,
            math.ceil(max(slit[2] for slit in self.slits)),
            starts,
        )
        return starts


@documented
@dataclass(frozen=True)
class FramePeakPositionEstimate(Extractor):
    """Least-squares fit of a known peak shape to the column sums and row sums of a frame.

    One spot casts one peak on each profile; its position and amplitude are fitted there. All
    pixels are used, so the noise of dark pixels contributes.

    Parameters
    ----------
    image : {"rational", "gaussian", "diffraction"}
        Light of a peak against the distance from its middle in half widths: see
        `PeakPositionEstimate`.
    coefficients : tuple of six float
        ``c_1 .. c_6`` of the rational image; its denominator must have no zero.
    width_px : float or None
        Width of the peaks at half their height. None takes it from the profile: its light over
        its largest value.
    tolerance : float
        The fit ends when a step changes the amplitude by less than this fraction, and the
        position by less than this fraction of a half width.

    Notes
    -----
    Implements: alg:PPE (fe:ppe, Enright2007a) with the single peaks ``a_1 A`` along x and ``b_1
    C`` along y; see `PeakPositionEstimate`. Ours: the printed method reads a line of pixels behind
    crossed pairs of slits. The median of each profile is subtracted.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame without contrast (all dark or all saturated), one that holds a
    NaN or infinity, and where the fit does not end, or not within a spot's width of the profile's
    largest value with a positive amplitude. A second spot shifts the answer undetected; noise
    alone may be fitted.

    Cost: 2 operations per pixel, 20 per pixel of the profiles and step, some 8 steps.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> FramePeakPositionEstimate(image="gaussian").extract(frames).round(2)
    array([[12.3,  9.8]])
    """

    about: ClassVar = AboutExtractor(
        name="ppe-frame",
        taxonomy="PPE",
        studies=("Enright2007a",),
        labels=("fe:ppe", "alg:PPE"),
        origin="survey",
        version=2,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    image: Image = "rational"
    coefficients: Coefficients = SLIT_IMAGE
    width_px: float | None = None
    tolerance: float = 1e-5
    iterations: int = 30

    def __post_init__(self) -> None:
        _require_image(self.about.name, self.image, self.coefficients)
        _require_limits(self.about.name, self.tolerance, self.iterations)
        if self.width_px is not None:
            require_positive(self.about.name, width_px=self.width_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method; UnsuitableDesignError where the mask has many apertures or slits."""
        require_one_spot(geometry, cls.about.name)
        return cls()

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at the first frame only

        frames = as_frames(observations)
        unusable = moments.unusable_frames(frames)
        columns, rows = moments.axis_sums(frames)
        found = np.empty((len(frames), 2))
        for axis, sums in enumerate((columns, rows)):
            profile = sums.astype(np.float64)
            profile[unusable] = 0.0
            found[:, axis] = self._peaks(profile)
        found[np.isnan(found).any(axis=1)] = np.nan
        return found

    def _peaks(self, profiles: Floats) -> Floats:
        """Positions (N,) of the peaks of profiles (N, L); NaN where none is found."""
        floors = dark_level(profiles)
        light = profiles - floors[:, None]
        largest = light.max(axis=1)
        starts = np.where(largest > 0, light.argmax(axis=1), np.nan)
        halves = np.ones(len(profiles))
        if self.width_px is not None:
            halves *= self.width_px / 2.0
        else:
            np.divide(light.sum(axis=1), 2.0 * largest, out=halves, where=largest > 0)
            halves = np.maximum(halves, 0.5)
        none = np.zeros(1)
        shifts, _ = _fit(
            profiles,
            floors,
            starts[:, None],
            places=none,
            groups=none.astype(np.int64),
            halves=halves[:, None],
            image=self.image,
            coefficients=self.coefficients,
            overlap=0.0,
            tolerance=self.tolerance,
            iterations=self.iterations,
        )
        return shifts[:, 0]


def _fit(
    lines: Floats,
    floors: Floats,
    starts: Floats,
    *,
    places: Floats,
    groups: NDArray[np.int64],
    halves: Floats,
    image: Image,
    coefficients: Coefficients,
    overlap: float,
    tolerance: float,
    iterations: int,
) -> tuple[Floats, NDArray[np.int64]]:
    """Shifts (R, G) and overlapping spots (R, 2) by `peak_fit.fit_images`."""
    from algorithms.extractors.profiles import peak_fit_kernel  # noqa: PLC0415 - Numba, at first use

    shifts = np.empty_like(starts)
    pairs = np.empty((len(lines), 2), dtype=np.int64)
    peak_fit_kernel.fit_images(
        lines,
        floors,
        starts,
        places,
        groups,
        halves,
        peak_fit_kernel.number_items(image),
        np.array(coefficients),
        overlap,
        tolerance,
        iterations,
        shifts,
        pairs,
    )
    return shifts, pairs


def _require_image(by: str, image: str, coefficients: Any) -> None:
    """Raise ValueError unless there is such an image, and the rational one is finite anywhere."""
    require_choice(by, Image, image=image)
    if len(coefficients) != 6 or not np.isfinite(coefficients).all():
        raise ValueError(f"{by}: coefficients must be six finite numbers; got {coefficients!r}")
    roots = np.roots(coefficients[3:])
    if not coefficients[5] > 0 or (roots[np.isreal(roots)].real >= 0).any():
        raise ValueError(
            f"{by}: coefficients must keep the denominator positive; got {coefficients!r}"
        )


def _require_limits(by: str, tolerance: float, iterations: int) -> None:
    require_positive(by, tolerance=tolerance)
    require_at_least(by, 1, iterations=iterations)
