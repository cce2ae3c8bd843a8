"""Bounds of sensors so simple that they stand in closed form: what a direction's bound is made of.

The signal is a function of the two angles, in radians, by which the Sun is off one direction
along great circles, so that derivatives, limits of the linear range and guards can be set one by
one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmark.metrics.bounds import Bound, cramer_rao, pose_information
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene

Floats = NDArray[np.float64]
#: Oblique and in no plane of the axes, so that no two of them can be taken for each other.
OBLIQUE = np.array([0.35, -0.62, math.sqrt(1 - 0.35**2 - 0.62**2)])
LIGHT = Irradiance(spread=0.04, stray=0.01, stray_spread=0.003)
SLOPES = np.array([[9.0, 2.0], [-4.0, 6.0], [1.5, -5.0], [3.0, 0.5], [0.0, 2.5]])
LEVEL = np.array([3.0, 1.0, 2.0, 0.5, 4.0])
HAZE = np.array([1.0, 2.0, 0.5, 3.0, 1.5])
NOISE = np.array([0.01, 0.03, 0.02, 0.05, 0.04])


@dataclass
class Sensor:
    """Signals I (level + shape(x, y)) + stray haze, of independent noise."""

    sun: Floats
    shape: Callable[[Floats, Floats], Floats]
    level: Floats
    haze: Floats
    noise: Floats
    asked: list[Floats] = field(default_factory=list)

    def expected(self, scene: Scene, pattern: object) -> Floats:
        self.asked.append(scene.sun)
        first, second = tangent_axes(self.sun[None])
        across = np.column_stack([scene.sun @ first[0], scene.sun @ second[0]])
        size = np.sqrt(np.sum(across**2, axis=1))
        turn = np.arctan2(size, scene.sun @ self.sun)
        x, y = (across * (turn / np.where(size > 0, size, 1.0))[:, None]).T
        signal = self.level + self.shape(x, y)
        return scene.irradiance[:, None] * signal + scene.stray[:, None] * self.haze

    def variance(self, mean: Floats) -> Floats:
        return np.broadcast_to(self.noise**2, mean.shape).copy()


def sensor(sun: Floats = OBLIQUE, slopes: Floats = SLOPES) -> Sensor:
    return Sensor(
        sun, lambda x, y: np.column_stack([x, y]) @ slopes.T, LEVEL, HAZE, NOISE[: len(slopes)]
    )


def apart(f: Callable[[Floats], Floats], noise: float = 1.0, level_noise: float = 1e-3) -> Sensor:
    """x through f and y plainly, each in a channel of its own beside the two nuisances'."""
    return Sensor(
        OBLIQUE,
        lambda x, y: np.column_stack([f(x), y, 0 * x, 0 * x]),
        level=np.array([0.0, 0.0, 1.0, 0.0]),
        haze=np.array([0.0, 0.0, 0.0, 1.0]),
        noise=np.array([noise, noise, level_noise, level_noise]),
    )


def bound_of(one: Sensor, irradiance: float = 1.3, light: Irradiance = LIGHT) -> Bound:
    scene = Scene(one.sun[None], np.array([irradiance]), np.array([light.stray]))
    return cramer_rao(one, scene, {}, light)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "sun",
    [OBLIQUE, np.array([0.96, 0.2, math.sqrt(1 - 0.96**2 - 0.04)]), np.array([0.0, 0.0, 1.0])],
)
@pytest.mark.parametrize("noise", [1.0, 1e-3])  # deviations above and below the step
def test_the_bound_is_the_inverse_of_the_whole_fisher_matrix(sun: Floats, noise: float) -> None:
    """All four unknowns inverted at once, the nuisances' priors among them."""
    one = sensor(sun)
    one.noise = noise * NOISE
    found = bound_of(one)
    columns = np.column_stack([1.3 * SLOPES, LEVEL, HAZE]) / one.noise[:, None]
    fisher = columns.T @ columns + np.diag([0, 0, LIGHT.spread**-2, LIGHT.stray_spread**-2])
    covariance = np.linalg.inv(fisher)[:2, :2]
    assert found.observable.tolist() == [True]
    assert found.angle_deg[0] == pytest.approx(
        math.degrees(math.sqrt(np.trace(covariance))), rel=1e-6
    )
    axes = np.stack([axis[0] for axis in tangent_axes(sun[None])])
    for name, across in (("alpha_deg", 1), ("beta_deg", 0)):
        # the angle's change a radian of turn, from the direction turned a little each way
        step = 1e-6
        ahead, behind = (
            [math.atan2(*(sun + sign * step * axis)[[across, 2]]) for axis in axes]
            for sign in (1, -1)
        )
        slope = np.subtract(ahead, behind) / (2 * step)
        expected = math.degrees(math.sqrt(slope @ covariance @ slope))
        assert getattr(found, name)[0] == pytest.approx(expected, rel=1e-6), name


