"""`Preset`: a named, versioned, seeded dataset; its samples, parameters, bound and card."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any, Self, cast, get_args

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Observation, SensorGeometry
from benchmark.contract import SPLITS
from benchmark.datasets.calibration import IDEAL, STANDARD_BENCH, Bench, Reference
from benchmark.datasets.card import stream_names, without_repeats
from benchmark.datasets.fields import Field, Split
from benchmark.datasets.parameters import describe
from benchmark.datasets.realism import hardware_match
from benchmark.datasets.repeats import REPEAT, Repeats, Rows
from benchmark.datasets.samples import Samples
from benchmark.datasets.units import assemble, tolerances
from benchmark.metrics.bounds import STEP_RAD, Bound, cramer_rao, pose_information
from benchmark.seeds import generator
from benchmark.simulator import SIMULATOR_VERSION
from benchmark.simulator.flight.mission import Lifetime, Mission
from benchmark.simulator.flight.spin import Spin
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern, GainSpread, SeesEarth, Sensor, UnitSpread
from benchmark.simulator.sensors.faces import Faces

#: Splits that a field of directions is drawn for.
DRAWN: tuple[Split, ...] = get_args(Split)
#: Samples simulated together; memory only, the numbers do not depend on it.
BATCH = 64


@dataclass(frozen=True)
class Condition:
    """One condition of a dataset.

    Attributes
    ----------
    description
        What differs from the nominal condition, and why.
    sensor
        The sensor under this condition.
    irradiance
        How sunlight and stray light vary from sample to sample.
    earth
        Sunlit Earth in view on the test split (calibration happens on the ground), or None.
    geometry
        Nominal design where it differs from the dataset's, else None.
    bench
        What the calibration split is taken on; None for a perfect one, which knows the Sun.
    spin
        How the sensor turns while test samples are exposed, at known rates, or None.
    calibrated
        The sensor as it was when it was calibrated, new and at 25 deg C; None for `sensor`.
    renewed
        Whether dark and flat readings are taken again of `sensor`, after the calibration.
    mission
        What happens to it between calibration and test, or None.
    """

    description: str
    sensor: Sensor
    irradiance: Irradiance
    earth: Earth | None = None
    geometry: SensorGeometry | None = None
    bench: Reference | None = STANDARD_BENCH
    spin: Spin | None = None
    calibrated: Sensor | None = None
    renewed: bool = False
    mission: Mission | None = None

    def __post_init__(self) -> None:
        if self.renewed and self.calibrated is None:
            raise ValueError("renewed readings need a sensor `calibrated` before; got None")
        if self.spin is not None and not getattr(self.sensor, "sees_motion", False):
            raise ValueError(
                "motion is simulated for frames that are exposed over time (RollingFrameSensor); "
                f"got {type(self.sensor).__name__}"
            )
        if self.earth is not None and not isinstance(self.sensor, Faces | SeesEarth):
            raise ValueError(
                "light from the Earth is simulated for faces and for sensors behind openings; got "
                f"{type(self.sensor).__name__}"
            )

    def referred(self, split: str = "calibration") -> Sensor:
        """Return the sensor whose dark and flat readings a split is corrected by."""
        if split != "calibration" and self.renewed:
            return self.sensor
        return self.calibrated or self.sensor


@dataclass(frozen=True)
class Preset:
    """A standard dataset.

    All conditions share one sensor unit, and the Suns, irradiances and window offsets of a split;
    only what a condition names and the noise differ: conditions compare sample by sample.

    Attributes
    ----------
    name, version
        ``<detector>-<mask>[-variant]``; raised when the data change on purpose.
    detector, mask
        Values of the survey's taxonomy.
    observation, units
        What `Samples.observations` holds.
    geometry
        Nominal design; `geometry_for` gives a condition's own.
    setups, directions
        The conditions by name; Sun directions of the splits.
    follows
        Study keys whose architecture the dataset follows.
    description, regime
        In words: where the numbers come from; how light is propagated and why that is enough.
    bound_step_rad
        Half step of the bound's differences (see `benchmark.metrics.bounds.cramer_rao`).
    offered
        Flat and dark readings that a calibration has beside its poses (`references`).
    repeats, unit
        Poses and passes of the split ``repeat``; which unit of the sensor is seen (`for_unit`).
    batch
        Samples simulated together, `BATCH` for None; large frames are faster a few at a time.
    drawn_as
        Version that its random streams are named by, where a later one changed some conditions, or
        what is known beside the readings, and drew nothing anew; None for its own.
    """

    name: str
    version: int
    detector: str
    mask: str
    observation: Observation
    units: str
    geometry: SensorGeometry
    setups: Mapping[str, Condition]
    directions: Field
    follows: tuple[str, ...]
    description: str
    regime: Mapping[str, Any] = field(default_factory=dict)
    bound_step_rad: float = STEP_RAD
    offered: References = field(default_factory=References)
    repeats: Repeats = field(default_factory=Repeats)
    unit: int = 0
    batch: int | None = None
    drawn_as: int | None = None

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions, ``nominal`` first."""
        return tuple(self.setups)

    @property
    def streams(self) -> tuple[str, int]:
        """Name and version that random streams begin with."""
        return self.name, self.version if self.drawn_as is None else self.drawn_as

    @property
    def context_columns(self) -> tuple[str, ...]:
        """Columns that its samples have beside observations; none but in flight."""
        return ()

    def condition(self, name: str) -> Condition:
        """Return the condition of this name; ValueError naming the known ones."""
        if name not in self.setups:
            raise ValueError(
                f"dataset {self.name} has no condition {name!r}; it has "
                f"{', '.join(self.conditions)}"
            )
        return self.setups[name]

    def geometry_for(self, condition: str) -> SensorGeometry:
        """Return the nominal design under this condition."""
        return self.condition(condition).geometry or self.geometry

    def for_unit(self, number: int) -> Self:
        """Return the dataset of another unit, with its own errors; 0 is the standard one.

        Raises
        ------
        ValueError
            For a number below 0, and on a preset that is another unit already.
        """
        if number < 0:
            raise ValueError(f"units are numbered from 0; got {number}")
        if self.unit != 0:
            raise ValueError(f"units are drawn from unit 0; this is unit {self.unit}")
        if number == 0:
            return self
        unit = (*self.streams, "unit", number)
        setups = dict(self.setups)
        for name, setup in self.setups.items():
            before = setup.calibrated
            setups[name] = dataclasses.replace(
                setup,
                sensor=assemble(setup.sensor, *unit),
                calibrated=None if before is None else assemble(before, *unit),
            )
        return dataclasses.replace(self, setups=setups, unit=number)

    def reference_error_deg(self, condition: str) -> float:
        """Root mean square of what the calibration's directions are wrong by, always alike.

        Over the field and the benches that may have been used: of the sizes stated, not of what one
        bench drew. No number of poses takes it away; 0 where the calibration is perfect.
        """
        bench = self.condition(condition).bench
        if bench is None:
            return 0.0
        drawn = generator(*self.streams, "test", "sun")
        return bench.systematic_deg(self.directions.sun("test", drawn))

    def with_ideal_calibration(self) -> Self:
        """Return the dataset with one condition more: the first one, perfectly calibrated."""
        said = "As nominal, but calibrated with true directions and an ideal lamp."
        shown = dataclasses.replace(next(iter(self.setups.values())), description=said, bench=None)
        return dataclasses.replace(self, setups={**self.setups, IDEAL: shown})

    def _of_unit(self, *names: str | int) -> tuple[str | int, ...]:
        """Names of a random stream that every unit has of its own."""
        return (*names, "unit", self.unit) if self.unit else names

    @property
    def _tested(self) -> int:
        """Samples of the test split."""
        return int(self.directions.card()["test"]["samples"])

    @property
    def _bench_names(self) -> tuple[str | int, ...]:
        """Names of the random streams of the calibration's errors."""
        return self._of_unit(*self.streams, "bench")

    def sensor_for(self, condition: str, split: str) -> Sensor:
        """Return the sensor as a split is taken with it: before a lamp the Sun has its size."""
        setup = self.condition(condition)
        if split != "calibration":
            return setup.sensor
        sensor = setup.calibrated or setup.sensor
        return setup.bench.seen_by(sensor) if isinstance(setup.bench, Bench) else sensor

    def fixed_pattern(self, condition: str, split: str = "test") -> FixedPattern:
        """Return the unit as a split shows it under this condition."""
        unit = (self.unit,) if self.unit else ()
        setup = self.condition(condition)
        before = split == "calibration" and setup.calibrated is not None
        sensor = cast("Sensor", setup.calibrated) if before else setup.sensor
        return sensor.fixed_pattern(*self.streams, "unit", *unit)

    def lifetime(self, condition: str) -> Lifetime | None:
        """Return what the condition's mission does to this unit; None without one."""
        mission = self.condition(condition).mission
        if mission is None:
            return None
        return mission.lifetime(*self._of_unit(*self.streams, "mission"))

    def taken(
        self, condition: str, split: str, scene: Scene
    ) -> Iterator[tuple[Sensor, Scene, FixedPattern]]:
        """Give the samples of a split in parts, each with the sensor and the unit as they are then.

        Parameters
        ----------
        condition, split
            Which.
        scene
            Its first samples, or all, in order.

        Yields
        ------
        sensor, scene, pattern
            One part, but for a test on a mission: one a moment of it, the Suns as the head that was
            calibrated would see them. A repeat is taken at one moment.
        """
        sensor = self.sensor_for(condition, split)
        pattern, lifetime = self.fixed_pattern(condition, split), self.lifetime(condition)
        if lifetime is not None:
            sensor = lifetime.built(sensor)
        if lifetime is None or split == "calibration":
            yield sensor, scene, pattern
            return
        moments = lifetime.moments
        if split == REPEAT:
            moments = moments[len(moments) // 2 :][:1]
        total = len(scene) if split == REPEAT else self._tested
        ends = [total * (k + 1) // len(moments) for k in range(len(moments))]
        for start, stop, moment in zip([0, *ends], ends, moments, strict=False):
            part = scene.part(start, min(stop, len(scene)))
            if len(part):
                seen = lifetime.at(moment, sensor).seen(part.sun, sensor)
                then = lifetime.sensor(sensor, moment)
                unit = (self.unit,) if self.unit else ()
                built = then.fixed_pattern(*self.streams, "unit", *unit)
                yield then, part.seen_from(seen), lifetime.pattern(built, moment)

    def scene(self, condition: str, split: str, n: int | None = None) -> Scene:
        """All light of a split's first n samples, or of all; ValueError for n below 1."""
        if n is not None and n < 1:
            raise ValueError(f"n must be at least 1; got {n}")
        if split == REPEAT:
            return self.repeats.scene(partial(self._scene, condition, "test"), self._tested, n)
        return self._scene(condition, drawn_split(split), slice(n))

    def _scene(self, condition: str, known: Split, rows: Rows = slice(None)) -> Scene:
        """`scene` of some rows of a split that directions are drawn for.

        What is drawn is drawn for all of them; the Earth, which costs more, is seen from these.
        """
        setup = self.condition(condition)
        names = (*self.streams, known)
        sun = self.directions.sun(known, generator(*names, "sun"))
        light, stray = setup.irradiance.draw(len(sun), generator(*names, "irradiance"))
        if known == "calibration" and isinstance(setup.bench, Bench):
            light = setup.bench.light(sun, *self._bench_names)  # no seasons before a lamp
        origin = setup.sensor.origins(sun, generator(*names, "window"))
        rate = None
        if setup.spin is not None and known == "test":
            rate = setup.spin.draw(len(sun), generator(*names, "spin"))
        bare = Scene(sun, light, stray, origin, None, rate).rows(rows)
        if setup.earth is None or known != "test":
            return bare
        nadir = setup.earth.draw_nadir(sun, generator(*names, "nadir"))[rows]
        pattern = self.fixed_pattern(condition, known)
        if isinstance(setup.sensor, Faces):
            seen = setup.sensor.earthlight(setup.earth, bare.sun, nadir, pattern)
        else:
            behind = cast("SeesEarth", setup.sensor)
            seen = behind.earth_through(setup.earth, nadir, bare, pattern)
        albedo = bare.irradiance.reshape(-1, *(1,) * (seen.ndim - 1)) * seen
        return dataclasses.replace(bare, albedo=albedo)

    def generate(self, condition: str, split: str, n: int | None = None) -> Samples:
        """Simulate a split, ``calibration``, ``test`` or ``repeat``: always the same numbers.

        Parameters
        ----------
        condition, split
            Which.
        n
            Only the first n samples, or all there are where that is fewer; the same numbers.

        Raises
        ------
        ValueError
            On an unknown condition or split, naming the known ones; on n below 1.
        """
        scene = self.scene(condition, split, n)
        streams = NoiseStreams.named(*self._of_unit(*self.streams, condition, split))
        # passes over the same poses share their light where light is remembered
        poses = len(self.repeats.pose_indices(self._tested))
        size = poses if split == REPEAT else self.batch or BATCH
        # filled batch by batch: joining a list of batches would hold everything twice
        observations, done = np.empty(0), 0
        for sensor, seen, pattern in self.taken(condition, split, scene):
            for start in range(0, len(seen), size):
                batch = sensor.observe(seen.part(start, start + size), pattern, streams)
                if not done:
                    observations = np.empty((len(scene), *batch.shape[1:]), batch.dtype)
                observations[done : done + len(batch)] = batch
                done += len(batch)
                del batch  # or two would be held while the next is made
        lifetime = self.lifetime(condition)
        if lifetime is not None:
            observations = lifetime.read(observations, self.condition(condition).sensor)
        bench = self.condition(condition).bench
        if split != "calibration" or bench is None:
            return Samples(observations, scene.sun, scene.origin_px)
        said = bench.report(scene.sun, *self._bench_names)
        return Samples(observations, said, scene.origin_px, true_sun=scene.sun)

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> Bound:
        """Cramer-Rao bounds of every sample of a split (see `benchmark.metrics.bounds.cramer_rao`).

        With the unit known, and with what `references` and the poses of the calibration tell of
        it. Parameters as `generate`.
        """
        light = self.condition(condition).irradiance
        poses = None
        if isinstance(self.sensor_for(condition, "calibration"), GainSpread):
            calibrated = self.taken(condition, "calibration", self.scene(condition, "calibration"))
            poses = pose_information(
                *cast("tuple[GainSpread, Scene, FixedPattern]", next(calibrated))
            )
        parts = [
            cramer_rao(
                sensor,
                seen,
                pattern,
                light,
                self.bound_step_rad,
                self.batch or BATCH,
                self.offered,
                poses,
            )
            for sensor, seen, pattern in self.taken(
                condition, split, self.scene(condition, split, n)
            )
        ]
        return parts[0] if len(parts) == 1 else Bound.join(parts)

    def references(self, condition: str, split: str = "calibration") -> dict[str, NDArray[Any]]:
        """Mean flat and dark readings of this unit, by which a split is corrected.

        Those of the calibration, unless the condition renews them. Of every element of the
        detector: ``dark_dn`` and ``flat_dn`` of pixels, ``_ua`` of currents, ``_hz`` of
        frequencies. Empty for sensors whose elements have no readings of
        their own (lenses with trails, events). Light and number: `offered`.

        Raises
        ------
        ValueError
            On an unknown condition, naming the known ones.
        """
        sensor = self.condition(condition).referred(split)
        if not isinstance(sensor, UnitSpread):
            return {}
        lifetime = self.lifetime(condition)
        if lifetime is not None and split != "calibration":
            return self._dark_again(condition, lifetime)
        renewed = split != "calibration" and self.condition(condition).renewed
        if condition == self.conditions[0] and not renewed:
            return dict(self._on_ground)
        return self._reference_readings(condition, renewed=renewed)

    @cached_property
    def _on_ground(self) -> dict[str, NDArray[Any]]:
        """References of the first condition, by which others are corrected, too."""
        return self._reference_readings(self.conditions[0], renewed=False)

    def _reference_readings(self, condition: str, *, renewed: bool) -> dict[str, NDArray[Any]]:
        sensor = cast(
            "UnitSpread", self.condition(condition).referred("test" if renewed else "calibration")
        )
        named = (condition, "references", *(("renewed",) if renewed else ()))
        streams = NoiseStreams.named(*self._of_unit(*self.streams, *named))
        pattern = self.fixed_pattern(condition, "test" if renewed else "calibration")
        return sensor.reference_readings(pattern, self.offered, streams)

    def _dark_again(self, condition: str, lifetime: Lifetime) -> dict[str, NDArray[Any]]:
        """Return the references of the ground, dark readings replaced by those in an eclipse.

        A condition with a mission flies the sensor of the first one, whose references these are.
        """
        ground = self.references(self.conditions[0])
        sensor = lifetime.sensor(self.condition(condition).sensor, lifetime.eclipse)
        unit = (self.unit,) if self.unit else ()
        built = sensor.fixed_pattern(*self.streams, "unit", *unit)
        streams = NoiseStreams.named(*self._of_unit(*self.streams, condition, "eclipse"))
        darks = dataclasses.replace(self.offered, flats=0)
        again = cast("UnitSpread", sensor).reference_readings(built, darks, streams)
        found = {}
        for name, reading in ground.items():
            dark = name.replace("flat_", "dark_")
            # a flat is its dark and the light, and the light was seen on the ground alone
            found[name] = again[dark] if name == dark else reading - ground[dark] + again[dark]
        return found

    def parameters(self, condition: str) -> dict[str, Any]:
        """Everything the numbers of a condition depend on, as plain JSON values."""
        setup = self.condition(condition)
        named = {
            "simulator_version": SIMULATOR_VERSION,
            "dataset": self.name,
            "dataset_version": self.version,
            "condition": condition,
            "sensor": setup.sensor,
            "irradiance": setup.irradiance,
            "earth": setup.earth,
            "bench": setup.bench,
            "directions": self.directions,
            "geometry": self.geometry_for(condition),
            "bound_step_rad": self.bound_step_rad,
            "offered": self.offered,
            "repeats": self.repeats,
            "unit": self.unit,
            "spin": setup.spin,
        }
        if setup.calibrated is not None:
            named |= {"calibrated": setup.calibrated, "renewed": setup.renewed}
        if setup.mission is not None:
            named["mission"] = setup.mission
        return dict(describe(named))

    def card(self) -> dict[str, Any]:
        """Everything a reader of the dataset needs, as plain JSON values; renders nothing.

        ``parameters`` are those of the first condition. ``conditions`` have of their own only what
        differs: members of ``parameters`` (an object that names its type stands whole) and, where
        it is another, the geometry; `benchmark.datasets.parameters_of` puts them together.
        """
        geometry, splits = describe(self.geometry), self.directions.card()
        shared, own = without_repeats(
            {name: self.parameters(name) for name in self.setups}, geometry
        )
        conditions = {
            name: {
                "description": setup.description,
                "tolerances": describe(tolerances(setup.sensor)),
                "reference_error_deg": self.reference_error_deg(name),
                **({} if setup.mission is None else {"sources": setup.mission.sources}),
                **own[name],
            }
            for name, setup in self.setups.items()
        }
        return {
            "name": self.name,
            "version": self.version,
            "detector": self.detector,
            "mask": self.mask,
            "observation": str(self.observation),
            "units": self.units,
            "description": self.description,
            "follows": list(self.follows),
            "represents": hardware_match(self.name).card(),
            "geometry": geometry,
            "splits": {**splits, REPEAT: self.repeats.card(splits["test"]["samples"])},
            "parameters": shared,
            "conditions": conditions,
            "regime": describe(self.regime),
            "seeds": stream_names(*self.streams),
        }


def drawn_split(name: str) -> Split:
    """Return the split of this name that directions are drawn for; ValueError otherwise."""
    for split in DRAWN:
        if name == split:
            return split
    raise ValueError(f"no split {name!r}; there are {', '.join(SPLITS)}")
