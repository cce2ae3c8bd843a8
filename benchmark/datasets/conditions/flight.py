"""Time-ordered splits along an orbit: `Flight` (where and when) and `FlightPreset` (a dataset)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from algorithms.context import CONTEXT
from algorithms.contract import Floats
from benchmark.datasets.conditions.flight_bounds import posterior_bound
from benchmark.datasets.conditions.flight_unknowns import Same, unit_angle_deg, unknowns
from benchmark.datasets.conditions.instruments import Instruments
from benchmark.datasets.fields import Split
from benchmark.datasets.preset import DRAWN, Preset, drawn_split
from benchmark.datasets.repeats import REPEAT, Rows
from benchmark.datasets.samples import Samples
from benchmark.metrics.bounds import Bound
from benchmark.seeds import generator
from benchmark.simulator.flight.attitude import Attitude, rotate, turn_frame
from benchmark.simulator.flight.gyro import Gyro
from benchmark.simulator.flight.magnetic_field import TiltedDipole
from benchmark.simulator.flight.orbit import (
    DAY_S,
    YEAR_DAYS,
    CircularOrbit,
    sun_direction,
    sunlight,
)
from benchmark.simulator.flight.time_series import DriftingSensor, TimedScene
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.sensor import GainSpread, SeesEarth
from benchmark.simulator.sensors.faces import Faces

#: Said in every card: what the bound of a time series does not cover.
BOUND_NOTE = (
    "The bound is that of one sample by itself, unit and drift known. Estimators that carry a "
    "state from sample to sample or read other instruments (Kalman filters, fusion with a "
    "magnetometer or horizon sensor) have another: the recursive posterior Cramer-Rao bound of all "
    "readings up to the sample, the gyroscope's noise as simulated and strength of sunlight known, "
    "and of the body's motion what the gyroscope tells. "
    "Samples in eclipse are not observable and do not enter; there a "
    "single-sample estimator should find nothing (NaN), and whatever it does find counts as error."
)


#: Flights and splits whose legs are kept: conditions and units of a data set fly the same ones.
MOST_FLIGHTS = 16


@dataclass(frozen=True)
class Span:
    """Equally spaced moments: `samples` of them, `step_s` apart, from `start_day` on."""

    start_day: float
    samples: int
    step_s: float

    def __post_init__(self) -> None:
        if not (self.samples > 0 and self.step_s > 0 and self.start_day >= 0):
            raise ValueError(
                "samples and step_s must be positive, start_day not negative; got "
                f"{self.samples}, {self.step_s} and {self.start_day}"
            )


@dataclass(frozen=True)
class Leg:
    """One split of a flight, sample by sample; inertial and body vectors (N, 3).

    `time_s` counts from the start of the flight, `since_s` from the start of the leg. `orbit`
    and `sun` (3,) stand still during a leg: they move by less than half a degree. `turn`
    (N, 3, 3) takes inertial vectors to the body frame, `turn_before` a step earlier. `field_nt` is
    the model's.
    """

    orbit: CircularOrbit
    sun: Floats
    sunlight: float
    time_s: Floats
    since_s: Floats
    sun_body: Floats
    nadir: Floats
    nadir_body: Floats
    field_nt: Floats
    turn: Floats
    turn_before: Floats
    eclipse: NDArray[np.bool_]


@dataclass(frozen=True)
class Flight:
    """Where a satellite flies and how it turns, for both splits; a dataset's `directions`.

    Nobody calibrates in the dark: of the calibration's span only the samples in sunlight are
    kept, in the order of time, with gaps where the eclipses are. The test split is whole.

    Attributes
    ----------
    orbit
        On day 0.
    epoch_day
        Days from the March equinox to day 0.
    calibration, test
        When each split is taken, by the flight's days.
    magnetometer_nt, horizon_deg
        Noise a component, and a tangent axis, of two other instruments.
    gyro
        The third; switched on anew for each split.
    """

    orbit: CircularOrbit
    attitude: Attitude
    epoch_day: float
    calibration: Span
    test: Span
    dipole: TiltedDipole = field(default_factory=TiltedDipole)
    magnetometer_nt: float = 200.0
    horizon_deg: float = 0.5
    gyro: Gyro = field(default_factory=Gyro)

    def span(self, split: Split) -> Span:
        """Return when a split is taken."""
        return self.calibration if split == "calibration" else self.test

    def _since(self, span: Span) -> Floats:
        return span.step_s * np.arange(span.samples, dtype=np.float64)

    def leg(self, split: Split) -> Leg:
        """Fly a split; arrays are the caller's own."""
        known = _leg(self, split)
        found = {part.name: getattr(known, part.name) for part in fields(Leg)}
        own: dict[str, Any] = {
            name: part.copy() for name, part in found.items() if isinstance(part, np.ndarray)
        }
        return replace(known, **own)

    def _fly(self, split: Split) -> Leg:
        span = self.span(split)
        since = self._since(span)
        start_s = span.start_day * DAY_S
        orbit = self.orbit.after(span.start_day)
        day = self.epoch_day + span.start_day
        sun = sun_direction(day)
        eclipse = orbit.eclipsed(since, sun)
        if split == "calibration":
            since, eclipse = since[~eclipse], eclipse[~eclipse]
        place = orbit.position(since)
        turn = self.attitude.matrices(orbit, sun, since, start_s)
        return Leg(
            orbit=orbit,
            sun=sun,
            sunlight=sunlight(day),
            time_s=start_s + since,
            since_s=since,
            sun_body=turn_frame(turn, sun),
            nadir=-place,
            nadir_body=turn_frame(turn, -place),
            field_nt=self.dipole.inertial(place, orbit.distance_km, start_s + since),
            turn=turn,
            turn_before=self.attitude.matrices(orbit, sun, since - span.step_s, start_s),
            eclipse=eclipse,
        )

    def sun(self, split: Split, generator: np.random.Generator) -> Floats:
        """(N, 3) unit vectors of a split, body frame; nothing is random."""
        del generator
        return self.leg(split).sun_body

    def card(self) -> dict[str, dict[str, Any]]:
        """By split: size, times and motion."""
        found: dict[str, dict[str, Any]] = {}
        for split in DRAWN:
            span = self.span(split)
            orbit = self.orbit.after(span.start_day)
            sun = sun_direction(self.epoch_day + span.start_day)
            kept = int(np.count_nonzero(~orbit.eclipsed(self._since(span), sun)))
            calibration = split == "calibration"
            found[split] = {
                "samples": kept if calibration else span.samples,
                "directions": f"in the order of time, {span.step_s:g} s apart, "
                f"{'left out in eclipse, ' if calibration else ''}from day "
                f"{span.start_day:g} of the flight; {self.attitude.describe()}",
                "orbits": round(span.samples * span.step_s / orbit.period_s, 3),
                "sun_above_orbit_deg": round(orbit.sun_elevation_deg(sun), 2),
                "eclipse_fraction": round(orbit.eclipse_half_width(sun) / math.pi, 4),
            }
        return found