def test_a_channel_that_cannot_change_is_as_good_as_none() -> None:
    """Its variance is infinite; nothing else is."""
    deaf = sensor()
    deaf.noise = np.append(NOISE[:4], np.inf)
    less = sensor(slopes=SLOPES[:4])
    less.level, less.haze, less.noise = LEVEL[:4], HAZE[:4], NOISE[:4]
    assert bound_of(deaf).angle_deg[0] == pytest.approx(bound_of(less).angle_deg[0], rel=1e-9)


@dataclass
class UnknownSensor(Sensor):
    """A `Sensor` whose channels' means are uncertain by `unknown` beside the noise."""

    unknown: Floats = field(default_factory=lambda: np.zeros(5))

    def unit_variance(self, mean: Floats, scene: Scene, references: References) -> Floats:
        return np.broadcast_to(self.unknown**2 / references.flats, mean.shape).copy()

    def reference_readings(self, *_: object) -> dict[str, Floats]:
        return {}


@pytest.mark.parametrize("flats", [1, 4])
def test_what_is_unknown_of_a_unit_is_more_noise_in_the_second_bound_alone(flats: int) -> None:
    plain, unknown = sensor(), 3.0 * NOISE[::-1]
    one = UnknownSensor(plain.sun, plain.shape, LEVEL, HAZE, NOISE, unknown=unknown)
    scene = Scene(one.sun[None], np.array([1.3]), np.array([LIGHT.stray]))
    found = cramer_rao(one, scene, {}, LIGHT, references=References(flats=flats))  # type: ignore[arg-type]
    noisier = sensor()
    noisier.noise = np.sqrt(NOISE**2 + unknown**2 / flats)
    assert found.angle_deg[0] == bound_of(plain).angle_deg[0]
    assert found.unit_angle_deg is not None
    assert found.unit_angle_deg[0] == pytest.approx(bound_of(noisier).angle_deg[0], rel=1e-9)
    assert len(one.asked) == len(plain.asked), "both of the same signals"


@dataclass
class DriftingGains(Sensor):
    """A `Sensor` whose channels each have a gain and a drift, unknown by 0.02 and 0.05."""

    def gain_slopes(self, mean: Floats, scene: Scene) -> Floats:
        age = scene.irradiance  # any number of a sample's own will do
        return np.stack([0.02 * mean, 0.05 * mean * (age - 1.0)[:, None]], axis=-1)

    def gain_information(self, references: References) -> Floats:
        return np.diag([1.0 + references.flats * (0.02 / 0.04) ** 2, 1.0])

    def reference_readings(self, *_: object) -> dict[str, Floats]:
        return {}


