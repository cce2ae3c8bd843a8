"""Lines and spots from the first spikes of an event sensor: weighted mean (ESCM) and winners."""

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
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.inputs import as_frames
from algorithms.parameters import require_at_least, require_choice, require_positive

Layout = Literal["l-slit", "spot"]
"""``l-slit``: a line along y tells x, one along x tells y. ``spot``: one spot tells both."""


@documented
@dataclass(frozen=True)
class EventCentroid(Extractor):
    """Mean address of the events, weighted by the light that their times indicate.

    A pixel fires when its charge reaches a threshold, so the light on it is proportional to the
    inverse of the time since the reset. These values form the profile across a line, whose mean
    has sub-pixel resolution.

    Parameters
    ----------
    width_px : float
        Width of a line or of the spot, px.
    layout : {"l-slit", "spot"}
        What the events show.
    offset_px : float
        Where a line falls from the detector's middle when the Sun is on the boresight, px;
        subtracted from both coordinates, so that they are those of a spot behind the mask's
        origin.
    margin_px : float
        Events count up to half the width and this far from the line's middle, px. Ours: 1.5 holds
        the pixels that a line touches, penumbra included, wherever it falls on them.
    hot : float
        Events with more than this many times the light of a lit pixel are left out: hot pixels.
        Ours; the published sum takes all, as infinity does.

    Notes
    -----
    Implements: alg:ECM (fe:escm, Farian2022): ``X = sum(x / (t - t_reset)) / sum(1 / (t -
    t_reset))``, for each line over the events near it and away from the other line. Times count
    from the reset (t_reset = 0). The survey prints one axis of a profile sensor and no way to
    distinguish the L's lines; here the column and the row with most light start a window of the
    line's width that is moved onto its own mean until it stays. A lit pixel's light is that of the
    third quartile along lines, and in a spot of width w that of the brightest pixel after ``pi (w
    / 2 - sqrt(1/2))^2 / 2`` others: half of those that the spot covers for sure (one at least, and
    none below 2.2 px, where a single pixel may have all the light). Pixels in little light at a
    line's edge that have not fired when the array is reset are missing in the mean; taking the
    last event's light off all others, as thresholded centroids do, doubled the error.

    Shapes: events (N, M, 3) ``x_px, y_px, t_us``, rows of NaN after the last, to
    ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row without events, where an event is incomplete, infinite or at an address
    below 0, and where lines or spot hold less than half of the light (no lines, scattered events)
    or, with an L, where one line has no events away from the other. Of two spots the brighter one
    is found if it has more than half of the light.

    Cost: 40 operations per event, in 3 to 5 moves, and the sorting of the times.

    Examples
    --------
    >>> import numpy as np
    >>> spot = [(10, 5, 20.0), (11, 5, 10.0), (12, 5, 20.0), (11, 4, 40.0), (11, 6, 20.0)]
    >>> EventCentroid(width_px=3.0, layout="spot").extract([spot]).round(3)
    array([[11.   ,  5.091]])
    """

    about: ClassVar = AboutExtractor(
        name="escm",
        taxonomy="ESCM",
        studies=("Farian2022",),
        labels=("fe:escm", "alg:ECM"),
        origin="survey",
        needs=("pixel_pitch_mm",),
        version=2,
        observation=Observation.EVENTS,
        kind=FeatureKind.SPOT,
    )

    width_px: float
    layout: Layout = "l-slit"
    offset_px: float = 0.0
    margin_px: float = 1.5
    hot: float = 2.0

    def __post_init__(self) -> None:
        _require_design(self.about.name, self.width_px, self.layout, self.offset_px)
        require_positive(self.about.name, margin_px=self.margin_px)
        if not self.hot > 1.0:
            raise ValueError(f"{self.about.name}: hot must be above 1; got {self.hot!r}")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for an L of two slits, or for one aperture.

        UnsuitableDesignError for other designs.
        """
        layout, width_px, offset_px = _design(geometry, cls.about.name, cls.about.needs)
        return cls(width_px=width_px, layout=layout, offset_px=offset_px)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) from events (N, M, 3); ValueError on wrong input."""
        from algorithms.extractors.events import first_spikes_kernel  # noqa: PLC0415 - Numba, at first use

        events = first_spikes_kernel.as_events(_events(observations, self.about.name))
        means = (
            first_spikes_kernel.line_means
            if self.layout == "l-slit"
            else first_spikes_kernel.spot_means
        )
        found = np.empty((len(events), 2))
        means(
            events,
            first_spikes_kernel.count(events),
            self.width_px,
            self.width_px / 2.0 + self.margin_px,
            self.hot,
            found,
        )
        return found - self.offset_px


