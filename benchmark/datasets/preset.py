"""`Preset`: a named, versioned, seeded dataset; its samples, parameters, bound and card."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
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
from benchmark.metrics.bounds import STEP_RAD, Bound, cramer_rao
from benchmark.seeds import generator
from benchmark.simulator import SIMULATOR_VERSION
from benchmark.simulator.flight.spin import Spin
from benchmark.simulator.light.environment import Earth, Irradiance
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern, SeesEarth, Sensor, UnitSpread
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
    """

    description: str
    sensor: Sensor
    irradiance: Irradiance
    earth: Earth | None = None
    geometry: SensorGeometry | None = None
    bench: Reference | None = STANDARD_BENCH
    spin: Spin | None = None

    def __post_init__(self) -> None:
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

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions, ``nominal`` first."""
        return tuple(self.setups)

    @property
    def streams(self) -> tuple[str, int]:
        """Name and version that random streams begin with."""
        return self.name, self.version

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
            setups[name] = dataclasses.replace(setup, sensor=assemble(setup.sensor, *unit))
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
        if split == "calibration" and isinstance(setup.bench, Bench):
            return setup.bench.seen_by(setup.sensor)
        return setup.sensor

    def fixed_pattern(self, condition: str) -> FixedPattern:
        """Return the unit as this condition shows it."""
        unit = (self.unit,) if self.unit else ()
        return self.condition(condition).sensor.fixed_pattern(*self.streams, "unit", *unit)

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
        pattern = self.fixed_pattern(condition)
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
        sensor = self.sensor_for(condition, split)
        scene = self.scene(condition, split, n)
        pattern = self.fixed_pattern(condition)
        streams = NoiseStreams.named(*self._of_unit(*self.streams, condition, split))
        # passes over the same poses share their light where light is remembered
        poses = len(self.repeats.pose_indices(self._tested))
        size = poses if split == REPEAT else self.batch or BATCH
        batch = sensor.observe(scene.part(0, size), pattern, streams)
        # filled batch by batch: joining a list of batches would hold everything twice
        observations = np.empty((len(scene), *batch.shape[1:]), batch.dtype)
        observations[: len(batch)] = batch
        for start in range(size, len(scene), size):
            del batch  # or two would be held while the next is made
            batch = sensor.observe(scene.part(start, start + size), pattern, streams)
            observations[start : start + size] = batch
        bench = self.condition(condition).bench
        if split != "calibration" or bench is None:
            return Samples(observations, scene.sun, scene.origin_px)
        said = bench.report(scene.sun, *self._bench_names)
        return Samples(observations, said, scene.origin_px, true_sun=scene.sun)

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> Bound:
        """Cramer-Rao bounds of every sample of a split (see `benchmark.metrics.bounds.cramer_rao`).

        With the unit known, and with what `references` tell of it. Parameters as `generate`.
        """
        setup = self.condition(condition)
        return cramer_rao(
            self.sensor_for(condition, split),
            self.scene(condition, split, n),
            self.fixed_pattern(condition),
            setup.irradiance,
            self.bound_step_rad,
            self.batch or BATCH,
            self.offered,
        )

    def references(self, condition: str) -> dict[str, NDArray[Any]]:
        """Mean flat and dark readings of this unit, as a calibration offers them.

        Of every element of the detector: ``dark_dn`` and ``flat_dn`` of pixels, ``_ua`` of
        currents, ``_hz`` of frequencies. Empty for sensors whose elements have no readings of
        their own (lenses with trails, events). Light and number: `offered`.

        Raises
        ------
        ValueError
            On an unknown condition, naming the known ones.
        """
        sensor = self.condition(condition).sensor
        if not isinstance(sensor, UnitSpread):
            return {}
        streams = NoiseStreams.named(*self._of_unit(*self.streams, condition, "references"))
        return sensor.reference_readings(self.fixed_pattern(condition), self.offered, streams)

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
