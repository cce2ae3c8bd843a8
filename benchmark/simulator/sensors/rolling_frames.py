"""Frames exposed while the sensor turns, at once or row by row: `RollingFrameSensor`."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.frames import FrameSensor

#: Nodes in time of a spot that hardly moves, and how many more each pixel of motion takes: light
#: of the standard datasets is then within 1e-3 of peak of many nodes.
_NODES, _NODES_A_PX = 2.5, 0.8
#: Motion beyond which no more are taken.
_FARTHEST_PX = 64.0


@dataclass(frozen=True)
class RollingFrameSensor(FrameSensor):
    """A `FrameSensor` that turns while it is exposed, at the rates of its scene.

    Every row is exposed for `PixelArray.exposure_s`, one `row_time_s` after the row before it;
    without a row time all are exposed together (global shutter, frame transfer). The scene's Sun
    is that of time 0, when the row through its spot is half exposed: who knows the row that his
    answer lies in stamps it with that row's time, and is asked for the Sun of that moment. Row Y
    is exposed about ``(Y - y) row_time_s``, y the row of the spot of a point Sun (the nearest
    row there is), wherever the window lies.

    Light is rendered as of a sensor at rest at a few moments, the Gauss nodes of all the time
    that a window's rows are exposed; a row gets the integral over its own exposure of the
    polynomial through them. Without rates frames are those of the sensor at rest to the last
    bit. Ghosts and light from the Earth stay where they are at time 0.

    Attributes
    ----------
    row_time_s
        From one row's exposure to the next one's; negative where read-out runs to lower rows.
    more_nodes
        Moments beside those that the motion asks for; to see how much they matter.
    """

    sees_motion: ClassVar[bool] = True
    #: Whose light it is at rest: kept under the same key.
    still: ClassVar[type[FrameSensor]] = FrameSensor

    row_time_s: float = field(default=0.0, kw_only=True)
    more_nodes: int = field(default=0, kw_only=True)

    def __post_init__(self) -> None:
        _check(self.row_time_s, self.more_nodes)

    def _optics(self) -> tuple[Hashable, ...]:
        _, *rest = super()._optics()
        return (self.still.__name__, *rest)

    def _moment(self, scene: Scene) -> tuple[Hashable, ...]:
        still = super()._moment(scene)
        if scene.rate_deg_s is None:
            return still
        shutter = self.row_time_s, self.detector.exposure_s, self.more_nodes
        return (*still, *shutter, scene.rate_deg_s.tobytes())

    def _rows_s(self) -> Floats:
        """(rows,) when each row of a window is half exposed, after the window's middle."""
        rows = self.window_px[1]
        return np.asarray((np.arange(rows) - (rows - 1) / 2.0) * self.row_time_s)

    def _middle_s(self, scene: Scene, origin_px: NDArray[np.int64]) -> Floats:
        """(N,) when the middle of each window is half exposed."""
        rows = self.window_px[1]
        spot = np.clip(self.spot_px(scene.sun)[:, 1], 0.0, self.detector.rows - 1.0)
        return np.asarray((origin_px[:, 1] + (rows - 1) / 2.0 - spot) * self.row_time_s)

    def nodes(self, scene: Scene, origin_px: NDArray[np.int64]) -> NDArray[np.int64]:
        """(N,) moments that each sample is rendered at, 1 for what does not turn."""
        if scene.rate_deg_s is None:
            return np.ones(len(scene), dtype=np.int64)
        _, half = _span(self._rows_s(), self.detector.exposure_s)
        count = _nodes(self, scene, self._middle_s(scene, origin_px), half) + self.more_nodes
        turns = (scene.rate_deg_s != 0.0).any(axis=1)
        return np.where(turns, count, 1).astype(np.int64)

    def _render(self, scene: Scene, origin_px: NDArray[np.int64]) -> Floats:
        """(N, H, W) as of the sensor at rest, every row over its own exposure."""
        if scene.rate_deg_s is None:
            return super()._render(scene, origin_px)
        columns, rows = self.window_px
        flux = np.zeros((len(scene), rows, columns))
        counts = self.nodes(scene, origin_px)
        for count in np.unique(counts):
            mine = np.flatnonzero(counts == count)
            part, origin = scene.rows(mine), origin_px[mine]
            if count == 1:
                flux[mine] = super()._render(part, origin)
                continue
            middle = self._middle_s(part, origin)
            light = np.zeros((len(mine), rows, columns))
            moments, shares = row_shares(self._rows_s(), self.detector.exposure_s, int(count))
            for moment, share in zip(moments, shares.T, strict=True):
                seen = part.seen_from(seen_at(part, middle + moment))
                light += share[:, None] * super()._render(seen, origin)
            flux[mine] = light
        return flux