@pytest.mark.parametrize("flats", [0, 4])
@pytest.mark.parametrize("poses", [0, 1, 30])
def test_the_second_bound_is_that_of_reading_flats_and_poses_in_one_matrix(
    flats: int, poses: int
) -> None:
    """Direction, light, stray light, five gains and five drifts, inverted at once."""
    one = DriftingGains(sensor().sun, sensor().shape, LEVEL, HAZE, NOISE)
    light = np.linspace(0.6, 1.5, poses)
    calibration = Scene(np.tile(OBLIQUE, (poses, 1)), light, np.full(poses, LIGHT.stray))
    scene = Scene(OBLIQUE[None], np.array([1.3]), np.array([LIGHT.stray]))
    known = pose_information(one, calibration, {})
    found = cramer_rao(  # type: ignore[arg-type]
        one, scene, {}, LIGHT, references=References(flats=flats), poses=known
    )
    fisher = np.diag(
        [0, 0, LIGHT.spread**-2, LIGHT.stray_spread**-2, *[0.02**-2] * 5, *[0.05**-2] * 5]
    )
    fisher[4:9, 4:9] += np.eye(5) * flats / 0.04**2
    rows = [
        (1.3, np.column_stack([1.3 * SLOPES, LEVEL, HAZE])),
        *((i, np.zeros((5, 4))) for i in light),
    ]
    for irradiance, nuisances in rows:
        mean = np.diag(irradiance * LEVEL + LIGHT.stray * HAZE)
        columns = np.hstack([nuisances, mean, (irradiance - 1.0) * mean]) / NOISE[:, None]
        fisher += columns.T @ columns
    covariance = np.linalg.inv(fisher)[:2, :2]
    assert found.unit_angle_deg is not None
    assert found.unit_angle_deg[0] == pytest.approx(
        math.degrees(math.sqrt(np.trace(covariance))), rel=1e-6
    )


def test_a_nuisance_known_well_costs_nothing_and_one_unknown_all_it_can() -> None:
    """One channel for x that sunlight moves as well: what is left of it is the prior's."""
    slopes = np.array([[2.0, 0.0], [0.0, 2.0]])
    one = Sensor(
        OBLIQUE,
        lambda x, y: np.column_stack([x, y]) @ slopes.T,
        level=np.array([1.0, 0.0]),
        haze=np.array([0.0, 1e-9]),
        noise=np.array([0.02, 0.02]),
    )
    for spread in (1e-6, 0.5):
        found = bound_of(one, 1.0, Irradiance(spread=spread, stray=0.0, stray_spread=1.0))
        both = math.sqrt(0.02**2 + (0.02**2 + spread**2)) / 2.0
        assert found.observable[0]
        assert found.angle_deg[0] == pytest.approx(math.degrees(both), rel=1e-6)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("kept", "observable"), [(0.45, False), (0.55, True), (1.0, True), (2.6, False)]
)
def test_within_the_step_each_side_of_each_axis_keeps_half_to_twice_of_its_promise(
    kept: float, observable: bool, side: float, turned: bool
) -> None:
    """One side steeper than the other: the promise is their mean, 1, and each side is asked."""
    one = apart(lambda x: np.where(np.sign(x) == side, kept, 2.0 - kept) * x, noise=1e-6)
    if turned:
        shape = one.shape
        one.shape = lambda x, y: shape(y, x)[:, [1, 0, 2, 3]]
    assert bound_of(one, 1.0).observable.tolist() == [observable]


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("kept", "observable"), [(0.45, False), (0.55, True), (1.9, True), (2.1, False)]
)
def test_beyond_the_step_a_standard_deviation_either_way_keeps_half_to_twice_its_promise(
    kept: float, observable: bool, side: float
) -> None:
    sigma = 0.01
    one = apart(
        lambda x: np.where((np.sign(x) == side) & (np.abs(x) > 0.5 * sigma), kept, 1.0) * x,
        noise=sigma,
    )
    # y is known a hundred times better: x is the weakest axis
    one.noise[1] = sigma / 100
    found = bound_of(one, 1.0)
    assert found.observable.tolist() == [observable]
    assert len(one.asked) == 9  # the mean, two sides of two axes, two nuisances, two far
    if observable:
        assert found.angle_deg[0] == pytest.approx(math.degrees(sigma), rel=1e-3)


