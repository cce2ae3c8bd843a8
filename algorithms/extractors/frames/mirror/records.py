"""What the stages of `mirror.registration` know of a frame, a record each.

Lengths are in pixels, light is over the peak's where nothing else is said.
"""

from __future__ import annotations

from algorithms.kernels.records import Pair, record


class Light:
    """The one light of a frame, as `search_kernel` finds it; NaN where there is not one.

    Attributes
    ----------
    middle
        Mean place of the blocks' light above the cut.
    half
        Half its extent along both axes.
    base, noise
        Background and variance of a dark pixel, in the frame's unit.
    peak
        Light of the brightest block, in the frame's unit.
    fill
        Mean light of the lit blocks, over the peak.
    refusal
        0, or why there is none: `search_kernel.DARK`, `SEVERAL` or `EDGE`.
    """

    middle: Pair
    half: Pair
    base: float
    noise: float
    peak: float
    fill: float
    refusal: int


class Box:
    """The window about a spot's middle and its core, of which the upper half is kept as pairs.

    Attributes
    ----------
    left, top, last, columns
        First column and row, last row and number of columns of the window in the frame; no
        columns where the frame's edge cuts the core.
    stride
        Numbers from one row of pairs to the next.
    first, above, rows
        Columns and rows before the core; rows of the core's upper half.
    """

    left: int
    top: int
    last: int
    columns: int
    stride: int
    first: int
    above: int
    rows: int


class State:
    """What is fitted to a window.

    Attributes
    ----------
    dark, gain
        Variance of a dark pixel, and what a unit of light adds to it.
    d
        Displacement of the spot against its mirror image.
    xx, yy, xy
        Covariance of the centre; infinite where nothing is found.
    noise_share
        Noise's share in the weighting.
    by_x, by_y
        How much a unit of the sums for x and for y, that the fit solves for, moves the centre.
    left_out, clusters
        Pairs left out; the departures of those in clusters.
    slopes_d
        The displacement that the slopes were made for.
    """

    dark: float
    gain: float
    d: Pair
    xx: float
    yy: float
    xy: float
    noise_share: float
    by_x: Pair
    by_y: Pair
    left_out: float
    clusters: float
    slopes_d: Pair


class Background:
    """Odd part of the background around a spot: ``2 (slope + bend |u|^2 / square) . u``.

    Attributes
    ----------
    slope, bend, square
        Of a pair's difference along both axes; square of the length at which the bend is measured.
    slope_variance, bend_variance
        Variances of slope and bend.
    """

    slope: Pair
    bend: Pair
    square: float
    slope_variance: Pair
    bend_variance: Pair


class Form:
    """Numbers that tell one symmetric spot from two lights and from light without symmetry.

    Attributes
    ----------
    clusters, alike
        Light of departing clusters over all; what neighbours miss alike, over the squared light.
    blurred, sharp
        Larger and smaller ratio of the squared extents of the high outline to the low one's, for
        the blurred and the sharp high outline.
    minor, major
        Squared extents of the low outline.
    area, base
        Areas of the high outline and of the low one.
    waist
        Area of an ellipse with the high outline's moments, over its own.
    scatter, lenient
        Mean square of the departures over what is expected; the same with allowance for sharp
        rims.
    skew
        Whether the spot is skew, surely and by much.
    """

    clusters: float
    alike: float
    blurred: Pair
    sharp: Pair
    minor: float
    major: float
    area: float
    base: float
    waist: float
    scatter: float
    lenient: float
    skew: bool


class Sums:
    """Weighted sums of a window's pairs that the fit needs; lanes hold them in this order.

    Attributes
    ----------
    xx, yy, xy, yx
        Products of the weighting h with the slopes g: ``h_x g_x``, ``h_y g_y``, ``h_x g_y`` and
        ``h_y g_x``.
    x, y
        Products of the weighting with the differences.
    noise_xx, noise_yy, noise_xy
        Products of the weighting with itself, times the variance of a pixel's own light over that
        of the light around.
    share
        Sum of these variances.
    """

    xx: float
    yy: float
    xy: float
    yx: float
    x: float
    y: float
    noise_xx: float
    noise_yy: float
    noise_xy: float
    share: float


LIGHT, BOX, STATE, SUMS, BACKGROUND, FORM = (
    record(fields) for fields in (Light, Box, State, Sums, Background, Form)
)
