"""A calibration as a JSON document that answers the same to the last bit when it is loaded."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, cast

import numpy as np

from algorithms.calibration.documents import DIGEST, digest_of, read_document, require_whole
from algorithms.calibration.saving import (
    CONVENTIONS,
    UnreadableCalibrationError,
    stage_document,
    stage_of,
)
from algorithms.contract import Compensation, Floats, Model
from algorithms.discovery import discover_compensations, discover_models
from api.calibrate.calibration import Calibration
from api.calibrate.readings import MATRICES, readings_of
from api.calibrate.recalibration import Correction
from api.calibrate.selection import unbounded
from api.calibrate.settings import Settings, parse_settings
from api.calibrate.table import Table
from api.calibrate.terms.temperature import TERMS
from api.calibrate.verdict import as_text
from files.atomic import replace_file

SCHEMA = "sun-sensor-atlas/sensor-calibration"
SCHEMA_VERSION = 1
_MEMBERS = frozenset(
    {
        *("schema", "schema_version", "conventions", "settings", "compensations", "model", "fit"),
        *("selection", "verdict", "found", "excluded", "made", "correction", DIGEST),
    }
)
#: Number that no reading reaches, and how far rows of a rotation may be from one.
_LARGEST, _ROTATES = 1e15, 1e-6
#: What a document leads to that fits no class here.
_MISFITS = (
    *(ValueError, LookupError, TypeError, AttributeError, ImportError),
    *(ArithmeticError, MemoryError, RecursionError),
)


@dataclass(frozen=True)
class SavedCalibration:
    """A calibration read from its document.

    Attributes
    ----------
    settings : Settings
        By which readings become features.
    compensations : tuple of Compensation
    model : Model
    factor : float
        Of the model's stated 1-sigma, so that intervals hold.
    temperature_K : tuple of two float, or None
        Lowest and highest that was measured, of a model that reads it; beyond, NaN is answered.
    offset, gain : ndarray, shape (F,) or ()
        Since a correction features are ``(f - offset) / gain``; see `api.calibrate.recalibration`.
        Of quadrants and electrodes `settings` have it, whose readings are no features.
    rotation : ndarray, shape (3, 3)
        Of directions since then.
    document : dict
        All that it says.
    """

    settings: Settings
    compensations: tuple[Compensation, ...]
    model: Model
    factor: float
    temperature_K: tuple[float, float] | None  # noqa: N815 - the unit's symbol
    offset: Floats
    rotation: Floats
    document: dict[str, Any]
    gain: Floats = field(default_factory=lambda: np.ones(()))

    @property
    def stated_deg(self) -> float:
        """RMS error of samples left out, by the document."""
        stated = self.document["fit"].get("rms_left_out_deg")
        return float("nan") if stated is None else float(stated)

    @property
    def unbounded(self) -> SavedCalibration:
        """The same, but answering beyond the field that was calibrated."""
        return replace(self, model=unbounded(self.model))

    def predict(self, features: Floats, context: Mapping[str, Floats] | None = None) -> Floats:
        """Return unit vectors (N, 3) of features (N, F); NaN rows outside the hull."""
        columns = context or {}
        features = (np.asarray(features, dtype=np.float64) - self.offset) / self.gain
        for stage in self.compensations:
            features = stage.transform(features, columns)
        sun = self.model.predict(features, columns) @ self.rotation.T
        if self.temperature_K is not None:
            low, high = self.temperature_K
            measured = np.asarray(columns["temperature_K"], dtype=np.float64)
            sun[~((measured >= low) & (measured <= high))] = np.nan
        return np.asarray(sun)

    def predict_table(self, table: Table) -> Floats:
        """Return unit vectors of the usable rows of a file with the calibration's columns."""
        readings = readings_of(table, self.settings)
        return self.predict(readings.features, readings.context)

    @property
    def corrected_settings(self) -> Settings:
        """Settings whose dark level and gain have the correction: what is left of it is a turn.

        For flight software, which takes ``(reading - dark) / gain`` of every reading and turns the
        directions by `rotation`.
        """
        count = len(self.settings.readings.columns)
        offset, gain = np.broadcast_to(self.offset, count), np.broadcast_to(self.gain, count)
        for transform in reversed(self.settings.apply if count == 2 else ()):
            matrix = np.asarray(MATRICES[transform])  # axes changed places or signs, so its
            offset, gain = offset @ matrix, gain @ np.abs(matrix)  # transpose takes them back
        return _with_changes(self.settings, offset, gain)


