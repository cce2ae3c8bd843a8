"""How often one frame of an uncalibrated unit identifies the part of a coded mask."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from algorithms.calibration.coded.mask import CodedMask
from algorithms.calibration.coded.reading import CodeReading
from algorithms.contract import Floats
from algorithms.pipeline import extract_features
from benchmark import seeds
from benchmark.datasets import get
from benchmark.datasets.fields import Split
from benchmark.plan.parts import installed_parts
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor


@dataclass(frozen=True)
class Acquisition:
    """What became of a number of directions.

    Attributes
    ----------
    right, wrong
        Identified places that are, and that are not, the true one.
    ambiguous, unread
        Without an answer: several places explain the spots, or none does.
    """

    right: int = 0
    wrong: int = 0
    ambiguous: int = 0
    unread: int = 0

    def __add__(self, other: Acquisition) -> Acquisition:
        """Return both counted together."""
        return Acquisition(
            self.right + other.right,
            self.wrong + other.wrong,
            self.ambiguous + other.ambiguous,
            self.unread + other.unread,
        )


@dataclass(frozen=True)
class _Directions:
    """Directions of a data set's test split, as many as are asked for, one by one reproducible."""

    field: Any
    names: tuple[str | int, ...]

    def sun(self, split: Split, generator: np.random.Generator) -> Floats:  # noqa: ARG002 - the protocol's
        """(N, 3) unit vectors, whatever the split."""
        return np.asarray(self.field.sun("test", seeds.generator(*self.names)))

    def card(self) -> dict[str, dict[str, Any]]:
        """As the field's own."""
        return cast("dict[str, dict[str, Any]]", self.field.card())


def acquisition(
    dataset: str,
    model: str = "coded-spacing",
    *,
    directions: int,
    unit: int,
    condition: str = "nominal",
    missing: float = 0.0,
    settings: dict[str, Any] | None = None,
) -> Acquisition:
    """Read the code of random directions by the drawing alone, of a unit that nobody calibrated.

    A place is the true one where the mask's displacement is within half the least distance of two
    apertures from where the Sun casts it: the next sub-field is farther, errors of assembly nearer.

    Parameters
    ----------
    dataset, condition : str
        Full frames behind a coded mask.
    model : str
        Of coded masks.
    directions : int
        Number of them, over the data set's field.
    unit : int
        Of the sensor; each has directions of its own.
    missing : float
        Share of the apertures that are closed beside what the condition says.
    settings : dict, optional
        Parameters of the model that are not the design's.

    Returns
    -------
    Acquisition
        Counts that add up to `directions`.

    Raises
    ------
    TypeError
        If the data set's sensor or the model is not of a coded mask.
    """
    preset = get(dataset)
    names = ("acquisition", dataset, condition, unit)
    field = replace(cast("Any", preset.directions), test_samples=directions)
    setup = preset.condition(condition)
    if not isinstance(setup.sensor, MultiSpotSensor):
        raise TypeError(f"{dataset} must show full frames of many spots; got {setup.sensor!r}")
    if missing:
        errors = replace(setup.sensor.errors, missing=missing)
        setup = replace(setup, sensor=replace(setup.sensor, errors=errors))
    seen = replace(
        preset,
        setups={condition: setup},
        directions=_Directions(field, names),
    ).for_unit(unit)
    parts, geometry = installed_parts(), preset.geometry_for(condition)
    extractor = parts.extractor("spot-list").for_sensor(geometry)
    reader = cast("Any", parts.model(model)).for_sensor(geometry, extractor.about.kind)
    if not isinstance(reader, CodedMask):
        raise TypeError(f"{model} must be a model of coded masks; got {type(reader).__name__}")
    samples = seen.generate(condition, "test")
    reading = replace(reader, **(settings or {})).read(
        extract_features(extractor, samples.observations, samples.origin_px)
    )
    return _count(reading, samples.sun, reader)


def _count(reading: CodeReading, sun: Floats, reader: CodedMask) -> Acquisition:
    slope, centre = reader.drawing()
    cast_px = np.asarray(centre) + sun[:, :2] / sun[:, 2:] / slope
    away = np.hypot(*(reading.displacement - cast_px).T)
    places = np.array(reader.apertures_px)[:, :2]
    apart = min(
        float(np.hypot(*(places - p).T)[n != np.arange(len(places))].min())
        for n, p in enumerate(places)
    )
    read = np.isfinite(away)
    right = int((away[read] < apart / 2.0).sum())
    several = int(reading.ambiguous.sum())
    return Acquisition(right, int(read.sum()) - right, several, int((~read).sum()) - several)
