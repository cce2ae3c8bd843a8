"""C43: the mean of time-stamped events beside the winners' addresses (Farian2022).

`event-l-slit`, two slits that cast an L on an array of time-to-first-spike pixels, is seen by each
unit at 150 directions, both methods calibrated by the pinhole model at 169 poses. Times are for the
events of one reset and for the frame of 64 x 64 px that the same events make.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.extractors.events.centroid import EventCentroid, EventWinner
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.pinhole import BuiltPinhole
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within, times_s
from benchmark.claims.experiment import Trial
from benchmark.datasets.fields import AngleField
from benchmark.datasets.standard import event_l_slit

#: Fewer Suns than the standard data set, whose light takes a minute to make.
PRESET = replace(event_l_slit.PRESET, directions=AngleField(40.0, steps=13, test_samples=150))
EDGES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0)
_SIZE_PX, _PEAK_DN = 64, 2000.0


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(PRESET, unit=number)
    found = {m.about.name: seen.errors(m, BuiltPinhole) for m in (EventCentroid, EventWinner)}
    events = np.asarray(seen.samples("test").observations)
    frames = _frames(events)
    mean, bctm = EventCentroid.for_sensor(PRESET.geometry), ThresholdedCentroid()
    times = times_s(escm=lambda: mean.extract(events), bctm=lambda: bctm.extract(frames))
    values = {
        "beats": ratio(rms(found["escm-wta"]), rms(found["escm"])),
        "latency": ratio(times["escm"], times["bctm"]),
    }
    places = seen.incidence_deg()
    lines = {n: (middles(EDGES_DEG), rms_within(e, places, EDGES_DEG)) for n, e in found.items()}
    return Trial(values, lines)


def _frames(events: Floats) -> NDArray[np.uint16]:
    """Frames (N, 64, 64) as bright as the pixels of events (N, M, 3) are fast."""
    frames = np.zeros((len(events), _SIZE_PX, _SIZE_PX), dtype=np.uint16)
    sample, event = np.nonzero(np.isfinite(events[..., 2]))
    column, row, time = events[sample, event].T
    fastest = np.nanmin(events[..., 2], axis=1)[sample]
    frames[sample, row.astype(int), column.astype(int)] = np.rint(_PEAK_DN * fastest / time)
    return frames