def document(found: Calibration, command: str = "") -> dict[str, Any]:
    """Return a calibration as what JSON can say."""
    stages = list(getattr(found.model, "compensations", ()))
    last = getattr(found.model, "model", found.model)
    held = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "conventions": CONVENTIONS,
        "settings": found.settings.model_dump(mode="json"),
        "compensations": [stage_document(stage) for stage in stages],
        "model": stage_document(last),
        "fit": {
            "samples": len(found.readings),
            "rms_left_out_deg": number(found.chosen.rms_deg),
            "rms_fitted_deg": number(found.residual_deg),
            "noise_deg": number(found.noise_deg),
            "interval_factor": 1.0 if found.intervals is None else found.intervals.factor,
            "interval_coverage": None if found.intervals is None else found.intervals.coverage,
            "temperature_K": _temperatures(found),
            "fit_spread_deg": number(_rms(found.spread_deg)),
            "sensor": {k: v for k, v in asdict(found.geometry).items() if v is not None},
        },
        "selection": selection_table(found),
        "verdict": dict(as_text(found.verdict)),
        "found": [
            {**{k: number(v) for k, v in asdict(one).items()}, "applied": one in found.applied}
            for one in found.findings
        ],
        "excluded": [asdict(one) for one in found.excluded],
        "made": {
            "files": list(found.sources),
            "data_sha256": found.digest,
            "rows_dropped": dict(found.readings.dropped),
            "notes": list(found.notes),
            "command": command,
            "versions": versions(),
        },
    }
    return {**held, DIGEST: digest_of(held)}


def versions() -> dict[str, str]:
    """Return the versions of what calibrates, by name."""
    names = ("sun-sensor-atlas", "numpy", "scipy")
    return {**{name: _version(name) for name in names}, "python": sys.version.split()[0]}


def selection_table(found: Calibration) -> list[dict[str, Any]]:
    """Return a row for every model tried."""
    return [
        {
            "model": one.name,
            "chosen": one.name == found.chosen.name,
            "rms_deg": number(one.rms_deg),
            "standard_error_deg": number(one.spread_deg),
            "worst_fold_deg": number(one.worst_deg),
            "unanswered": number(one.missing),
            "parameters": one.parameters,
            "fit_s": number(one.seconds),
            "refused": one.refused,
        }
        for one in found.candidates
    ]


def save(found: Calibration, path: Path, command: str = "") -> None:
    """Write a calibration to a file, whole or not at all."""
    replace_file(path, json.dumps(document(found, command), indent=1, allow_nan=False) + "\n")


def load(path: Path) -> SavedCalibration:
    """Return the calibration of a file that `save` wrote.

    Raises
    ------
    UnreadableCalibrationError
        If it is not one, of another version, or was changed.
    OSError
        If it cannot be read.
    """
    try:
        stored = read_document(path)
        if not isinstance(stored, dict) or stored.get("schema") != SCHEMA:
            raise UnreadableCalibrationError(  # noqa: TRY301 - one place for all refusals
                f"{path.name}: expected a document of {SCHEMA}"
            )
        if stored.get("schema_version") != SCHEMA_VERSION:
            raise UnreadableCalibrationError(  # noqa: TRY301 - as above
                f"{path.name}: expected version {SCHEMA_VERSION}; "
                f"got {stored.get('schema_version')!r}"
            )
        require_whole(stored, _MEMBERS)
        found = _loaded(stored, path.name)
        with warnings.catch_warnings():  # of numbers that no row would have
            warnings.simplefilter("ignore", RuntimeWarning)
            columns = {name: np.ones(1) for name in ("temperature_K", "time_s")}
            found.predict(np.ones((1, _features(found.settings))), columns)
    except UnreadableCalibrationError as error:
        if str(error).startswith(f"{path.name}: "):
            raise
        raise UnreadableCalibrationError(f"{path.name}: {error}") from error
    except _MISFITS as error:
        said = str(error) or type(error).__name__
        raise UnreadableCalibrationError(f"{path.name}: {said}") from error
    return found


def _loaded(stored: dict[str, Any], source: str) -> SavedCalibration:
    settings = parse_settings(stored["settings"], source)
    count = _features(settings)
    temperatures = stored["fit"].get("temperature_K")
    correction = stored.get("correction", {})
    if not isinstance(correction, dict):
        raise UnreadableCalibrationError(f"correction must be a table; got {str(correction)[:60]}")
    if not isinstance(stored["compensations"], list):
        raise UnreadableCalibrationError("compensations must be a list")
    if (stated := stored["fit"].get("rms_left_out_deg")) is not None:
        _numbers(stated, (), "fit.rms_left_out_deg")
    return SavedCalibration(
        settings,
        tuple(
            cast("Compensation", stage_of(stage, {**discover_compensations(), **TERMS}))
            for stage in stored["compensations"]
        ),
        cast("Model", stage_of(stored["model"], discover_models())),
        _numbers(stored["fit"]["interval_factor"], (), "fit.interval_factor", above=0.0).item(),
        None if temperatures is None else _range(temperatures),
        _feature_numbers(correction.get("offset", 0.0), count, "correction.offset"),
        _rotation(correction.get("rotation", np.eye(3).tolist())),
        stored,
        _feature_numbers(correction.get("gain", 1.0), count, "correction.gain", above=0.0),
    )


