"""A calibration as a JSON document that answers the same to the last bit when it is loaded."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
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
from api.calibrate.one_axis.curve import AxisCurve
from api.calibrate.readings import readings_of
from api.calibrate.recalibration import Correction
from api.calibrate.settings import Settings, parse_settings
from api.calibrate.table import Table
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
    offset : ndarray, shape (F,)
        Subtracted from features since a correction; see `api.calibrate.recalibration`.
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

    def predict(self, features: Floats, context: Mapping[str, Floats] | None = None) -> Floats:
        """Return unit vectors (N, 3) of features (N, F); NaN rows outside the hull."""
        columns = context or {}
        features = np.asarray(features, dtype=np.float64) - self.offset
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
        temperatures = stored["fit"].get("temperature_K")
        correction = stored.get("correction", {})
        return SavedCalibration(
            parse_settings(stored["settings"], path.name),
            tuple(
                cast("Compensation", stage_of(stage, discover_compensations()))
                for stage in stored["compensations"]
            ),
            cast("Model", stage_of(stored["model"], _models())),
            float(stored["fit"]["interval_factor"]),
            None if temperatures is None else (float(temperatures[0]), float(temperatures[1])),
            np.asarray(correction.get("offset", 0.0), dtype=np.float64),
            np.asarray(correction.get("rotation", np.eye(3)), dtype=np.float64),
            stored,
        )
    except UnreadableCalibrationError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UnreadableCalibrationError(f"{path.name}: {error}") from error


def _models() -> dict[str, type[Any]]:
    return {**discover_models(), AxisCurve.about.name: AxisCurve}


def with_correction(
    old: SavedCalibration, found: Correction, files: Sequence[Path], command: str = ""
) -> dict[str, Any]:
    """Return the document of an old calibration with a correction, on top of those it has."""
    held = {name: value for name, value in old.document.items() if name != DIGEST}
    held["correction"] = {
        **asdict(found),
        "offset": (np.asarray(found.offset) + old.offset).tolist(),
        "rotation": (np.asarray(found.rotation) @ old.rotation).tolist(),
        "onto": old.document[DIGEST],
        "files": [path.name for path in files],
        "command": command,
    }
    return {**held, DIGEST: digest_of(held)}


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