@documented
@dataclass(frozen=True)
class EventWinner(Extractor):
    """First column and first row to collect a number of events (winner takes all).

    This method is for arrays that output only their first spikes, without times. It gives whole
    pixels, for comparison with the mean. If several events are required, a single hot pixel does
    not win.

    Parameters
    ----------
    winners : int
        Number of events that a column or row must collect, at least 1. Ours: along an L's line more
        than the other line is wide, for a spot half of its width.
    offset_px : float
        Where a line falls from the detector's middle when the Sun is on the boresight, px;
        subtracted from both coordinates.

    Notes
    -----
    Implements: fe:escm without its mean (Farian2018): the survey compares ESCM with the address
    of the winning pixel; it prints no pseudocode for it. Several winners in one column make it
    usable on an L, where one alone does not say which line it lies on.

    Shapes: events (N, M, 3) ``x_px, y_px, t_us``, rows of NaN after the last, to
    ``(x_px, y_px)`` (N, 2), whole pixels less the offset.

    Failure: a NaN row without events, where an event is incomplete, infinite or at an address
    below 0, and where no column or no row gathers `winners` events. More hot pixels than that in
    one column give a wrong answer, undetected.

    Cost: 4 operations per event.

    Examples
    --------
    >>> spot = [(11, 5, 10.0), (10, 5, 20.0), (11, 4, 30.0), (30, 2, 35.0), (11, 6, 40.0)]
    >>> EventWinner(winners=2).extract([spot])
    array([[11.,  5.]])
    """

    about: ClassVar = AboutExtractor(
        name="escm-wta",
        taxonomy="ESCM",
        studies=("Farian2018",),
        labels=("fe:escm",),
        origin="survey",
        needs=("pixel_pitch_mm",),
        observation=Observation.EVENTS,
        kind=FeatureKind.SPOT,
    )

    winners: int = 8
    offset_px: float = 0.0

    def __post_init__(self) -> None:
        require_at_least(self.about.name, 1, winners=self.winners)
        _require_design(self.about.name, 1.0, "spot", self.offset_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for an L of two slits, or for one aperture.

        UnsuitableDesignError for other designs.
        """
        layout, width_px, offset_px = _design(geometry, cls.about.name, cls.about.needs)
        if layout == "l-slit":
            # across the other line, whose edges light a pixel more than its width on either side
            return cls(winners=2 * (round(width_px) + 1), offset_px=offset_px)
        return cls(winners=max(round(width_px / 2.0), 1), offset_px=offset_px)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) from events (N, M, 3); ValueError on wrong input."""
        from algorithms.extractors.events import first_spikes_kernel  # noqa: PLC0415 - Numba, at first use

        events = first_spikes_kernel.as_events(_events(observations, self.about.name))
        found = np.empty((len(events), 2))
        first_spikes_kernel.first_addresses(
            events, first_spikes_kernel.count(events), self.winners, found
        )
        found[np.isnan(found).any(axis=1)] = np.nan
        return found - self.offset_px


def _events(observations: ArrayLike, by: str) -> Floats:
    """Events (N, M, 3) as float64; ValueError for anything else."""
    events = as_frames(observations)
    if events.shape[2] != 3:
        raise ValueError(
            f"{by} reads observations of shape (N, M, 3), x_px, y_px and t_us an event; "
            f"got {events.shape}"
        )
    return events.astype(np.float64, copy=False)


def _require_design(by: str, width_px: float, layout: str, offset_px: float) -> None:
    require_positive(by, width_px=width_px)
    require_choice(by, Layout, layout=layout)
    if not np.isfinite(offset_px):
        raise ValueError(f"{by}: offset_px must be finite; got {offset_px!r}")


def _design(
    geometry: SensorGeometry, by: str, needs: tuple[str, ...]
) -> tuple[Layout, float, float]:
    """Layout, width and offset, px, of the L or the aperture that a design has."""
    geometry.require(*needs, by=by)
    pitch = geometry.pixel_pitch_mm or 0.0
    if geometry.slits is not None:
        if len(geometry.slits) != 1 or sorted(geometry.line_axes or ()) != ["x", "y"]:
            raise UnsuitableDesignError(
                f"{by} reads an L of one slit along each axis; the sensor's design has "
                f"{len(geometry.slits)} slits for lines along {geometry.line_axes}"
            )
        position, slant, width = geometry.slits[0]
        if slant != 0.0:
            raise UnsuitableDesignError(
                f"{by} reads slits along the axes; got a slant of {slant} deg"
            )
        return "l-slit", width / pitch, position / pitch
    if geometry.aperture_width_mm is None or geometry.apertures is not None:
        raise UnsuitableDesignError(
            f"{by} reads an L of two slits or one aperture; the design has neither"
        )
    return "spot", geometry.aperture_width_mm / pitch, 0.0
