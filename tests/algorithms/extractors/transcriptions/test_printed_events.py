"""alg:ECM transcribed: events' mean address, weighted by the inverse of their times."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.extractors.events.centroid import EventCentroid


def ecm_as_printed(addresses, times, t_reset=0.0):
    """alg:ECM of one axis."""
    above = below = 0.0
    for x_pix, t_x in zip(addresses, times, strict=True):
        above += x_pix / (t_x - t_reset)
        below += 1.0 / (t_x - t_reset)
    return above / below


def spot(place, width, rng):
    """Events (M, 3) of an evenly lit square, in the order in which its pixels fire."""
    along = [np.clip(width / 2 + 0.5 - abs(np.arange(24) - at), 0, 1) for at in place]
    light = np.outer(along[1], along[0])
    rows, columns = np.nonzero(light)
    times = 50.0 / light[rows, columns] * (1 + 0.02 * rng.standard_normal(len(rows)))
    order = np.argsort(times)
    return np.column_stack([columns, rows, times])[order]


@pytest.mark.parametrize("hot", [2.0, np.inf])
def test_ecm(hot):
    """Every event counts: none of the spot's is hot, and all lie within its reach."""
    rng = np.random.default_rng(6)
    method = EventCentroid(width_px=5.0, layout="spot", hot=hot)
    assert EventCentroid(width_px=5.0).hot == 2.0
    for place in rng.uniform(9.0, 14.0, (12, 2)):
        events = spot(place, 5.0, rng)
        expected = [ecm_as_printed(events[:, axis], events[:, 2]) for axis in (0, 1)]
        np.testing.assert_allclose(method.extract(events[None])[0], expected, atol=1e-9)
