"""Data sets with one part of the chain made perfect, and all else as it is.

Suns, windows and every random draw stay those of the data set under the condition changed: two
of these data sets differ by the part alone, sample by sample.
"""

from __future__ import annotations

import dataclasses
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import FeatureKind, Floats
from algorithms.references import ReferenceCorrection
from algorithms.spot_lists import SPOT_COLUMNS
from benchmark.datasets.calibration import Bench
from benchmark.datasets.corrected import correction
from benchmark.datasets.preset import BATCH, Preset
from benchmark.simulator.flight.drift import AssemblyDrift, PhotodiodeDrift
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, PixelArray
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.sensor import UnitSpread
from benchmark.simulator.sensors.lens_camera import LensCamera
from benchmark.simulator.sensors.light_to_frequency import FrequencyCounter
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

#: What elements of a sensor differ by from each other: gains, dark signals, thresholds, normals.
SPREADS = frozenset(
    {
        *("prnu", "dsnu", "gain_mismatch", "threshold_mismatch", "mismatch", "loss_spread"),
        *("gain_per_k_spread", "loss_per_year_spread", "normal_error_deg", "track_error_mm"),
        *("hot", "column_offset_e", "dead_share"),
    }
)
#: The same of a bench: its lamp, not its directions.
_LAMP = ("lamp_level", "lamp_drift_per_hour", "lamp_uneven", "lamp_flicker")
#: What a bench says of itself beside its errors.
_NO_ERRORS = ("pose_s", "lamp_diameter_deg")
#: Bits more that make a converter's steps vanish; doubles have enough for them.
_FINER_BITS = 16
#: A spot this near to where an aperture casts its light is that aperture's.
_SAME_SPOT_PX = 3.0
#: Two halves of 32 random bits, each the median: what is drawn by inverting a distribution.
_MEDIANS = 0x8000_0000_8000_0000


def without_lamp_errors(preset: Preset, condition: str) -> Preset | None:
    """Return it calibrated before an even, steady lamp of the Sun's mean light; None without one.

    The directions that the bench says are off as before.
    """
    bench = preset.condition(condition).bench
    if not isinstance(bench, Bench):
        return None
    return _changed(preset, condition, bench=replace(bench, **dict.fromkeys(_LAMP, 0.0)))


def without_fixed_pattern(preset: Preset, condition: str) -> Preset:
    """Return it of a sensor whose elements are alike (`SPREADS`), its mask cut as drawn.

    Errors of assembly stay: they are what a calibration is for.
    """
    return _changed(preset, condition, sensor=_alike(preset.condition(condition).sensor))


def without_surroundings(preset: Preset, condition: str) -> Preset | None:
    """Return it without light from the Earth, drift with temperature, and ageing.

    None where there is nothing of the kind.
    """
    setup = preset.condition(condition)
    drift = getattr(setup.sensor, "drift", None)
    if setup.earth is None and drift is None:
        return None
    changes: dict[str, Any] = {"earth": None}
    if isinstance(drift, AssemblyDrift | PhotodiodeDrift):
        changes["sensor"] = replace(cast("Any", setup.sensor), drift=type(drift)())
    return _changed(preset, condition, **changes)


def perfect(preset: Preset, condition: str) -> Preset:
    """Return it without any of these errors, calibrated on a bench that has none either.

    Its lamp stays a lamp: even and steady, where sunlight changes with the seasons.
    """
    calm = without_surroundings(preset, condition) or preset
    bench = preset.condition(condition).bench
    sizes = [f.name for f in dataclasses.fields(cast("Any", bench))] if bench is not None else []
    zeros = {name: 0.0 for name in sizes if name not in _NO_ERRORS}
    good = bench if bench is None else replace(cast("Any", bench), **zeros)
    return _changed(without_fixed_pattern(calm, condition), condition, bench=good)


def still_observations(
    preset: Preset, condition: str, split: str, *, before_lamp: bool = False
) -> NDArray[Any]:
    """(N, ...) what the sensor puts out of a split where nothing is random.

    The readings' median under mean stray light; sunlight keeps its seasons. Converters of currents
    and frequencies have finer steps; pixels keep their digital numbers, and events their clock.
    `before_lamp`: where the calibration is taken on a bench, the poses are lit as by a good one:
    evenly, with the Sun's mean light.
    """
    setup = preset.condition(condition)
    on_bench = before_lamp and isinstance(setup.bench, Bench)
    sensor = _finely_read(preset.sensor_for(condition, "calibration" if on_bench else split))
    scene, pattern = preset.scene(condition, split), preset.fixed_pattern(condition)
    scene = replace(scene, stray=np.where(scene.irradiance > 0, setup.irradiance.stray, 0.0))
    if on_bench:
        scene = replace(scene, irradiance=np.ones(len(scene)), albedo=None)
    still = cast("np.random.Generator", Still())
    streams, size = NoiseStreams(still, still, still), preset.batch or BATCH
    parts = range(0, len(scene), size)
    return np.concatenate(
        [sensor.observe(scene.part(at, at + size), pattern, streams) for at in parts]
    )


