"""Classical middles of the light on lines behind slits: BCM, BCTM and MT-ACM of profiles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import AboutExtractor, FeatureKind, Floats, Observation
from algorithms.documented import documented
from algorithms.extractors.frames.centroid import BasicCentroid, ThresholdedCentroid
from algorithms.extractors.frames.threshold_average import Crossing, MultipleThresholdCentroid
from algorithms.extractors.profiles.slit_lines import NEEDS, SlitLines, dark_level
from algorithms.parameters import require_within

Middles = Callable[[Floats, Floats], Floats]

#: Window moves after the first: a window that its own middle moves settles in one or two.
_MOVES = 2


@documented
@dataclass(frozen=True)
class ProfileCentroid(SlitLines):
    """Intensity-weighted mean position of all light on each line.

    The method is simple and has sub-pixel resolution, but dark signal pulls the result towards the
    middle of the line, more so for weak light.

    Parameters
    ----------
    subtract_dark : bool
        Whether the median of the line is subtracted first; pixels below it count as negative. The
        published method subtracts nothing.

    Notes
    -----
    Implements: alg:BCM (fe:bcm, Enright2008b) on a line: ``u_c = sum(u I) / sum(I)``,
    less where the slits' own centroid is. Behind slits of two slants, whose spots move against
    each other, each spot is summed in its own window, found as PD finds it and moved onto the
    centroid twice.

    Failure: a NaN row for a profile without light (sum not positive), without contrast (all dark
    or all saturated) or with a NaN or infinity. Behind slits of one slant a missing or cut spot, a
    second Sun and noise alone are averaged in without notice; behind two slants they give NaN.

    Cost: 4 operations per pixel.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> ProfileCentroid(**design).extract(profiles).round(2)
    array([[43.3, 36.8]])
    """

    about: ClassVar = AboutExtractor(
        name="bcm-profile",
        taxonomy="BCM",
        studies=("Enright2008b",),
        labels=("fe:bcm", "alg:BCM"),
        origin="survey",
        version=2,
        needs=NEEDS,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    subtract_dark: bool = False

    def extract(self, observations: ArrayLike) -> Floats:
        """Centroids (N, 2) of profiles (N, A L); ValueError on wrong input."""
        centroid = BasicCentroid()

        def middles(lines: Floats, floors: Floats) -> Floats:
            above = lines - floors[:, None] if self.subtract_dark else lines
            return centroid.extract(above[:, None, :])[:, 0]

        return self.spots(_shifts(self, self.lines(observations), _light_middle(self), middles))


@documented
@dataclass(frozen=True)
class ProfileThresholdedCentroid(SlitLines):
    """Intensity-weighted mean position of the light above a fraction of each line's maximum.

    The threshold is subtracted and negative values are set to zero, so that dark signal and noise
    below it have no effect.

    Parameters
    ----------
    threshold : float
        The fraction mu of the maximum, in [0, 1). The survey gives no value; 0.3 is ours, as on
        frames.

    Notes
    -----
    Implements: alg:BCTM (fe:bctm, He2005) on a line: ``I' = max(I - mu I_max, 0)``, ``u_c =
    sum(u I') / sum(I')``, less where the slits' own centroid is. Behind slits of two slants,
    whose spots move against each other, each spot is summed in its own window, found as PD finds
    it and moved onto the centroid twice.

    Failure: a NaN row for a profile without light (maximum not positive), without contrast (all
    dark or all saturated) or with a NaN or infinity. Behind slits of one slant a missing or cut
    spot, a second Sun and noise alone are averaged in without notice; behind two slants they give
    NaN.

    Cost: 5 operations per pixel.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> method = ProfileThresholdedCentroid(**design)
    >>> method.extract(profiles + 40).round(1)
    array([[43.4, 36.8]])
    """

    about: ClassVar = AboutExtractor(
        name="bctm-profile",
        taxonomy="BCTM",
        studies=("He2005",),
        labels=("fe:bctm", "alg:BCTM"),
        origin="survey",
        version=2,
        needs=NEEDS,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    threshold: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        require_within(self.about.name, "[0, 1)", threshold=self.threshold)

    def extract(self, observations: ArrayLike) -> Floats:
        """Centroids (N, 2) of profiles (N, A L); ValueError on wrong input."""
        centroid = ThresholdedCentroid(self.threshold)

        def middles(lines: Floats, floors: Floats) -> Floats:  # noqa: ARG001 - as published
            return centroid.extract(lines[:, None, :])[:, 0]

        return self.spots(_shifts(self, self.lines(observations), _light_middle(self), middles))


@documented
@dataclass(frozen=True)
class ProfileThresholdAverage(SlitLines):
    """Midpoint between the outermost flanks of each line's light, averaged over many thresholds.

    Where slits share a slant their light is one pattern, whose first and last flanks move with
    it; averaging thresholds resolves fractions of a pixel.

    Parameters
    ----------
    lowest, highest : float
        Fractions of the light's height above dark between which thresholds lie, as on frames.
    crossing : {"pixel", "linear"}
        Whether a rise counts at its pixel, as published, or is interpolated to the pixel before.

    Notes
    -----
    Implements: alg:MTACM1, alg:MTACM2 (fe:mtacm, Massari2004) on a line: ``N_TH > sigma sqrt(e) /
    dx``, ``u_l = (h_l + k_l) / 2``, ``u_c = mean_l u_l``, less where the middle between the
    pattern's outer edges is. The kernel is that of the frames' sums. Behind slits of two
    slants, whose spots move against each other, each spot is taken in its own window, found as
    PD finds it and moved onto the midpoint twice.

    Failure: a NaN row for a profile without contrast (all dark or all saturated), with a NaN or
    infinity, or whose light is cut by both ends of the line or one so that no threshold has a rise
    from both sides. Behind slits of one slant a missing outer spot, a second Sun and noise alone
    give the middle between the outermost flanks without notice; behind two slants they give NaN.

    Cost: the median of each line, 2 operations per pixel and 4 per threshold.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> method = ProfileThresholdAverage(**design, crossing="linear")
    >>> method.extract(profiles + 40).round(1)
    array([[43.4, 36.7]])
    """

    about: ClassVar = AboutExtractor(
        name="mt-acm-profile",
        taxonomy="MT-ACM",
        studies=("Massari2004",),
        labels=("fe:mtacm", "alg:MTACM1", "alg:MTACM2"),
        origin="survey",
        version=2,
        needs=NEEDS,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    accuracy_px: float = 0.01
    lowest: float = 0.25
    highest: float = 0.9
    crossing: Crossing = "pixel"

    def __post_init__(self) -> None:
        super().__post_init__()
        # The same rules as on frames.
        MultipleThresholdCentroid(self.accuracy_px, self.lowest, self.highest, self.crossing)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in profiles (N, A L); ValueError on wrong input."""
        from algorithms.kernels import crossings  # noqa: PLC0415 - Numba, at first use

        def middles(lines: Floats, floors: Floats) -> Floats:
            found = np.empty(len(lines))
            inside = np.isfinite(lines[:, 0])  # windows are NaN as a whole, or not at all
            crossings.threshold_midpoints(
                np.where(inside[:, None], lines, 0.0),
                floors,
                self.accuracy_px,
                self.lowest,
                self.highest,
                self.crossing == "linear",
                found,
            )
            return np.where(inside, found, np.nan)

        edges = [
            middle + side * slit[2] / 2.0
            for slit, middle in zip(self.slits, self.pattern(), strict=True)
            for side in (-1, 1)
        ]
        middle = float(min(edges) + max(edges)) / 2.0
        return self.spots(_shifts(self, self.lines(observations), middle, middles))


def _light_middle(slits: SlitLines) -> float:
    """Centroid of the slits' light on the line at zero shift, px."""
    return float(np.average(slits.pattern(), weights=[slit[2] for slit in slits.slits]))


def _shifts(slits: SlitLines, lines: Floats, middle: float, middles: Middles) -> Floats:
    """Shifts (N A, G): of whole lines from `middle`, or of each spot in its window.

    `middles` gives the positions (R,) of the light in lines (R, L) of dark level (R,).
    """
    floors = dark_level(lines)
    if len(slits.tangents) == 1:
        return (middles(lines, floors) - middle)[:, None]
    shifts = slits.locate(lines, floors)
    spots = len(slits.slits)
    for _ in range(_MOVES + 1):
        windows, starts = slits.windows(lines, shifts)
        found = middles(windows.reshape(-1, windows.shape[2]), np.repeat(floors, spots))
        shifts = slits.group_means(starts + found.reshape(-1, spots) - slits.pattern())
    return shifts