@lru_cache(MOST_FLIGHTS)
def _leg(flight: Flight, split: Split) -> Leg:
    return flight._fly(split)  # noqa: SLF001 - cached here: a dataclass method cannot be


@lru_cache(8)
def _sample_bound(kept: Same, condition: str, split: str, n: int | None) -> Bound:
    preset: FlightPreset = kept.it
    return Preset.bound(preset, condition, split, n)


@dataclass(frozen=True)
class FlightPreset(Preset):
    """A dataset in the order of time; `directions` is a `Flight`, every sensor a drifting one.

    Samples carry the context columns that `card` lists. The calibration split is flown too, on
    earlier orbits of the same unit, so that filters have a time series to be tuned on.
    """

    def __post_init__(self) -> None:
        if not isinstance(self.directions, Flight):
            raise TypeError(f"directions must be a Flight; got {type(self.directions).__name__}")
        for name, setup in self.setups.items():
            if not hasattr(setup.sensor, "thermal"):
                raise TypeError(f"the sensor of condition {name} must have a thermal cycle")
            if not isinstance(setup.bench, Instruments | None):
                raise TypeError(
                    f"condition {name} must be calibrated in orbit (Instruments), or perfectly "
                    f"(None); got {type(setup.bench).__name__}"
                )
            if setup.earth is not None and (
                setup.earth.altitude_km != self.directions.orbit.altitude_km
                or setup.earth.radius_km != self.directions.orbit.radius_km
            ):
                raise ValueError(
                    f"condition {name} must see Earth from the orbit's altitude of "
                    f"{self.directions.orbit.altitude_km} km; got {setup.earth.altitude_km} km"
                )

    @property
    def flight(self) -> Flight:
        """Where the satellite flies."""
        return cast("Flight", self.directions)

    def _scene(self, condition: str, known: Split, rows: Rows = slice(None)) -> TimedScene:
        """Return what a split looks at; no sunlight, direct or stray, reaches it in eclipse.

        There a window stays where it was when the Sun was last seen.
        """
        setup = self.condition(condition)
        leg = self.flight.leg(known)
        names = (*self.streams, known)
        _, stray = setup.irradiance.draw(len(leg.time_s), generator(*names, "irradiance"))
        sensor = cast("DriftingSensor", self.sensor_for(condition, known))
        origin = sensor.origins(leg.sun_body, generator(*names, "window"))
        if origin is not None:
            origin = origin[_last_seen(~leg.eclipse)]
        scene = TimedScene(
            leg.sun_body,
            np.where(leg.eclipse, 0.0, leg.sunlight),
            np.where(leg.eclipse, 0.0, stray),
            origin,
            temperature_k=sensor.thermal.temperature(leg.orbit, leg.sun, leg.since_s),
            age_years=leg.time_s / (DAY_S * YEAR_DAYS),
        ).rows(rows)
        if setup.earth is None:
            return scene
        # from within the cylinder no sunlit ground is in view
        lit = np.flatnonzero(~leg.eclipse[rows])
        nadir, pattern = leg.nadir_body[rows][lit], self.fixed_pattern(condition, known)
        if isinstance(setup.sensor, Faces):
            light = setup.sensor.earthlight(setup.earth, scene.sun[lit], nadir, pattern)
        else:
            behind = cast("SeesEarth", setup.sensor)
            light = behind.earth_through(setup.earth, nadir, scene.rows(lit), pattern)
        albedo = np.zeros((len(scene), *light.shape[1:]))
        albedo[lit] = leg.sunlight * light
        return replace(scene, albedo=albedo)

    @property
    def context_columns(self) -> tuple[str, ...]:
        """Columns that `context` gives."""
        return tuple(name for name in CONTEXT if name != "illumination")

    def context(self, condition: str, split: str) -> dict[str, NDArray[Any]]:
        """Return what else is known of each sample: the columns of the card's ``context``."""
        if split == REPEAT:
            test = self.context(condition, "test")
            again = np.tile(self.repeats.pose_indices(len(test["time_s"])), self.repeats.passes)
            return {name: column[again] for name, column in test.items()}
        known = drawn_split(split)
        setup = self.condition(condition)
        leg = self.flight.leg(known)
        names = (*self.streams, known)
        noise = generator(*names, "magnetometer").standard_normal((len(leg.time_s), 3))
        first, second = tangent_axes(leg.nadir_body)
        tilt = math.tan(math.radians(self.flight.horizon_deg)) * generator(
            *names, "horizon"
        ).standard_normal((len(leg.time_s), 2))
        seen = leg.nadir_body + tilt[:, :1] * first + tilt[:, 1:] * second
        thermal = cast("DriftingSensor", self.sensor_for(condition, known)).thermal
        temperature = thermal.temperature(leg.orbit, leg.sun, leg.since_s)
        field_nt, offset = leg.field_nt, np.zeros(3)
        aboard = cast("Instruments | None", setup.bench)
        if aboard is not None:
            fixed, distance = self._bench_names, leg.orbit.distance_km
            noisy = self._of_unit(*names, "instruments")
            temperature = aboard.thermometer_k(temperature, fixed, noisy)
            missing = aboard.missing_field(distance, *self.streams)
            field_nt = field_nt + missing.inertial(-leg.nadir, distance, leg.time_s)
            offset = aboard.magnetometer_offset_nt(*fixed)
        read_nt = rotate(leg.turn, field_nt) + offset + self.flight.magnetometer_nt * noise
        step_s = self.flight.span(known).step_s
        drawn = generator(*self._of_unit(*names, "gyro"))
        rate = self.flight.gyro.read(leg.turn, leg.turn_before, leg.time_s, step_s, drawn)
        return {
            "time_s": leg.time_s,
            "temperature_K": temperature,
            "rate_deg_s": rate,
            "eclipse": leg.eclipse,
            "albedo": np.full(len(leg.time_s), setup.earth is not None) & ~leg.eclipse,
            "magnetic_field_nT": read_nt,
            "nadir": seen / np.sqrt(np.sum(seen**2, axis=1, keepdims=True)),
            "sun_inertial": np.repeat(leg.sun[None, :], len(leg.time_s), axis=0),
            "nadir_inertial": leg.nadir,
            "magnetic_field_inertial_nT": leg.field_nt,
        }

    def sample_bound(self, condition: str, split: str, n: int | None = None) -> Bound:
        """Bounds as `Preset.bound`, of a head whose drift and creep are known."""
        return _sample_bound(Same(self), condition, split, n)

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> Bound:
        """As `Preset.bound`; drift and creep are unknown where the unit is, on the test split."""
        single = self.sample_bound(condition, split, n)
        if split != "test":
            return single
        own = unknowns(self, condition)
        if own is None:
            return single
        if isinstance(self.condition(condition).sensor, GainSpread):
            single = replace(single, unit_angle_deg=None)  # gains are in the unknowns
        first = replace(own, fisher=own.fisher[: len(single.observable)])
        return replace(single, unit_angle_deg=unit_angle_deg(first, single))

    def posterior_bound_deg(
        self, condition: str, context: frozenset[str], bound: Bound, *, unit_known: bool = True
    ) -> Floats | None:
        """Return the bound (N,) of a method that reads these columns of the context, degrees.

        None where the bound of single samples holds. A method that reads time and rates carries a
        state (`benchmark.datasets.conditions.flight_bounds.posterior_bound`).
        """
        sequential = {"time_s", "rate_deg_s"} <= context
        return posterior_bound(
            self,
            condition,
            context,
            sequential=sequential,
            bound=bound,
            unit_known=unit_known,
        )

    def generate(self, condition: str, split: str, n: int | None = None) -> Samples:
        """As `Preset.generate`, with the context's columns."""
        plain = super().generate(condition, split, n)
        context = self.context(condition, split)
        return replace(plain, context={name: column[:n] for name, column in context.items()})

    def card(self) -> dict[str, Any]:
        """As `Preset.card`, with the context's columns and what the bound is of."""
        flight = self.flight
        return {
            **super().card(),
            "context": {
                "time_s": "(N,) seconds since the start of the flight",
                "temperature_K": "(N,) of the sensor, as a thermometer with the errors of the "
                "condition's bench reads it",
                "rate_deg_s": "(N, 3) mean rate of the body over the step before, body frame, as a "
                "gyroscope reads it: angle random walk "
                f"{flight.gyro.angle_random_walk_deg_sqrt_h:g} deg/sqrt(h), bias "
                f"{flight.gyro.bias_deg_h:g} deg/h when switched on for the split, wandering by "
                f"{flight.gyro.bias_walk_deg_h_sqrt_h:g} deg/h in an hour",
                "eclipse": "(N,) bool: in Earth's cylindrical shadow, no sunlight at all",
                "albedo": "(N,) bool: whether light from the sunlit Earth is simulated",
                "magnetic_field_nT": "(N, 3) body frame, as a magnetometer reads it: noise of "
                f"{flight.magnetometer_nt:g} nT a component and the bias of the condition's bench",
                "nadir": "(N, 3) unit vectors to Earth's centre, body frame, as a horizon sensor "
                f"reads them: noise of {flight.horizon_deg:g} deg a tangent axis",
                "sun_inertial": "(N, 3) unit vectors to the Sun, inertial frame, from the almanac",
                "nadir_inertial": "(N, 3) unit vectors, inertial frame, from the known orbit",
                "magnetic_field_inertial_nT": "(N, 3) inertial frame, as a model gives it (dipole; "
                "the true field has a quadrupole beside it, as strong as the condition's bench "
                "says)",
            },
            "bound": {"kind": "single sample", "note": BOUND_NOTE},
        }


def _last_seen(lit: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(N,) index of the last lit sample up to each one; of the first lit one before there is."""
    last = np.maximum.accumulate(np.where(lit, np.arange(len(lit)), -1))
    return np.asarray(np.where(last < 0, np.argmax(lit), last), dtype=np.int64)
