"""What a mission does to a sensor that was calibrated on the ground: `Mission`, `Lifetime`.

A `Mission` has the amounts, a `Lifetime` what was drawn of them for one unit.
A unit is looked at in a few moments of its life, each with a temperature and an age of its own. A
mask that shifts by d and rises by dh over a detector at height h moves the image to
``(h + dh) t + d``, t the tangents of the Sun: where a Sun at ``(1 + dh / h) t + d / h`` stood
before. So geometry is changed by the Sun that is shown, and detectors by their own parameters.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Self, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.flight.drift import REFERENCE_K, ThermalCycle
from benchmark.simulator.flight.dust import dust_shift_mm
from benchmark.simulator.flight.orbit import CircularOrbit, sun_direction
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.readout.detectors import DarkCurrent
from benchmark.simulator.readout.pixel_errors import PixelErrors, drawn
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.solar_cells import SolarCells

Sensor = TypeVar("Sensor")

#: Moments of a unit's life at which it is looked at.
MOMENTS = 8
#: Dark signal of a pixel that a particle has hit, over that of the others.
_HOT_FACTOR = 20.0
_ZERO_C_IN_K = 273.15
#: Reflectance of a mask's blackened underside.
_UNDERSIDE = 0.1

#: Amounts (fields of `Mission`) of each effect, by its name.
EFFECTS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "launch": ("launch_shift_um", "launch_height_um"),
        "heat": ("shift_nm_k", "tilt_mdeg_k", "spacer_ppm_k"),
        "mount": ("mount_deg",),
        "gains": ("gain_per_k", "gain_per_year"),
        "dark": ("dark_per_year", "hot_share_per_year", "prnu_per_year", "dark_swing"),
        "dust": ("dust_um",),
        "timing": ("latency_ms",),
        "sunspots": ("sunspot_deg",),
        "converter": ("inl_lsb",),
        "ghost": ("ghost_share",),
        "earth": ("earthlight",),
    }
)

#: Where each amount comes from; what is not named is assumed.
SOURCES: Mapping[str, str] = MappingProxyType(
    {
        "spacer_ppm_k": "thermal expansion of Kovar, stainless steel and aluminium, one a unit",
        "gain_per_k": "as the photodiodes of pd-orbit: 0.02 %/K from element to element",
        "gain_per_year": "as the photodiodes of pd-orbit: 1 % a year from element to element",
        "dark_per_year": "some 10 times in 2.5 years, half of the condition aged, whose source is "
        "Liu et al., arXiv:2312.01851",
        "ghost_share": "three hundredths are bare silicon under blackened chromium "
        "(`benchmark.simulator.optics.ghosts`); a tenth of that with coatings",
        "thermal": "as the data sets in orbit: a small body on a 600 km orbit with eclipses",
        "earthlight": "clouds as of albedo-clouds: King et al. 2013 and CERES",
    }
)


@dataclass(frozen=True)
class Mission:
    """Amounts of what changes between calibration and flight; of those drawn a standard deviation.

    Attributes
    ----------
    launch_shift_um, launch_height_um
        Shift of the mask an axis, and of its height, at launch.
    shift_nm_k, tilt_mdeg_k
        Shift and tilt an axis for a kelvin.
    spacer_ppm_k
        Expansion of the spacer between mask and detector, one of these a unit.
    mount_deg
        Rotation of the mount about each axis, beside what was measured of it.
    gain_per_k, gain_per_year
        Relative gain of an element of a few (photodiodes, cells) for a kelvin and a year.
    dark_per_year, hot_share_per_year, prnu_per_year
        Growth of the dark signal in units of the first, share of pixels hit, growth of the pixels'
        spread of gains: by dose.
    dark_swing
        Whether the dark signal follows the temperature (1) or not (0).
    dust_um
        Diameter of a particle at the rim of one opening (`dust_shift_mm`): of a lens, none.
    latency_ms, rate_deg_s
        Error of the time stamp, and how fast the satellite turns.
    sunspot_deg
        How far spots move the Sun's centre of light.
    inl_lsb
        Integral nonlinearity of the converter, in its steps; also on the ground.
    ghost_share
        Least and most of the light that comes a second time, log-uniform; also on the ground.
    earthlight
        Whether the clouded Earth is seen (1) or not (0).
    years, thermal
        Length of the mission; temperatures along its orbit.
    """

    launch_shift_um: float = 0.3
    launch_height_um: float = 0.15
    shift_nm_k: float = 10.0
    tilt_mdeg_k: float = 0.2
    spacer_ppm_k: tuple[float, ...] = (5.0, 17.0, 23.0)
    mount_deg: float = 0.005
    gain_per_k: float = 2e-4
    gain_per_year: float = 0.01
    dark_per_year: float = 4.0
    hot_share_per_year: float = 0.001
    prnu_per_year: float = 0.001
    dark_swing: float = 1.0
    dust_um: float = 10.0
    latency_ms: float = 1.0
    rate_deg_s: float = 0.5
    sunspot_deg: float = 0.0003
    inl_lsb: float = 1.0
    ghost_share: tuple[float, ...] = (0.003, 0.03)
    earthlight: float = 1.0
    years: float = 2.5
    thermal: ThermalCycle = field(default_factory=ThermalCycle)

    def __post_init__(self) -> None:
        for one in dataclasses.fields(self):
            value = getattr(self, one.name)
            for number in value if isinstance(value, tuple) else (value,):
                if not isinstance(number, ThermalCycle) and not (
                    math.isfinite(number) and number >= 0
                ):
                    raise ValueError(f"{one.name} must be finite, not negative; got {value}")

    @property
    def sources(self) -> dict[str, str]:
        """Where each amount comes from, by its name."""
        return {one.name: SOURCES.get(one.name, "assumed") for one in dataclasses.fields(self)}

    def times(self, factor: float) -> Self:
        """Return the mission with its amounts times a factor; material, and what is on, stay."""
        scaled = {
            name: factor * getattr(self, name)
            for names in EFFECTS.values()
            for name in names
            if name not in {"dark_swing", "earthlight", "spacer_ppm_k", "ghost_share"}
        }
        return dataclasses.replace(self, **scaled)

    def without(self, *effects: str) -> Self:
        """Return the mission without some of its `EFFECTS`; ValueError for one that is none."""
        return dataclasses.replace(self, **_nothing(self, _known(effects)))

    def alone(self, *effects: str) -> Self:
        """Return the mission with these of its `EFFECTS` alone; ValueError for one that is none."""
        kept = _known(effects)
        return self.without(*(name for name in EFFECTS if name not in kept))

    def lifetime(self, *names: str | int) -> Lifetime:
        """Draw what happens to the unit of this name."""
        return Lifetime.drawn(self, *names)


@dataclass(frozen=True)
class Moment:
    """One unit at one moment: its temperature and age, and how its head stands.

    Attributes
    ----------
    temperature_c, age_years
        Of the sensor.
    turn_deg
        Rotation of the head about x, y and z against the calibrated one.
    shift_mm
        Of the mask along x and y, and of its height.
    expansion
        Relative, of the height.
    """

    temperature_c: float
    age_years: float
    turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shift_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    expansion: float = 0.0

    def seen(self, sun: Floats, sensor: object) -> Floats:
        """(N, 3) Suns that the calibrated head would see as the moved one sees `sun` (N, 3)."""
        x, y, z = self.turn_deg
        turned = Assembly(tilt_x_deg=x, tilt_y_deg=y, rotation_deg=z).to_head(sun)
        height = height_mm(sensor)
        if height is None or not (any(self.shift_mm) or self.expansion):
            return turned
        dx, dy, dh = self.shift_mm
        longer = 1.0 + self.expansion + dh / height
        depth = turned[:, 2]
        moved = np.stack(
            [
                longer * turned[:, 0] + dx / height * depth,
                longer * turned[:, 1] + dy / height * depth,
                depth,
            ],
            axis=1,
        )
        # behind the mask there is nothing to move
        moved = np.where(depth[:, None] > 0, moved, turned)
        return np.asarray(moved / np.sqrt(np.sum(moved**2, axis=1, keepdims=True)))


@dataclass(frozen=True)
class Lifetime:
    """What a mission does to one unit.

    Attributes
    ----------
    mission
        Its amounts.
    names
        Of the unit: what each element does is drawn when its number is known.
    moments
        At which it is looked at, in sunlight.
    eclipse
        In the shadow half-way through, where dark readings are taken again.
    dust
        On which side of its opening a particle lies, (x, y) of any length.
    ghost
        Share of the light that comes a second time.
    """

    mission: Mission
    names: tuple[str | int, ...]
    moments: tuple[Moment, ...]
    eclipse: Moment
    dust: tuple[float, float] = (1.0, 0.0)
    ghost: float = 0.0

    @classmethod
    def drawn(cls, mission: Mission, *names: str | int) -> Self:
        """Draw moments and what is the same at all of them."""
        head = generator(*names, "head")
        launch = head.standard_normal(3) * (
            1e-3 * np.array([mission.launch_shift_um] * 2 + [mission.launch_height_um])
        )
        shift_k = 1e-6 * mission.shift_nm_k * head.standard_normal(2)
        tilt_k = 1e-3 * mission.tilt_mdeg_k * head.standard_normal(2)
        mount = mission.mount_deg * head.standard_normal(3)
        ppm = mission.spacer_ppm_k
        spacer_k = 1e-6 * ppm[int(head.integers(len(ppm)))] if ppm else 0.0
        dust = head.standard_normal(2)
        sunlit, shade = _temperatures(mission.thermal)
        order = generator(*names, "warmth").permutation(MOMENTS)
        sky = generator(*names, "sky").standard_normal((MOMENTS, 4))
        late = 1e-3 * mission.latency_ms * mission.rate_deg_s
        moments = []
        for number, which in enumerate(order.tolist()):
            warmer = sunlit[which] - (REFERENCE_K - _ZERO_C_IN_K)
            apart = mission.sunspot_deg * sky[number, :2] + late * sky[number, 2:]
            turn = mount + np.array([*(tilt_k * warmer + apart), 0.0])
            shift = launch + np.array([*(shift_k * warmer), 0.0])
            moments.append(
                Moment(
                    sunlit[which],
                    mission.years * (number + 0.5) / MOMENTS,
                    cast("Any", tuple(turn.tolist())),
                    cast("Any", tuple(shift.tolist())),
                    float(spacer_k * warmer),
                )
            )
        side, ghost = (float(dust[0]), float(dust[1])), 0.0
        if mission.ghost_share:
            least, most = map(math.log, mission.ghost_share)
            ghost = math.exp(least + (most - least) * float(generator(*names, "ghost").random()))
        eclipse = Moment(shade, mission.years / 2.0)
        return cls(mission, names, tuple(moments), eclipse, side, ghost)

    def built(self, sensor: Sensor) -> Sensor:
        """Return the sensor as it was built: with a ghost, where that is simulated."""
        held: Any = sensor
        if not self.ghost or getattr(held, "ghost", self) is not None:
            return sensor
        seen = Ghost(self.ghost / _UNDERSIDE, _UNDERSIDE)
        return cast("Sensor", dataclasses.replace(held, ghost=seen))

    def at(self, moment: Moment, sensor: object) -> Moment:
        """Return a moment with what depends on the sensor: dust shifts the light of its opening."""
        shift = dust_shift_mm(sensor, 1e-3 * self.mission.dust_um)
        if not shift:
            return moment
        x, y, height = moment.shift_mm
        one, other = self.dust
        size = math.hypot(one, other)
        return dataclasses.replace(
            moment, shift_mm=(x + shift * one / size, y + shift * other / size, height)
        )

    def sensor(self, sensor: Sensor, moment: Moment) -> Sensor:
        """Return the sensor at a moment: as warm and as old."""
        mission, age = self.mission, moment.age_years
        warm = moment.temperature_c if mission.dark_swing else 25.0

        def changed(part: Any) -> Any:
            if isinstance(part, DarkCurrent):
                grown = part.at_25_c * (1.0 + mission.dark_per_year * age)
                return dataclasses.replace(part, at_25_c=grown, temperature_c=warm)
            if isinstance(part, PixelErrors):
                share = min(1.0, part.hot + mission.hot_share_per_year * age)
                return dataclasses.replace(part, hot=share, hot_factor=_HOT_FACTOR)
            if isinstance(part, SolarCells):
                return dataclasses.replace(part, temperature_c=warm)
            if any(one.name == "gate_s" for one in dataclasses.fields(part)):
                dark = changed(part.dark)
                return dataclasses.replace(part, dark=dark, temperature_c=warm)
            return None

        return cast("Sensor", _replaced(sensor, changed))

    def pattern(self, pattern: FixedPattern, moment: Moment) -> FixedPattern:
        """Return the unit's elements at a moment: their gains drift, those of pixels spread."""
        mission, gain = self.mission, np.asarray(pattern["gain"])
        shape = gain.shape
        if {"dark_e", "threshold"} & set(pattern):
            spread = mission.prnu_per_year * moment.age_years
            if not spread:
                return pattern
            dose = drawn("normal", shape, *self.names, "dose")
            return {**pattern, "gain": np.maximum(gain * (1.0 + spread * dose), 0.0)}
        per_k, per_year = generator(*self.names, "gains").standard_normal((2, *shape))
        warmer = moment.temperature_c + _ZERO_C_IN_K - REFERENCE_K
        factor = (1.0 + mission.gain_per_k * warmer * per_k) * (
            1.0 - mission.gain_per_year * moment.age_years * per_year
        )
        return {**pattern, "gain": np.maximum(gain * factor, 0.0)}

    def read(self, observations: NDArray[Any], sensor: object) -> NDArray[Any]:
        """Return readings (N, ...) as the bent converter of a sensor gives them.

        One wave over its range, of the mission's integral nonlinearity; the phase is the unit's.
        Of a sensor that counts pulses or times there is no converter.
        """
        amount, converter = self.mission.inl_lsb, _converter(sensor)
        if not amount or converter is None:
            return observations
        step, codes = converter
        phase = math.tau * float(generator(*self.names, "converter").random())
        # by a table: NumPy's sine has other last bits on other processors
        wave = np.array([amount * math.sin(math.tau * n / _WAVE + phase) for n in range(_WAVE + 1)])

        def bent(readings: NDArray[Any]) -> NDArray[Any]:
            place = np.asarray(readings, np.float64) / (step * codes) * _WAVE
            return wave[np.clip(np.rint(place), 0, _WAVE).astype(np.int64)]

        if np.issubdtype(observations.dtype, np.integer):
            # every code once, and frames by the table of them
            known, most = np.arange(int(codes)), int(codes) - 1
            read = np.clip(np.rint(known + bent(known)), 0, most)
            # a full pixel stays full, an empty one empty
            read = np.where((known == 0) | (known >= most), known, read)
            table, found = read.astype(observations.dtype), np.empty_like(observations)
            for n in range(len(found)):
                one = slice(n, n + 1)
                np.take(table, observations[one], out=found[one], mode="clip")  # "raise" copies
            return found
        return np.asarray(observations + step * np.rint(bent(observations)))