def _features(settings: Settings) -> int:
    """Count the features of a sample."""
    return len(settings.readings.columns) if settings.readings.kind == "channels" else 2


def _numbers(value: Any, shape: tuple[int, ...], name: str, above: float = -np.inf) -> Floats:
    """Return numbers of a document as an array.

    Raises
    ------
    UnreadableCalibrationError
        If they are not of that shape, or one is no number, not above a limit, or so large that no
        reading is: 1e15 and more.
    """
    flat = _flat(value)
    if not all(
        isinstance(one, int | float) and not isinstance(one, bool) and above < one < _LARGEST
        and one > -_LARGEST
        for one in flat
    ) or np.shape(value) != shape:  # fmt: skip
        wanted = " by ".join(str(size) for size in shape) or "one"
        limit = "" if np.isinf(above) else f" above {above:g}"
        raise UnreadableCalibrationError(
            f"{name} must be {wanted} finite numbers{limit}; got {str(value)[:60]}"
        )
    return np.asarray(value, dtype=np.float64)


def _flat(value: Any) -> list[Any]:
    if not isinstance(value, list):
        return [value]
    return [one for inner in value for one in _flat(inner)]


def _feature_numbers(value: Any, count: int, name: str, above: float = -np.inf) -> Floats:
    """Return one number for all features or one each."""
    return _numbers(value, (count,) if isinstance(value, list) else (), name, above)


def _range(value: Any) -> tuple[float, float]:
    low, high = _numbers(value, (2,), "fit.temperature_K").tolist()
    if not low <= high:
        raise UnreadableCalibrationError(f"fit.temperature_K must rise; got {low:g}, {high:g}")
    return low, high


def _rotation(value: Any) -> Floats:
    found = _numbers(value, (3, 3), "correction.rotation")
    off = float(np.abs(found @ found.T - np.eye(3)).max())
    if not (off < _ROTATES and np.linalg.det(found) > 0):
        raise UnreadableCalibrationError(
            f"correction.rotation must be a rotation; rows are off from it by {off:.3g}"
        )
    return found


def with_correction(
    old: SavedCalibration, found: Correction, files: Sequence[Path], command: str = ""
) -> dict[str, Any]:
    """Return the document of an old calibration with a correction, on top of those it has.

    Of spots, balances and channels the correction has gain and offset of features; of quadrants and
    electrodes the settings have them as gain and dark level of readings.
    """
    held = {name: value for name, value in old.document.items() if name != DIGEST}
    settings, gain, offset = old.settings, np.asarray(found.gain), np.asarray(found.offset)
    if len(gain) != _features(settings):
        held["settings"] = _with_changes(settings, offset, gain).model_dump(mode="json")
        gain, offset = np.ones(()), np.zeros(())
    for transform in settings.apply if len(settings.readings.columns) == 2 else ():
        matrix = np.asarray(MATRICES[transform])
        offset, gain = matrix @ offset, np.abs(matrix) @ gain
    held["correction"] = {
        **{name: _plain(value) for name, value in asdict(found).items()},
        "offset": (offset + gain * old.offset).tolist(),
        "gain": (gain * old.gain).tolist(),
        "rotation": (np.asarray(found.rotation) @ old.rotation).tolist(),
        "onto": old.document[DIGEST],
        "files": [path.name for path in files],
        "command": command,
    }
    return {**held, DIGEST: digest_of(held)}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(one) for name, one in value.items()}
    return number(value)


def _with_changes(settings: Settings, offset: Floats, gain: Floats) -> Settings:
    """Return settings whose signals are less an offset (K,), over a gain (K,)."""
    stated = settings.readings
    sign = -1.0 if stated.inverted else 1.0
    dark = np.asarray(stated.dark) + sign * np.asarray(stated.gain) * offset
    made = stated.model_copy(
        update={
            "dark": tuple(float(v) for v in dark),
            "gain": tuple(float(v) for v in np.asarray(stated.gain) * gain),
        }
    )
    return settings.model_copy(update={"readings": made})


def _temperatures(found: Calibration) -> list[float] | None:
    """Return the lowest and the highest that a model which reads it was fitted at."""
    if "temperature_K" not in tuple(found.model.about.context):
        return None
    column = found.readings.context["temperature_K"]
    return [float(column.min()), float(column.max())]


def number(value: Any) -> Any:
    """Return a value as JSON has it: None for what is no number."""
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value


def _rms(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "unknown"