def known_unit(preset: Preset, condition: str) -> ReferenceCorrection | None:
    """Return the correction by the unit's true dark signals and gains; None without references.

    As `benchmark.datasets.corrected.correction`, from one dark and one flat reading without noise
    and with finer steps of the converter.
    """
    by = correction(preset, condition)
    sensor = _finely_referred(preset.condition(condition).sensor)
    if by is None or not isinstance(sensor, UnitSpread):
        return None
    still = cast("np.random.Generator", Still())
    once = replace(preset.offered, flats=1, darks=1)
    pattern = preset.fixed_pattern(condition)
    read = sensor.reference_readings(pattern, once, NoiseStreams(still, still, still))
    dark, flat = (
        next(values for name, values in read.items() if name.startswith(kind))
        for kind in ("dark_", "flat_")
    )
    steps = 2.0**_FINER_BITS if by.pixels else 1.0
    return replace(by, dark=dark / steps, flat=flat / steps)


def true_features(
    preset: Preset, condition: str, kind: FeatureKind, sun: Floats, found: Floats
) -> Floats | None:
    """Return features (N, F) with spots where geometry puts them: no light, no pixels.

    Behind a mask, where the ray through the middle of an aperture from the Sun's centre falls;
    behind a lens, the image of that centre. Rows where nothing is found stay so; a spot of a list
    that is no aperture's (farther than `_SAME_SPOT_PX` from all) stays where it was found. None for
    other features than spots.
    """
    sensor, geometry = preset.condition(condition).sensor, preset.geometry_for(condition)
    camera, pitch = getattr(sensor, "camera", None), geometry.pixel_pitch_mm
    if kind is FeatureKind.SPOT and isinstance(camera, LensCamera):
        places = camera.image_px(sun)
    elif isinstance(camera, Camera) and pitch is not None:
        places = camera.spot_mm(sun) / pitch + (geometry.centre_px or (0.0, 0.0))
    else:
        return None
    there = np.asarray(np.isfinite(found).all(axis=1))
    if kind is FeatureKind.SPOT:
        return np.where(there[:, None], places, np.nan)
    if kind is not FeatureKind.SPOTS or not isinstance(sensor, MultiSpotSensor):
        return None
    holes = preset.fixed_pattern(condition)["apertures"][:, 1:3]
    lists = found.reshape(len(found), -1, SPOT_COLUMNS).copy()
    for row in np.flatnonzero(there):
        true = holes + places[row]
        off = np.linalg.norm(lists[row, :, None, :2] - true, axis=2)
        nearest = off.argmin(axis=1)
        near = off.min(axis=1) <= _SAME_SPOT_PX
        lists[row, near, :2] = true[nearest[near]]
    return np.asarray(lists.reshape(found.shape))


class Still:
    """In the place of a random generator: gives the median of whatever is drawn."""

    def standard_normal(
        self, size: int | tuple[int, ...], dtype: type[Any] = np.float64
    ) -> NDArray[Any]:
        """Zeros."""
        return np.zeros(size, dtype)

    def poisson(self, lam: Floats) -> Floats:
        """Return the means."""
        return np.asarray(lam)

    def random(self, size: int | tuple[int, ...]) -> Floats:
        """Halves."""
        return np.full(size, 0.5)

    @property
    def bit_generator(self) -> Still:
        """Itself: of raw bits."""
        return self

    def random_raw(self, size: int) -> NDArray[np.uint64]:
        """Words of which each half is a median."""
        return np.full(size, _MEDIANS, dtype=np.uint64)


def _changed(preset: Preset, condition: str, **changes: Any) -> Preset:
    setup = replace(preset.condition(condition), **changes)
    return replace(preset, setups={**preset.setups, condition: setup})


def _alike(value: Any) -> Any:
    """Return a sensor with every spread at zero, wherever in it they stand."""
    if isinstance(value, MaskErrors):
        return MaskErrors()
    return _rebuilt(value, _alike, dict.fromkeys(SPREADS, 0.0))


def _finely_read(value: Any) -> Any:
    if isinstance(value, CurrentReadout):
        return replace(value, bits=value.bits + _FINER_BITS)
    if isinstance(value, FrequencyCounter):
        return replace(value, gate_s=value.gate_s * 2.0**_FINER_BITS)
    return _rebuilt(value, _finely_read, {})


def _finely_referred(value: Any) -> Any:
    """Return a sensor whose readings have finer steps, pixels' too: in digital numbers so small."""
    if isinstance(value, PixelArray):
        steps = 2.0**_FINER_BITS
        return replace(
            value,
            gain_e_per_dn=value.gain_e_per_dn / steps,
            offset_dn=value.offset_dn * steps,
            bits=value.bits + _FINER_BITS,
        )
    if isinstance(value, CurrentReadout | FrequencyCounter):
        return _finely_read(value)
    return _rebuilt(value, _finely_referred, {})


def _rebuilt(value: Any, of_parts: Any, fixed: dict[str, float]) -> Any:
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return value
    parts = {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.init}
    new = {name: fixed[name] if name in fixed else of_parts(v) for name, v in parts.items()}
    changed = {name: part for name, part in new.items() if part is not parts[name]}
    return replace(value, **changed) if changed else value
