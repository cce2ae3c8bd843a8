"""Unknown parameters of a unit in flight, and the information on them: `Unknowns`.

Gains of a few elements and their drifts, and how the head stands, bends and creeps. Earth, heaters
and pixels count as known.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.metrics.bounds import Bound, reading_slopes
from benchmark.simulator.flight.drift import AssemblyDrift
from benchmark.simulator.flight.mission import height_mm
from benchmark.simulator.flight.time_series import TimedScene
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.sensor import FixedPattern, GainSpread

#: Prior spread of how a head stands, so wide that the calibration decides. Tilts about x
#: and y (deg), focal length and offsets (mm).
_STANDS = np.array([1.0, 1.0, 0.1, 0.1, 0.1])
_STEPS = np.array([1e-3, 1e-3, 1e-5, 1e-5, 1e-5])


@dataclass(frozen=True)
class Unknowns:
    """Information of every sample on the direction and on P things unknown of the unit.

    Attributes
    ----------
    fisher
        (N, 4 + P, 4 + P) of two tangent axes (radians), sunlight and stray light (in units of their
        spreads, priors included), and the unknowns, in units of the spreads that they are drawn
        with.
    known
        (P, P) information on the unknowns before the first sample: their spread, references, the
        calibration split.
    """

    fisher: Floats
    known: Floats

    def information(self, *, irradiance_known: bool) -> Floats:
        """(N, 2 + P, 2 + P) on the direction and the unknowns, the light's own marginalised."""
        return _without_light(self.fisher, irradiance_known=irradiance_known)

    def direction(self, *, irradiance_known: bool) -> Floats:
        """(N, 2, 2) on the direction, from one sample and the prior information."""
        whole = self.information(irradiance_known=irradiance_known)
        cross, own = whole[:, :2, 2:], whole[:, 2:, 2:] + self.known
        return np.asarray(whole[:, :2, :2] - cross @ np.linalg.solve(own, np.swapaxes(cross, 1, 2)))


@dataclass(frozen=True)
class Same:
    """An object that is equal to itself alone, for `lru_cache`."""

    it: Any

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other.it is self.it

    def __hash__(self) -> int:
        return id(self.it)


def unknowns(preset: Any, condition: str) -> Unknowns | None:
    """Return what is unknown of a flight's unit on the test split; None where nothing is.

    Of a `FlightPreset` and one of its conditions. Of an array of pixels only the head is unknown.
    """
    return _unknowns(Same(preset), condition)


# each bound of a condition asks for the same
@lru_cache(maxsize=2)
def _unknowns(kept: Same, condition: str) -> Unknowns | None:
    preset = kept.it
    test = _fisher(preset, condition, "test")
    if test is None:
        return None
    calibration = np.asarray(_fisher(preset, condition, "calibration"))
    # with the Sun known, all information of a sample is on the unknowns
    told = _without_light(calibration, irradiance_known=True)[:, 2:, 2:].sum(axis=0)
    return Unknowns(test, _prior(preset, condition) + told)


def unit_angle_deg(own: Unknowns, single: Bound) -> Floats:
    """(N,) bound of one sample with the unit unknown, degrees; inf where not observable.

    Parameters
    ----------
    own
        What is unknown of it.
    single
        The bound of one sample; of an array of pixels with what those add, which `own` has not.
    """
    information = own.direction(irradiance_known=False)
    seen = single.observable
    covariance = np.linalg.inv(np.where(seen[:, None, None], information, np.eye(2)))
    square = np.degrees(np.sqrt(np.trace(covariance, axis1=1, axis2=2))) ** 2
    if single.unit_angle_deg is not None:
        own_square = np.where(seen, single.angle_deg, 0.0) ** 2
        square = square + np.where(seen, single.unit_angle_deg, 0.0) ** 2 - own_square
    return np.where(seen, np.sqrt(square), np.inf)


def _without_light(fisher: Floats, *, irradiance_known: bool) -> Floats:
    light = [3] if irradiance_known else [2, 3]
    kept = [k for k in range(fisher.shape[1]) if k not in {2, 3}]
    cross = fisher[:, kept][:, :, light]
    own = fisher[:, light][:, :, light]
    return np.asarray(
        fisher[:, kept][:, :, kept] - cross @ np.linalg.solve(own, np.swapaxes(cross, 1, 2))
    )


def _head(sensor: object) -> AssemblyDrift | None:
    """Return how a head drifts; None of a sensor without one."""
    for name in ("drift", "assembly"):
        drift = getattr(sensor, name, None)
        if isinstance(drift, AssemblyDrift):
            return drift if any(vars(drift).values()) else None
    return None


