"""Networks on orbits and units they were not trained on, beside an albedo model and nothing.

``python -m benchmark.experiments networks`` prints all of it, in some minutes. Everything that is
compared is calibrated on the same samples with their true directions, and on readings corrected by
the unit's references: errors are own errors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg, tangents_from_sun
from algorithms.compensations.environment.temperature import TemperatureDrift
from algorithms.contract import Compensation, Context, FeatureKind, Floats, Model, SensorGeometry
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.models.neural_network.axis_networks import AxisNetworks
from algorithms.models.neural_network.deep_signals import DeepSignals
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark import datasets
from benchmark.datasets.conditions.flight import FlightPreset, Span
from benchmark.datasets.corrected import correction
from benchmark.datasets.features import features_of
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.readout.detectors import RESPONSES

ALBEDO_ORBIT = "pd-albedo-orbit"
MANY_SPOTS = "cmos-multi-aperture"

SEEDS, UNITS = tuple(range(10)), tuple(range(1, 5))
#: Days of training, in orbits of 97 minutes: one, three, a day, four days.
TRAINED_DAYS = (0.0671, 0.2014, 1.0, 4.0)
#: When the test is flown, days after the start of the training.
TESTED_DAYS = (7.0, 90.0)

#: Half the field in which spots of the outermost holes are looked for.
X_FOV_DEG = 53.0

_ROUNDS = 3


@dataclass(frozen=True)
class NetworkError:
    """Error of one method on a test split.

    Of the angle to the Sun over lit samples that were answered, a share of all. The question is
    such as ``"orbits"``, the case a condition, unit, seed or span; the method is that of the
    calibration.
    """

    question: str
    case: str
    method: str
    rms_deg: float
    p95_deg: float
    max_deg: float
    answered: float


@dataclass(frozen=True)
class Part:
    """Features of a split, with the true Suns and what else is known."""

    features: Floats
    sun: Floats
    context: Context
    lit: NDArray[np.bool_]

    @classmethod
    def of(cls, preset: Preset, condition: str, split: str) -> Part:
        """Return a split of a data set with its signals."""
        samples, reader = (
            preset.generate(condition, split),
            DirectSignals.for_sensor(preset.geometry),
        )
        features = features_of(reader, samples, correction(preset, condition))
        context = samples.context or {}
        dark = np.asarray(context.get("eclipse", np.zeros(len(samples.sun))), dtype=np.bool_)
        return cls(features, samples.truth, context, ~dark)


Method = Callable[[SensorGeometry, Part, Part], Floats]


def network_directions(seed: int = 0) -> Method:
    """Return the deep network of all signals, started from a seed."""

    def directions(geometry: SensorGeometry, known: Part, asked: Part) -> Floats:
        model = replace(DeepSignals.for_sensor(geometry, FeatureKind.SIGNALS), seed=seed)
        return _answered(model, (), known, asked)

    return directions


def behind_temperature(geometry: SensorGeometry, known: Part, asked: Part) -> Floats:
    """Directions (N, 3) of the network behind the compensation of temperature."""
    stage = TemperatureDrift.for_sensor(geometry, FeatureKind.SIGNALS)
    model = DeepSignals.for_sensor(geometry, FeatureKind.SIGNALS)
    return _answered(model, (stage,), known, asked)


def uncorrected_directions(geometry: SensorGeometry, known: Part, asked: Part) -> Floats:
    """Directions (N, 3) of assembled faces, which know of no Earth."""
    return _answered(AssembledFaces.for_sensor(geometry, FeatureKind.SIGNALS), (), known, asked)


def by_albedo_model(geometry: SensorGeometry, known: Part, asked: Part) -> Floats:
    """Directions (N, 3) of assembled faces, the Earth's light taken off as a model has it.

    The model is the simulator's own Earth, with its true reflectance, seen at the nadir that a
    horizon sensor reads: no model of the real one is as good. What a face makes of full sunlight is
    learnt from the calibration.
    """
    normals = np.asarray(geometry.face_normals)
    earth = Earth()

    def earthlight(sun: Floats, part: Part) -> Floats:
        nadir = np.asarray(part.context["nadir"], dtype=np.float64)
        found = np.zeros((len(sun), len(normals)))
        seen = part.lit & np.isfinite(sun).all(axis=1)
        found[seen] = earth.response(sun[seen], nadir[seen], normals, "kelly")
        return found

    def freed(part: Part, sun: Floats, full: Floats) -> Part:
        return replace(part, features=part.features - full * earthlight(sun, part))

    lit_by_earth = earthlight(known.sun, known)
    shape = RESPONSES["kelly"](known.sun @ normals.T) + lit_by_earth
    full = np.nansum(known.features * shape, axis=0) / np.sum(shape**2, axis=0)
    clean = freed(known, known.sun, full)
    model = AssembledFaces.for_sensor(geometry, FeatureKind.SIGNALS).fit(clean.features, clean.sun)
    sun = model.predict(asked.features)
    for _ in range(_ROUNDS):
        sun = model.predict(freed(asked, sun, full).features)
    return sun


METHODS: dict[str, Method] = {
    "no correction": uncorrected_directions,
    "albedo model": by_albedo_model,
    "dnn": network_directions(),
    "temperature + dnn": behind_temperature,
}


def orbits(
    name: str = ALBEDO_ORBIT, conditions: Iterable[str] = ("nominal", "stable", "no-albedo")
) -> Iterator[NetworkError]:
    """Put every method on orbits that it was not calibrated on, condition by condition."""
    preset = datasets.get(name)
    for condition in conditions:
        known, asked = parts(preset, condition)
        for method, directions in METHODS.items():
            found = directions(preset.geometry, known, asked)
            yield _measure("orbits", condition, method, found, asked)


def units(name: str = ALBEDO_ORBIT, others: Iterable[int] = UNITS) -> Iterator[NetworkError]:
    """Give a network of the standard unit on units it never saw, and their own networks there."""
    preset = datasets.get(name)
    known, _ = parts(preset, "nominal")
    model = DeepSignals.for_sensor(preset.geometry, FeatureKind.SIGNALS)
    model.fit(known.features, known.sun)
    for unit in others:
        other = preset.for_unit(unit)
        own, asked = parts(other, "nominal")
        case = f"unit {unit}"
        found = model.predict(asked.features)
        yield _measure("units", case, "dnn of unit 0", found, asked)
        for method in ("dnn", "no correction"):
            found = METHODS[method](preset.geometry, own, asked)
            yield _measure("units", case, f"{method} of its own", found, asked)


def seeds(name: str = ALBEDO_ORBIT, chosen: Iterable[int] = SEEDS) -> Iterator[NetworkError]:
    """Calibrate on the same samples from the weights of several seeds."""
    preset = datasets.get(name)
    known, asked = parts(preset, "nominal")
    for seed in chosen:
        found = network_directions(seed)(preset.geometry, known, asked)
        yield _measure("seeds", f"seed {seed}", "dnn", found, asked)


def spans(
    name: str = ALBEDO_ORBIT,
    trained_days: Iterable[float] = TRAINED_DAYS,
    tested_days: Iterable[float] = TESTED_DAYS,
) -> Iterator[NetworkError]:
    """Train longer and shorter, and test a week and a quarter of a year later."""
    preset = cast("FlightPreset", datasets.get(name))
    for tested in tested_days:
        for days in trained_days:
            flight = preset.flight
            step_s = flight.calibration.step_s
            flown = replace(
                flight,
                calibration=Span(0.0, round(days * 86_400.0 / step_s), step_s),
                test=replace(flight.test, start_day=tested),
            )
            known, asked = parts(replace(preset, directions=flown), "nominal")
            for method in ("no correction", "dnn"):
                found = METHODS[method](preset.geometry, known, asked)
                yield _measure(
                    "spans", f"{days:.2g} d, tested day {tested:g}", method, found, asked
                )


def fields(name: str = MANY_SPOTS, reach_deg: float = X_FOV_DEG) -> Iterator[NetworkError]:
    """Train on a mask of many spots where all are seen (S-FOV), and wherever some are (X-FOV).

    Poses reach as far as the extractor answers, which is less than the data set's field.
    """
    preset = datasets.get(name)
    edge = np.tan(np.radians(float(preset.regime["all_spots_half_fov_deg"])))
    wider = AngleField(reach_deg, steps=15, test_samples=200)
    preset = replace(preset, directions=wider)
    extractor = MultipleCentroids.for_sensor(preset.geometry)
    by, split_parts = correction(preset, "nominal"), []
    for split in ("calibration", "test"):
        samples = preset.generate("nominal", split)
        found = features_of(extractor, samples, by)
        inside = np.abs(tangents_from_sun(samples.truth)).max(axis=1) <= edge
        split_parts.append((found, samples.truth, inside))
    (found, sun, inside), (asked, truth, tested) = split_parts
    for mode, rows in (("S-FOV", inside), ("X-FOV", np.ones_like(inside))):
        model = AxisNetworks().fit(found[rows], sun[rows])
        answers = model.predict(asked)
        for where, chosen in (("all spots", tested), ("some spots", ~tested)):
            part = Part(asked[chosen], truth[chosen], {}, np.ones(int(chosen.sum()), dtype=bool))
            yield _measure("fields", where, f"ann, {mode}", answers[chosen], part)


def parts(preset: Preset, condition: str) -> tuple[Part, Part]:
    """Return what is calibrated on and what is tested on."""
    return Part.of(preset, condition, "calibration"), Part.of(preset, condition, "test")


def _answered(model: Model, stages: tuple[Compensation, ...], known: Part, asked: Part) -> Floats:
    features, wanted = known.features, asked.features
    for stage in stages:
        stage.fit(features, known.sun, known.context)
        features = stage.transform(features, known.context)
        wanted = stage.transform(wanted, asked.context)
    return model.fit(features, known.sun, known.context).predict(wanted, asked.context)


def _measure(question: str, case: str, method: str, found: Floats, asked: Part) -> NetworkError:
    off = separation_deg(found, asked.sun)[asked.lit]
    off_answered = off[np.isfinite(off)]
    none = len(off_answered) == 0
    return NetworkError(
        question,
        case,
        method,
        float("nan") if none else float(np.sqrt(np.mean(off_answered**2))),
        float("nan") if none else float(np.percentile(off_answered, 95.0)),
        float("nan") if none else float(off_answered.max()),
        float(len(off_answered) / max(len(off), 1)),
    )


def line(row: NetworkError) -> str:
    """Spell a number as it is printed."""
    return (
        f"{row.question:7s} {row.case:24s} {row.method:24s} rms {row.rms_deg:.4f} "
        f"p95 {row.p95_deg:.4f} max {row.max_deg:.3f} answered {row.answered:.3f}"
    )
