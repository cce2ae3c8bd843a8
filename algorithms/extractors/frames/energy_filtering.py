"""Beyond the survey, its future direction: pixels' energies filtered over a sequence of frames."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Self

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
from algorithms.extractors.frames.single_light import (
    Light,
    check_agreement,
    light_of,
    longest_px_of,
    require_light,
)
from algorithms.extractors.profiles.single_spot import require_one_spot
from algorithms.inputs import as_frames
from algorithms.parameters import require_at_least, require_positive, require_within

#: Area of the ellipse of the lit pixels' second moments, over theirs, above which they are not one
#: spot: one for a filled ellipse, this for two discs 3.2 radii apart.
_SPREAD = 5.0 / 3.0
#: Weight of a frame's shift in the mean of late ones: those of some ten frames count.
_LATE = 0.2
#: What a chi squared of two degrees of freedom exceeds once in a hundred times.
_DRIFT = 2.0 * math.log(100.0)


@documented
@dataclass(frozen=True)
class AdaptiveEnergyFilter(Extractor):
    """Centroid of pixel energies above the noise, averaged over frames while the Sun is still.

    While the Sun is still, changes of a pixel from frame to frame are noise. The energies of a
    sequence are averaged for as long as the spot stays, and start anew when the frames' mean shift
    against them is more than noise; the threshold falls with their noise. `extract_sequence` does
    so; `extract` reads each frame by itself.

    Parameters
    ----------
    significance : float
        Standard deviations of its noise, positive, that a pixel's energy must have.
    fraction : float
        Part of the largest energy, in [0, 1), that it must have as well.
    memory : int
        Most frames, at least 1, that count: later ones replace earlier ones at this rate.

    Notes
    -----
    Implements: nothing printed. The survey names adaptive energy filtering with time-domain
    energy sequences (Bao2022) as a research direction for centroids, without a formula; this
    is ours: ``E_t = E_(t-1) + (I_t - E_(t-1)) / n`` with n the frames since the last move, then
    the centroid of what E exceeds ``b + max(k sigma / sqrt(n), f (E_max - b))`` by, b and sigma
    from the border. The shift of a frame is the least-squares one by the slopes of E; it and the
    mean of late ones are tested against the scatter it leaves (chi squared, one in a hundred).

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark, without contrast (all dark or all saturated) or
    holds a NaN or infinity, and where the pixels above the threshold are fewer than two, not one
    spot (two of them, scattered light) or touch the edge (a spot cut by it); noise alone gives
    NaN. `extract` gives none either where registration (`algorithms.extractors.frames.mirror`)
    does not find one whole symmetric light within half a pixel; `extract_sequence`, whose frames
    may be too noisy for that one by one, takes two lights that overlap for one. In a sequence a
    frame that holds a NaN is passed over, and one without a spot ends the mean. A drift that hides
    in the noise leaves a lag, at most about a frame's own error; frames of a Sun that moves by
    some six such errors a frame are better taken alone.

    Cost: 6 operations per pixel, and that of registration; in a sequence 3 more, and 12 per pixel
    of the spot.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[:21, :25]
    >>> spot = 200 * np.exp(-((x - 12.3) ** 2 + (y - 9.8) ** 2) / 6)
    >>> frames = np.random.default_rng(1).normal(spot, 5.0, (30, 21, 25))
    >>> found, frames_averaged = AdaptiveEnergyFilter().extract_sequence(frames)
    >>> found[-1].round(1), int(frames_averaged[-1])
    (array([12.3,  9.8]), 30)
    """

    about: ClassVar = AboutExtractor(
        name="energy-filter",
        taxonomy="None",
        studies=("Bao2022",),
        origin="ours",
        version=3,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    significance: float = 5.0
    fraction: float = 0.1
    memory: int = 100
    light: Light = "spot"
    longest_px: float | None = None

    def __post_init__(self) -> None:
        require_positive(self.about.name, significance=self.significance)
        require_within(self.about.name, "[0, 1)", fraction=self.fraction)
        require_at_least(self.about.name, 1, memory=self.memory)
        require_light(self.about.name, self.light, self.longest_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the filter; UnsuitableDesignError where the mask has many apertures or slits."""
        require_one_spot(geometry, cls.about.name)
        return cls(light=light_of(geometry), longest_px=longest_px_of(geometry))

    def extract(self, observations: ArrayLike) -> Floats:
        """Centroids (N, 2) of frames (N, H, W), each by itself; ValueError on wrong input."""
        frames = as_frames(observations)
        return check_agreement(frames, self._filter_rows(frames, 1)[0], self.light, self.longest_px)

    def extract_sequence(self, observations: ArrayLike) -> tuple[Floats, NDArray[np.int64]]:
        """Centroids (N, 2) of frames (N, H, W) in the order of time, and of how many frames each.

        A row depends on the frames before it and on none after it. ValueError on wrong input.
        """
        return self._filter_rows(observations, self.memory)

    def _filter_rows(
        self, observations: ArrayLike, memory: int
    ) -> tuple[Floats, NDArray[np.int64]]:
        from algorithms.extractors.frames import energy_filter_kernel  # noqa: PLC0415 - Numba, at first use
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        unusable = moments.unusable_frames(frames)
        found = np.empty((len(frames), 2))
        lengths = np.empty(len(frames), dtype=np.int64)
        energy_filter_kernel.filter_sequence(
            frames,
            ~unusable,
            self.significance,
            self.fraction,
            _SPREAD,
            memory,
            _DRIFT,
            _LATE,
            found,
            lengths,
        )
        return found, lengths
