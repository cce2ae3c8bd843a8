"""Position of a known shape that explains a bi-level frame best (TM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
)
from algorithms.documented import documented
from algorithms.extractors.frames.background import (
    Background,
    background_level,
)
from algorithms.inputs import as_frames
from algorithms.parameters import require_choice, require_positive, require_within

Shape = Literal["round", "square"]

Candidates = Literal["search", "brightest"]
"""``brightest``: the brightest pixels, as printed. ``search``: anywhere, to 1/16 px."""


@documented
@dataclass(frozen=True)
class TemplateMatch(Extractor):
    """Our variant of TM: position where outline and lit pixels differ in the fewest pixels.

    Frame and template are binary, so light inside the spot and noise below the threshold have no
    effect. Positions are searched in steps of 1/16 px. Binary frames lose the position of the rim
    within a pixel: even without noise, a disc of 8 px radius is found only to 0.05 px. Ours is a
    grey frame under the same outline.

    Parameters
    ----------
    width_px : float
        Width of the aperture's projection, px: diameter or side.
    shape : {"round", "square"}
        Its shape; a square's sides lie along the pixels.
    threshold : float
        The fraction mu of the maximum, in (0, 1), taken above the background. Ours: at half the
        light a blurred rim lies where the sharp one would.
    background : {"none", "border", "median"}
        Level below which the fraction counts. The published method subtracts none.
    binarise : bool
        True compares with the binary frame, as published. False (our variant) continues to the
        position where the outline contains most light of the grey frame, which is some eight times
        more accurate on a clean disc.
    candidates : {"search", "brightest"}
        Positions compared. The published ones are the brightest pixels: whole numbers, which noise
        chooses within even light, though the survey counts the method among the sub-pixel ones.
    most_different : float or None
        Pixels in which lit pixels and template may differ, as a fraction of the template's:
        beyond, the light is taken for another shape, two spots or noise. None, as published, asks
        for nothing.

    Notes
    -----
    Implements: alg:TM (fe:tm, Chang2008): ``I' = 1`` where ``I > mu I_max``, else 0; J is 1
    inside the projected aperture; ``p_c = argmin_p sum (I' - J_p)^2``. The candidate's Sun
    vector does not change the template: parallel light projects a thin aperture onto a plane
    parallel to it in its own size and shape at every incidence, so the template at normal
    incidence serves (what a thick mask shades is left out). The printed candidates are the
    brightest pixels; by default the search walks from the brightest pixel and from the lit pixels'
    mean down to half pixels, and then averages the positions on grids down to 1/16 px that differ
    from the best by at most the template's half width in pixels, some quarter of a pixel's move:
    the difference is a step function of position, and its minimum hangs on a few noisy pixels.
    Over a grey frame ``sum (I - J_p)^2`` is least where the light inside the outline, each pixel's
    spread evenly over it, is most: by parabolas through nine positions a pixel apart.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (maximum not above the background), without
    contrast (all dark or all saturated) or holds a NaN or infinity, and where the template leaves
    the frame (spot cut by the edge). Another shape, two spots or noise give the best-fitting
    position, undetected, unless `most_different` is given.

    Cost: 3 operations per pixel, and some 1600 positions of 10 operations per row of the template;
    a grey frame 36 more of 60 operations per row.

    Examples
    --------
    >>> from algorithms.examples import disc_frame
    >>> frames = disc_frame(16.3, 14.8)
    >>> TemplateMatch(width_px=10.0).extract(frames).round(1)
    array([[16.4, 14.9]])
    """

    about: ClassVar = AboutExtractor(
        name="tm",
        taxonomy="TM",
        studies=("Chang2008",),
        labels=("fe:tm", "alg:TM"),
        origin="survey",
        needs=(
            "pixel_pitch_mm",
            "aperture_width_mm",
            "aperture_shape",
        ),
        version=2,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    width_px: float
    shape: Shape = "round"
    threshold: float = 0.5
    background: Background = "none"
    binarise: bool = True
    candidates: Candidates = "search"
    most_different: float | None = None

    def __post_init__(self) -> None:
        require_positive(self.about.name, width_px=self.width_px)
        if self.most_different is not None:
            require_positive(self.about.name, most_different=self.most_different)
        require_choice(self.about.name, Candidates, candidates=self.candidates)
        require_choice(self.about.name, Shape, shape=self.shape)
        require_within(self.about.name, "(0, 1)", threshold=self.threshold)
        require_choice(self.about.name, Background, background=self.background)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's aperture as its template.

        ValueError without an aperture's width and shape or a pixel pitch.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        width, pitch = geometry.aperture_width_mm, geometry.pixel_pitch_mm
        shape = geometry.aperture_shape
        if width is None or pitch is None or shape is None:  # said above; for the type checker
            raise ValueError(
                f"{cls.about.name} needs the sensor geometry's {', '.join(cls.about.needs)}"
            )
        return cls(width_px=width / pitch, shape=shape)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.extractors.frames import template_kernel  # noqa: PLC0415 - Numba, at first use
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        base = background_level(frames, self.background)
        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        peak = maxima.max(axis=1).astype(np.float64)
        unusable = moments.unusable_frames(frames)
        unusable |= ~(peak > base)
        with np.errstate(invalid="ignore"):  # an infinite peak: the frame is unusable
            levels = base + self.threshold * (peak - base)
        levels[unusable] = np.inf
        found = np.empty((len(frames), 2))
        template_kernel.best_positions(
            frames,
            levels,
            self.width_px / 2.0,
            self.shape == "square",
            np.inf if self.most_different is None else self.most_different,
            self.candidates == "brightest",
            found,
        )
        if not self.binarise:
            template_kernel.most_light(frames, self.width_px / 2.0, self.shape == "square", found)
        return found