def _fisher(preset: Any, condition: str, split: str) -> Floats | None:
    """(N, 4 + P, 4 + P) of a split; None of a sensor that does not drift."""
    ((sensor, scene, pattern),) = preset.taken(condition, split, preset.scene(condition, split))
    if not isinstance(sensor, GainSpread):
        if (head := _head(sensor)) is None:
            return None
        # moving the head moves the image as moving the Sun does: one Fisher matrix serves both
        turns = _head_slopes(sensor, head, scene)
        widen = np.zeros((len(scene), 4, 4 + turns.shape[2]))
        widen[:, :4, :4] = np.eye(4)
        widen[:, :2, 4:] = turns
        fisher = preset.sample_bound(condition, split).fisher
        return np.asarray(np.swapaxes(widen, 1, 2) @ fisher @ widen)
    slopes, variance = _reading_slopes(preset, condition, sensor, scene, pattern)
    fisher = np.swapaxes(slopes, 1, 2) @ (slopes / variance[:, :, None])
    fisher[:, 2, 2] += 1.0
    fisher[:, 3, 3] += 1.0
    return np.asarray(fisher)


def _reading_slopes(
    preset: Any, condition: str, sensor: Any, scene: TimedScene, pattern: FixedPattern
) -> tuple[Floats, Floats]:
    """(N, K, 4 + P) changes of a few elements' means, columns as of a Fisher matrix; variances."""
    light = preset.condition(condition).irradiance
    slopes, variance = reading_slopes(sensor, scene, pattern, light, preset.bound_step_rad)
    gains = sensor.gain_slopes(sensor.expected(scene, pattern), scene)
    count, elements, each = gains.shape
    apart = np.zeros((count, elements, elements, each))
    apart[:, range(elements), range(elements)] = gains
    parts = [slopes, apart.reshape(count, elements, -1)]
    if (head := _head(sensor)) is not None:
        moved = slopes[:, :, :2] @ _head_slopes(sensor, head, scene)
        # an image that moves on the detector keeps its light, that of a Sun that moves does not
        whole = slopes[:, :, 2:3].sum(axis=1, keepdims=True)
        share = slopes[:, :, 2:3] / np.where(whole > 0, whole, 1.0)
        kept = moved - share * moved.sum(axis=1, keepdims=True)
        parts.append(np.where(_turns_head(head), moved, kept))
    return np.concatenate(parts, axis=2), variance


def _prior(preset: Any, condition: str) -> Floats:
    """(P, P) information before any sample: the identity, and references on the gains."""
    sensor = preset.condition(condition).sensor
    blocks = []
    if isinstance(sensor, GainSpread):
        built: Any = sensor
        gains = built.fixed_pattern(*preset.streams, "unit")["gain"]
        blocks = [sensor.gain_information(preset.offered)] * len(gains)
    if (head := _head(sensor)) is not None:
        blocks.append(np.eye(len(_rates(head)) + len(_STANDS)))
    size = sum(len(block) for block in blocks)
    found, place = np.zeros((size, size)), 0
    for block in blocks:
        found[place : place + len(block), place : place + len(block)] = block
        place += len(block)
    return found


def _rates(head: AssemblyDrift) -> list[tuple[str, float]]:
    return [(name, rate) for name, rate in vars(head).items() if rate]


def _turns_head(head: AssemblyDrift) -> NDArray[np.bool_]:
    """(P,) whether the head turns by an unknown, or its parts move."""
    still = [True, True, False, False, False]
    return np.array([*still, *(name.startswith("tilt") for name, _ in _rates(head))])


def _head_slopes(sensor: object, head: AssemblyDrift, scene: TimedScene) -> Floats:
    """(N, 2, P) turns (radians) of the Sun that is seen, by one spread of how the head stands.

    By its five degrees of freedom on the first day and by its rates, of which each is as large as
    its spread.
    """
    height = height_mm(sensor)
    if height is None:
        raise TypeError(f"a head that drifts must have a height; got {type(sensor).__name__}")
    seen = []
    for axis, (spread, step) in enumerate(zip(_STANDS, _STEPS, strict=True)):
        ends = [_seen(scene.sun, sign * step * np.eye(5)[axis], height) for sign in (1, -1)]
        seen.append((ends[0] - ends[1]) * (spread / (2.0 * step)))
    first, second = tangent_axes(scene.sun)
    still = np.stack(
        [np.stack([np.sum(s * a, axis=1) for s in seen], axis=1) for a in (first, second)], axis=1
    )
    moves = []
    for name, rate in _rates(head):
        unit = AssemblyDrift(**{name: rate}).moved(scene.temperature_k, scene.age_years)
        moves.append(np.einsum("npk,nk->np", still, unit / _STANDS))
    return np.concatenate([still, np.stack(moves, axis=2)], axis=2)


def _seen(sun: Floats, moved: Floats, height: float) -> Floats:
    """(N, 3) where a head that moved by tilts (deg), focal length and offsets (mm) sees the Sun."""
    tilt_x, tilt_y, longer, x, y = moved.tolist()
    head = Assembly(tilt_x_deg=tilt_x, tilt_y_deg=tilt_y).to_head(sun)
    image = np.stack(
        [
            (1.0 + longer / height) * head[:, 0] + x / height * head[:, 2],
            (1.0 + longer / height) * head[:, 1] + y / height * head[:, 2],
            head[:, 2],
        ],
        axis=1,
    )
    return np.asarray(image / np.sqrt(np.sum(image**2, axis=1, keepdims=True)))