@dataclass(frozen=True)
class RollingDiffractiveSensor(RollingFrameSensor, DiffractiveFrameSensor):
    """A `DiffractiveFrameSensor` that turns while it is exposed, as `RollingFrameSensor` does."""

    still: ClassVar[type[FrameSensor]] = DiffractiveFrameSensor

    def __post_init__(self) -> None:
        RollingFrameSensor.__post_init__(self)
        DiffractiveFrameSensor.__post_init__(self)


def seen_at(scene: Scene, time_s: Floats) -> Floats:
    """(N, 3) unit vectors to the Suns of a scene at times (N,), the scene's own at time 0.

    The Sun stands still, the sensor turns: ``s(t)`` is s turned by ``-|w| t`` about w.
    """
    if scene.rate_deg_s is None:
        return scene.sun
    seen = np.empty_like(scene.sun)
    turns = zip(scene.sun.tolist(), scene.rate_deg_s.tolist(), time_s.tolist(), strict=True)
    for n, ((x, y, z), rates, time) in enumerate(turns):
        rate = math.sqrt(rates[0] * rates[0] + rates[1] * rates[1] + rates[2] * rates[2])
        if rate == 0.0:
            seen[n] = x, y, z
            continue
        u, v, w = (component / rate for component in rates)
        angle = -math.radians(rate * time)
        c, s = math.cos(angle), math.sin(angle)
        along = (1.0 - c) * (x * u + y * v + z * w)
        seen[n] = (
            c * x + s * (v * z - w * y) + along * u,
            c * y + s * (w * x - u * z) + along * v,
            c * z + s * (u * y - v * x) + along * w,
        )
    return seen


def row_shares(rows_s: Floats, exposure_s: float, nodes: int) -> tuple[Floats, Floats]:
    """Return moments (K,), in seconds, and what each has of every row's light, (rows, K).

    The moments are the Gauss nodes of all the time that rows are exposed; a row's light is the
    integral over its own exposure of the polynomial through the light at the moments.

    Parameters
    ----------
    rows_s
        (rows,) when each is half exposed.
    exposure_s
        Of every row.
    nodes
        K.
    """
    middle, half = _span(rows_s, exposure_s)
    if half == 0.0:
        return np.array([middle]), np.ones((len(rows_s), 1))
    place, weight = np.polynomial.legendre.leggauss(nodes)
    within, width = (rows_s - middle) / half, exposure_s / (2.0 * half)
    shares = [_share(k, within, width, place, weight) for k in range(nodes)]
    return middle + half * place, np.stack(shares, axis=1)


def _share(k: int, within: Floats, width: float, place: Floats, weight: Floats) -> Floats:
    """(rows,) mean of Lagrange's polynomial of node k over exposures about `within`.

    In units of half the whole time; exact by Gauss's rule with the same nodes.
    """
    moments = within[:, None] + width * place
    polynomial = np.ones_like(moments)
    for other in range(len(place)):
        if other != k:
            polynomial *= (moments - place[other]) / (place[k] - place[other])
    return np.array([math.fsum(row) for row in (polynomial * (weight / 2.0)).tolist()])


def _span(rows_s: Floats, exposure_s: float) -> tuple[float, float]:
    """Middle, and half the length, of the time that any of some rows is exposed."""
    first, last = float(rows_s.min()), float(rows_s.max())
    return (first + last) / 2.0, (last - first + exposure_s) / 2.0


def _nodes(sensor: FrameSensor, scene: Scene, middle_s: Floats, half_s: float) -> NDArray[np.int64]:
    """(N,) moments that the motion of each sample's spot asks for."""
    seen = (seen_at(scene, middle_s + step) for step in (-half_s, 0.0, half_s))
    before, now, after = (sensor.spot_px(sun) for sun in seen)
    way = np.sqrt(np.sum((now - before) ** 2, axis=1))
    way += np.sqrt(np.sum((after - now) ** 2, axis=1))
    # one that leaves the field takes as many as cross a window
    way = np.minimum(np.nan_to_num(way, nan=np.inf), _FARTHEST_PX)
    return np.asarray(np.ceil(_NODES + _NODES_A_PX * way), dtype=np.int64)


def _check(row_time_s: float, more_nodes: int) -> None:
    if not math.isfinite(row_time_s):
        raise ValueError(f"row_time_s must be finite; got {row_time_s}")
    if more_nodes < 0:
        raise ValueError(f"more_nodes must not be negative; got {more_nodes}")
