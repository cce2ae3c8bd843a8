"""A calibration as a JSON document that answers the same to the last bit when it is loaded."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib.metadata import version
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
from calibrate.calibration import Calibration
from calibrate.flight.program import Program, stored_program
from calibrate.one_axis import AxisCurve
from calibrate.places import Grazing, tangent_axes
from calibrate.recalibration import Correction
from calibrate.selection import deviation_of, unbounded
from calibrate.settings import Settings, parse_settings
from calibrate.terms.corrections import (
    Corrected,
    features_in,
    numbers,
    of_features,
    temperatures,
    with_changes,
)
from calibrate.terms.temperature import TERMS
from calibrate.uncertainty import Intervals, covariance_of, rms
from calibrate.verdict import as_text
from files.atomic import replace_file

SCHEMA = "sun-sensor-atlas/sensor-calibration"
#: Of documents written; those of version 1 have a factor and no table of intervals.
SCHEMA_VERSION = 2
_READ = (1, 2)
_MEMBERS = frozenset(
    {
        *("schema", "schema_version", "conventions", "settings", "compensations", "model", "fit"),
        *("selection", "verdict", "found", "excluded", "made", "flight", "correction", DIGEST),
    }
)
#: Letters of a document that is indented.
_LONGEST_INDENTED = 1_000_000
#: What a damaged document leads to that fits no class here.
_MISFITS = (
    *(ValueError, LookupError, TypeError, AttributeError, ImportError),
    *(ArithmeticError, MemoryError, RecursionError),
)


@dataclass(frozen=True)
class SavedCalibration:
    """A calibration read from its document.

    Since a correction features (N, F) are ``(f - offset) / gain``, see `calibrate.recalibration`;
    of quadrants and electrodes the settings have it, whose readings are no features.
    """

    settings: Settings  # by which readings become features
    compensations: tuple[Compensation, ...]
    model: Model
    factor: float  # of the model's stated 1-sigma, where there are no intervals
    intervals: Intervals | None  # None of few samples and of version 1
    temperature_K: tuple[float, float] | None  # noqa: N815 - the unit's symbol
    offset: Floats  # (F,) or ()
    rotation: Floats  # (3, 3), of directions since a correction
    document: dict[str, Any]  # all that it says
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

    @property
    def corrected(self) -> Corrected:
        """What was corrected since; its ``settings`` are those for flight software."""
        return Corrected(self.offset, self.gain, self.rotation)

    def predict(self, features: Floats, context: Mapping[str, Floats] | None = None) -> Floats:
        """Return unit vectors (N, 3) of features (N, F); NaN rows outside the hull."""
        columns = context or {}
        sun = self.model.predict(self._compensated(features, columns), columns) @ self.rotation.T
        if self.temperature_K is not None:
            low, high = self.temperature_K
            measured = np.asarray(columns["temperature_K"], dtype=np.float64)
            sun[~((measured >= low) & (measured <= high))] = np.nan
        return np.asarray(sun)

    def covariance(self, features: Floats, context: Mapping[str, Floats] | None = None) -> Floats:
        """Return the covariance (N, 3, 3) of the unit vectors at features (N, F), radians squared.

        A correction turns it with the directions; NaN where nothing is answered.
        """
        before = self.predict(features, context) @ self.rotation
        if self.intervals is None:
            columns = context or {}
            stated = deviation_of(self.model, self._compensated(features, columns), columns)
            sigma = np.repeat(self.factor * stated[:, None], 2, axis=1)
        else:
            sigma = self.intervals.at(before)
        return np.asarray(self.rotation @ covariance_of(sigma, before) @ self.rotation.T)

    def deviations_deg(
        self, features: Floats, context: Mapping[str, Floats] | None = None
    ) -> Floats:
        """Return the 1-sigma (N, 2) of both axes of `calibrate.places.tangent_axes`.

        In degrees, at features (N, F).
        """
        axes = np.stack(tangent_axes(self.predict(features, context)), axis=1)
        variance = np.einsum("nai,nij,naj->na", axes, self.covariance(features, context), axes)
        return np.asarray(np.degrees(np.sqrt(variance)))

    def deviation_deg(
        self, features: Floats, context: Mapping[str, Floats] | None = None
    ) -> Floats:
        """Return the 1-sigma (N,) of a tangent axis, degrees: RMS of both of `deviations_deg`."""
        return np.asarray(np.sqrt(np.mean(self.deviations_deg(features, context) ** 2, axis=1)))

    def _compensated(self, features: Floats, columns: Mapping[str, Floats]) -> Floats:
        features = (np.asarray(features, dtype=np.float64) - self.offset) / self.gain
        for stage in self.compensations:
            features = stage.transform(features, columns)
        return features


def document(
    found: Calibration, command: str = "", program: Program | None = None
) -> dict[str, Any]:
    """Return a calibration as what JSON can say, with the program of its code if there is one."""
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
            "intervals": None if found.intervals is None else stored_intervals(found.intervals),
            "temperature_K": _temperatures(found),
            "fit_spread_deg": number(rms(found.spread_deg)),
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
    if program is not None:
        held["flight"] = stored_program(program)
    return {**held, DIGEST: digest_of(held)}


def versions() -> dict[str, str]:
    """Return the versions of what calibrates, by name."""
    names = ("sun-sensor-atlas", "numpy", "scipy")
    return {**{name: version(name) for name in names}, "python": sys.version.split()[0]}


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
    replace_file(path, text_of(document(found, command)))


def text_of(held: Mapping[str, Any]) -> str:
    """Return the JSON text of a document: indented, but for one that is long.

    The standard library takes ten times as long to indent: 4 s for 6 MB.
    """
    text = json.dumps(held, allow_nan=False)
    if len(text) <= _LONGEST_INDENTED:
        text = json.dumps(held, indent=1, allow_nan=False)
    return text + "\n"


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
            raise UnreadableCalibrationError(f"{path.name}: expected a document of {SCHEMA}")
        if stored.get("schema_version") not in _READ:
            raise UnreadableCalibrationError(
                f"{path.name}: expected version {' or '.join(map(str, _READ))}; "
                f"got {stored.get('schema_version')!r}"
            )
        require_whole(stored, _MEMBERS)
        found = of_document(stored, path.name)
        with warnings.catch_warnings():  # of numbers that no row would have
            warnings.simplefilter("ignore", RuntimeWarning)
            columns = {name: np.ones(1) for name in ("temperature_K", "time_s")}
            found.predict(np.ones((1, features_in(found.settings))), columns)
    except _MISFITS as error:
        said = str(error) or type(error).__name__
        named = said if said.startswith(f"{path.name}: ") else f"{path.name}: {said}"
        raise UnreadableCalibrationError(named) from error
    return found


def of_document(stored: dict[str, Any], source: str) -> SavedCalibration:
    """Return the calibration that a document of this version holds."""
    settings, fit = parse_settings(stored["settings"], source), stored["fit"]
    measured = fit.get("temperature_K")
    correction = Corrected.of(stored.get("correction", {}), settings)
    if not isinstance(stored["compensations"], list):
        raise UnreadableCalibrationError("compensations must be a list")
    if "rms_left_out_deg" not in fit:
        raise UnreadableCalibrationError("fit lacks rms_left_out_deg")
    for name in ("rms_left_out_deg", "rms_fitted_deg", "noise_deg", "fit_spread_deg"):
        stated = fit.get(name)
        if stated is not None and numbers(stated, (), f"fit.{name}") < 0:
            raise UnreadableCalibrationError(f"fit.{name} must be 0 or more; got {stated:g}")
    model = cast("Model", stage_of(stored["model"], _models()))
    _require_vector(model)
    return SavedCalibration(
        settings,
        tuple(
            cast("Compensation", stage_of(stage, {**discover_compensations(), **TERMS}))
            for stage in stored["compensations"]
        ),
        model,
        numbers(fit.get("interval_factor", 1.0), (), "fit.interval_factor", above=0.0).item(),
        intervals_of(fit.get("intervals")),
        None if measured is None else temperatures(measured),
        correction.offset,
        correction.rotation,
        stored,
        correction.gain,
    )


def _models() -> dict[str, type[Any]]:
    return {**discover_models(), AxisCurve.about.name: AxisCurve}


def _require_vector(model: Any) -> None:
    """Raise where a drawing has other than a number for each parameter: its loops are compiled."""
    if not hasattr(model, "free_parameters"):
        return
    wanted, vector = (len(model.free_parameters()),), model.vector_
    if not isinstance(vector, np.ndarray) or vector.shape != wanted or vector.dtype != np.float64:
        raise UnreadableCalibrationError(
            f"{model.about.name} has {wanted[0]} parameters; its vector_ has {str(vector)[:60]}"
        )


def with_correction(
    old: SavedCalibration, found: Correction, files: Sequence[Path], command: str = ""
) -> dict[str, Any]:
    """Return the document of an old calibration with a correction, on top of those it has.

    Of spots, balances and channels the correction has gain and offset of features; of quadrants and
    electrodes the settings have them as gain and dark level of readings.
    """
    held = {name: value for name, value in old.document.items() if name != DIGEST}
    settings, gain, offset = old.settings, np.asarray(found.gain), np.asarray(found.offset)
    if len(gain) != features_in(settings):
        held["settings"] = with_changes(settings, offset, gain).model_dump(mode="json")
        offset, gain = np.zeros(()), np.ones(())
    offset, gain = of_features(settings, offset, gain) if gain.ndim else (offset, gain)
    whole = old.corrected.then(offset, gain, np.asarray(found.rotation))
    held["correction"] = {
        **found.as_data(),
        **{name: value.tolist() for name, value in vars(whole).items()},
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


def stored_intervals(found: Intervals | Grazing) -> dict[str, Any]:
    """Return intervals as what JSON can say."""
    return {
        name: (
            value.tolist()
            if isinstance(value, np.ndarray)
            else (stored_intervals(value) if isinstance(value, Grazing) else value)
        )
        for name, value in vars(found).items()
    }


def intervals_of(stored: Mapping[str, Any] | None) -> Intervals | None:
    """Return the intervals that a document holds; ValueError where they are none."""
    if stored is None:
        return None
    axis, rings_deg, sigma_deg = (
        numbers(stored[name], np.shape(stored[name]), f"fit.intervals.{name}")
        for name in ("axis", "rings_deg", "sigma_deg")
    )
    factor, coverage, samples, sectors = (
        numbers(stored[name], (), f"fit.intervals.{name}", above=0.0).item()
        for name in ("factor", "coverage", "samples", "sectors")
    )
    found = Intervals(
        factor, coverage, int(samples), axis, rings_deg, int(sectors), sigma_deg,
        _grazing_of(stored.get("grazing")),
    )  # fmt: skip
    if coverage > 1 or not (sigma_deg >= 0).all():
        raise ValueError("expected intervals of a coverage of at most 1 and of no negative sigma")
    shape = (len(found.rings_deg), found.sectors, 2)
    if found.axis.shape != (3,) or found.sigma_deg.shape != shape:
        raise ValueError(
            f"expected intervals of shape {shape} about an axis of 3; got {found.sigma_deg.shape} "
            f"about {found.axis.shape}"
        )
    return found


def _grazing_of(stored: Mapping[str, Any] | None) -> Grazing:
    """Return the growth of errors at grazing light that a document holds; none in older ones."""
    if stored is None or not stored["normals"]:
        return Grazing.none()
    normals, sine, grown = (
        numbers(stored[name], np.shape(stored[name]), f"fit.intervals.grazing.{name}")
        for name in ("normals", "sine", "grown")
    )
    found = Grazing(normals, float(sine), float(grown))
    if normals.ndim != 2 or normals.shape[1] != 3 or not (found.sine > 0 and found.grown >= 0):
        raise ValueError(
            "expected grazing with normals of three numbers, a positive sine and grown of 0 or more"
        )
    return found