#: Places in the table of a converter's bend.
_WAVE = 4096


def height_mm(sensor: object) -> float | None:
    """Return the distance from mask, or lens, to detector; None of a sensor without."""
    camera = _camera(sensor)
    lens = getattr(camera, "lens", None)
    return getattr(lens if lens is not None else camera, "focal_length_mm", None)


def _camera(sensor: object) -> Any:
    camera: Any = getattr(sensor, "camera", None)
    return camera


def _converter(sensor: object) -> tuple[float, float] | None:
    """Return the size of a code in a reading's unit, and how many there are; None without."""
    for owner in (sensor, _camera(sensor)):
        for name in ("detector", "readout"):
            part: Any = getattr(owner, name, None)
            if hasattr(part, "bits"):
                return float(getattr(part, "step_ua", 1.0)), 2.0**part.bits
    return None


@lru_cache(8)
def _temperatures(thermal: ThermalCycle) -> tuple[tuple[float, ...], float]:
    """Return temperatures (deg C) spread evenly over sunlight, and the median of the eclipse."""
    orbit, sun = CircularOrbit(), sun_direction(0.0)
    time_s = np.linspace(0.0, orbit.period_s, 400, endpoint=False)
    kelvin = thermal.temperature(orbit, sun, time_s)
    dark = orbit.eclipsed(time_s, sun)
    lit = np.sort(kelvin[~dark])
    chosen = lit[((np.arange(MOMENTS) + 0.5) / MOMENTS * len(lit)).astype(np.int64)]
    shade = np.sort(kelvin[dark])
    return tuple((chosen - _ZERO_C_IN_K).tolist()), float(shade[len(shade) // 2] - _ZERO_C_IN_K)


def _replaced(value: Any, change: Any) -> Any:
    """Return a dataclass whose parts are changed where `change` gives another one."""
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return value
    new = change(value)
    if new is not None:
        return new
    parts = {
        one.name: (part, _replaced(part, change))
        for one in dataclasses.fields(value)
        if one.init
        for part in (getattr(value, one.name),)
    }
    changed = {name: new for name, (old, new) in parts.items() if new is not old}
    return dataclasses.replace(value, **changed) if changed else value


def _known(effects: tuple[str, ...]) -> tuple[str, ...]:
    for name in effects:
        if name not in EFFECTS:
            raise ValueError(f"no effect {name!r}; there are {', '.join(EFFECTS)}")
    return effects


def _nothing(mission: Mission, effects: tuple[str, ...]) -> dict[str, Any]:
    names = [name for effect in effects for name in EFFECTS[effect]]
    return {name: () if isinstance(getattr(mission, name), tuple) else 0.0 for name in names}


#: Missions that spare a sensor or strain it: about a third and three times of the typical amounts,
#: and the spacer that expands least or most.
LEVELS: Mapping[str, Mission] = MappingProxyType(
    {
        "benign": Mission(spacer_ppm_k=(5.0,), ghost_share=(0.001, 0.01)).times(0.3),
        "typical": Mission(),
        "harsh": Mission(spacer_ppm_k=(23.0,), ghost_share=(0.01, 0.1)).times(3.0),
    }
)