def test_a_change_that_sunlight_explains_is_none() -> None:
    """At one deviation the signal has moved as promised, but only as brighter light would."""
    sigma = 0.01
    one = apart(lambda x: x, noise=sigma)
    one.noise[1:] = sigma / 100

    def bent(x: Floats, y: Floats) -> Floats:
        far = np.abs(x) > 0.5 * sigma
        none = np.zeros_like(x)
        # far out the change stands in the channel of sunlight itself
        return np.column_stack([np.where(far, 0.0, x), y, np.where(far, x, 0.0) / 100, none])

    one.shape = bent
    one.level[2] = 1.0
    assert bound_of(one, 1.0, Irradiance(1.0, 0.0, 1.0)).observable.tolist() == [False]


@pytest.mark.parametrize(("sigma", "observable"), [(3.0, True), (3.3, False)])
def test_a_deviation_of_half_a_turn_is_no_knowledge(sigma: float, observable: bool) -> None:
    one = apart(lambda x: x, noise=sigma)
    one.noise[1] = 0.01
    assert bound_of(one, 1.0).observable.tolist() == [observable]


@pytest.mark.parametrize(("share", "observable"), [(1.1e-6, True), (0.9e-6, False)])
def test_an_axis_a_million_times_weaker_than_the_other_is_rounding(
    share: float, observable: bool
) -> None:
    one = apart(lambda x: x, noise=1e-6)
    one.noise[1] = 1e-6 / share
    assert bound_of(one, 1.0).observable.tolist() == [observable]


def test_only_samples_whose_deviation_is_beyond_the_step_are_moved_so_far() -> None:
    """And a bound is of each sample's own light."""
    one = apart(lambda x: x, noise=1e-2)
    scene = Scene(np.tile(OBLIQUE, (2, 1)), np.array([1.0, 100.0]), np.zeros(2))
    found = cramer_rao(one, scene, {}, LIGHT)  # type: ignore[arg-type]
    assert found.angle_deg == pytest.approx(np.degrees(math.sqrt(2) * 1e-2) / [1, 100], rel=1e-3)
    for moved in one.asked[-2:]:
        turn = np.linalg.norm(moved - OBLIQUE, axis=1)
        assert turn == pytest.approx([1e-2, 0.0], abs=1e-4)
    assert {len(asked) for asked in one.asked} == {2}
    one.asked.clear()
    cramer_rao(one, scene, {}, LIGHT, batch=1)  # type: ignore[arg-type]
    assert [len(asked) for asked in one.asked] == [1] * (9 + 7)


def test_the_bound_of_many_is_over_those_that_are_observable() -> None:
    found = Bound(np.array([3.0, np.inf, 4.0]), *np.zeros((2, 3)), np.array([True, False, True]))
    assert found.rms_deg == pytest.approx(math.sqrt(12.5))
    none = Bound(np.full(2, np.inf), *np.zeros((2, 2)), np.zeros(2, bool))
    assert math.isnan(none.rms_deg)


@pytest.mark.parametrize("irradiance", [Irradiance(0.0, 0.1, 0.1), Irradiance(0.1, 0.1, 0.0)])
def test_either_nuisance_without_spread_is_refused(irradiance: Irradiance) -> None:
    with pytest.raises(ValueError, match=r"above 0; got 0\.[01] and 0\.[01]"):
        bound_of(sensor(), 1.0, irradiance)


@pytest.mark.parametrize(("sun_z", "readings"), [(0.0, False), (-0.5, False), (1e-9, True)])
def test_the_axis_angles_are_told_of_suns_in_front_alone(sun_z: float, readings: bool) -> None:
    across = math.sqrt((1 - sun_z**2) / 2)
    found = bound_of(sensor(np.array([across, -across, sun_z])))
    assert found.observable[0]
    assert np.isfinite([found.alpha_deg[0], found.beta_deg[0]]).tolist() == [readings, readings]
    assert np.isnan([found.alpha_deg[0], found.beta_deg[0]]).tolist() == [
        not readings,
        not readings,
    ]
