"""Calibrated chains as JSON documents, and back: plain numbers, no pickle, answers bit-equal.

A document has a digest of all that it holds, and one whose digest does not fit is refused: a number
with another digit would give directions that look as good as the right ones.
"""

from __future__ import annotations

import dataclasses
import importlib
import json
import math
import os
import re
from collections.abc import Mapping
from pathlib import Path
from threading import get_ident
from typing import Any, cast

import numpy as np

from algorithms.calibration.documents import (
    DIGEST,
    DocumentError,
    digest_of,
    read_document,
    require_whole,
)
from algorithms.contract import Compensation, Extractor, Model, SensorGeometry
from algorithms.discovery import (
    discover_compensations,
    discover_extractors,
    discover_models,
)
from algorithms.pipeline import Pipeline

SCHEMA = "sun-sensor-atlas/calibration"
#: 2 brought the digest. Of version 1, without one, nobody can tell a damaged file from a sound one.
SCHEMA_VERSION = 2
_MEMBERS = frozenset(
    {
        *("schema", "schema_version", "conventions", "sensor"),
        *("extractor", "compensations", "model", DIGEST),
    }
)
#: Entries of arrays by kind of NumPy's types: truth values, numbers, text.
_ENTRIES: Mapping[str, set[type]] = {
    "b": {bool},
    "i": {int},
    "u": {int},
    "f": {int, float},
    "U": {str},
}

CONVENTIONS = {
    "sun": "unit vector from the sensor to the Sun, sensor frame, +z the boresight",
    "angles": "tan(alpha) = s_y/s_z, tan(beta) = s_x/s_z, degrees",
    "pixels": "centres at integers, order (x, y), x along columns",
    "units": "in the names: _deg, _mm, _px, _s, _K, _nT",
}

#: Beyond any finite number of a calibration.
_LARGEST = 1e20

#: What a document leads to that fits no class here.
_MISFITS = (
    *(DocumentError, LookupError, TypeError, ValueError, AttributeError, ImportError),
    *(ArithmeticError, MemoryError, RecursionError),
)

Stage = Extractor | Compensation | Model


class UnreadableCalibrationError(ValueError):
    """A document that is not a calibration of this schema, or of this software."""


def document(pipeline: Pipeline, geometry: SensorGeometry | None = None) -> dict[str, Any]:
    """Return a fitted pipeline as what JSON can say.

    Parameters
    ----------
    pipeline : Pipeline
        Fitted.
    geometry : SensorGeometry, optional
        Design of the sensor, for whoever reads the document.

    Returns
    -------
    dict
        With schema, conventions, each stage's name, version, parameters and fitted attributes, and
        the digest of all these.

    Raises
    ------
    NotFittedError
        If a stage is not fitted.

    Examples
    --------
    >>> from algorithms.extractors.frames.centroid import BasicCentroid
    >>> from algorithms.models.geometric.standard_projection import StandardProjection
    >>> model = StandardProjection(focal_length_mm=2.0, unit_mm=0.01)
    >>> pipeline = Pipeline(BasicCentroid(), model.fit([[0.0, 0.0]], [[0.0, 0.0, 1.0]]))
    >>> stored = document(pipeline)
    >>> stored["model"]["name"], stored["model"]["parameters"]["focal_length_mm"]
    ('spm', 2.0)
    >>> pipeline_of(stored).model.predict([[100.0, 0.0]]).round(3)
    array([[0.447, 0.   , 0.894]])
    """
    pipeline.require_fitted()
    design = None if geometry is None else _without_none(dataclasses.asdict(geometry))
    held = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "conventions": CONVENTIONS,
        "sensor": design,
        "extractor": stage_document(pipeline.extractor),
        "compensations": [stage_document(stage) for stage in pipeline.compensations],
        "model": stage_document(pipeline.model),
    }
    return {**held, DIGEST: digest_of(held)}


def pipeline_of(stored: Mapping[str, Any]) -> Pipeline:
    """Return the fitted pipeline of a document; the inverse of `document`.

    Parameters
    ----------
    stored : mapping
        What `document` gave, or what JSON made of it.

    Returns
    -------
    Pipeline
        Fitted; its answers are the same to the last bit.

    Raises
    ------
    UnreadableCalibrationError
        If it is not a calibration, of another schema version, not what its digest is of, or of a
        stage or a stage's version that this software does not have.

    Examples
    --------
    >>> pipeline_of({"schema": "recipe"})
    Traceback (most recent call last):
    algorithms.calibration.saving.UnreadableCalibrationError: expected a document of \
sun-sensor-atlas/calibration; got 'recipe'
    """
    if not isinstance(stored, Mapping) or stored.get("schema") != SCHEMA:
        said = stored.get("schema") if isinstance(stored, Mapping) else type(stored).__name__
        raise UnreadableCalibrationError(f"expected a document of {SCHEMA}; got {said!r}")
    if stored.get("schema_version") != SCHEMA_VERSION:
        raise UnreadableCalibrationError(
            f"expected schema version {SCHEMA_VERSION}; got {stored.get('schema_version')!r}: "
            "calibrate and save anew"
        )
    try:
        require_whole(stored, _MEMBERS)
        return Pipeline(
            cast("Extractor", stage_of(stored["extractor"], discover_extractors())),
            cast("Model", stage_of(stored["model"], discover_models())),
            tuple(
                cast("Compensation", stage_of(stage, discover_compensations()))
                for stage in stored["compensations"]
            ),
        )
    except UnreadableCalibrationError:
        raise
    except _MISFITS as error:
        raise UnreadableCalibrationError(f"the calibration is damaged: {error}") from error


def save(pipeline: Pipeline, path: str | Path, geometry: SensorGeometry | None = None) -> None:
    """Write a fitted pipeline to a file, whole or not at all.

    Parameters
    ----------
    pipeline : Pipeline
        Fitted.
    path : str or Path
        Of the file; one that is there is replaced.
    geometry : SensorGeometry, optional
        Design of the sensor, for whoever reads the document.

    Raises
    ------
    NotFittedError
        If a stage is not fitted.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> save(pipeline, "calibration.json", geometry)  # doctest: +SKIP
    """
    text = json.dumps(document(pipeline, geometry), indent=1, allow_nan=False) + "\n"
    target = Path(path)
    _remove_stale_files(target)
    scratch = target.with_name(f".{target.name}.{os.getpid()}-{get_ident():x}.saving")
    try:
        scratch.write_text(text, encoding="utf-8")
        scratch.replace(target)
    except OSError as error:
        if error.errno is None or error.filename is not None:
            raise
        raise OSError(error.errno, error.strerror, str(target)) from error  # as of a full disk
    finally:
        scratch.unlink(missing_ok=True)


def _remove_stale_files(target: Path) -> None:
    """Remove what killed processes left half written of a file."""
    named = re.compile(rf"\.{re.escape(target.name)}\.(\d+)-[0-9a-f]+\.saving")
    for path in target.parent.iterdir() if target.parent.is_dir() else ():
        found = named.fullmatch(path.name)
        if found and not _lives(int(found[1])):
            path.unlink(missing_ok=True)


def _lives(process: int) -> bool:
    if os.name != "posix":
        return True  # there the question itself would end it
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # another user's
        return True
    return True


def load(path: str | Path) -> Pipeline:
    """Read a fitted pipeline from a file that `save` wrote.

    Parameters
    ----------
    path : str or Path
        Of the file.

    Returns
    -------
    Pipeline
        Fitted.

    Raises
    ------
    UnreadableCalibrationError
        If it holds no such document, or not the one that was saved; the message names the file.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> load("calibration.json").predict(frames)  # doctest: +SKIP
    """
    try:
        return pipeline_of(read_document(Path(path)))
    except (DocumentError, UnreadableCalibrationError) as error:
        raise UnreadableCalibrationError(f"{path}: {error}") from error


def stage_document(stage: Stage) -> dict[str, Any]:
    """Return one fitted stage as what JSON can say.

    Parameters
    ----------
    stage : Extractor, Compensation or Model
        Fitted, where it is to be.

    Returns
    -------
    dict
        Its name and version, what it was given and what it learnt.

    Examples
    --------
    >>> from algorithms.extractors.frames.centroid import BasicCentroid
    >>> stage_document(BasicCentroid())
    {'name': 'bcm', 'version': 1, 'parameters': {'background': 'none', 'window_px': None}, \
'fitted': {}}
    """
    fields = dataclasses.fields(cast("Any", stage))
    return {
        "name": stage.about.name,
        "version": stage.about.version,
        "parameters": {f.name: _plain(getattr(stage, f.name)) for f in fields if f.init},
        "fitted": {f.name: _plain(getattr(stage, f.name)) for f in fields if not f.init},
    }


def stage_of(stored: Mapping[str, Any], known: Mapping[str, type[Any]]) -> Stage:
    """Return the fitted stage of a document, of those known by name.

    Parameters
    ----------
    stored : mapping
        What `stage_document` gave.
    known : mapping of str to class
        Stages by name.

    Returns
    -------
    Extractor, Compensation or Model
        Fitted as it was.

    Raises
    ------
    UnreadableCalibrationError
        If no such stage is known, or in another version, or it is fitted with something else.

    Examples
    --------
    >>> from algorithms.extractors.frames.centroid import BasicCentroid
    >>> stage_of(stage_document(BasicCentroid()), {"bcm": BasicCentroid})
    BasicCentroid(background='none', window_px=None)
    """
    name, version = stored["name"], stored["version"]
    if name not in known:
        raise UnreadableCalibrationError(
            f"no stage is named {name!r} here; there are {', '.join(known)}"
        )
    stage_class = known[name]
    if version != stage_class.about.version:
        raise UnreadableCalibrationError(
            f"the calibration is of version {version} of {name}; here is version "
            f"{stage_class.about.version}: calibrate anew"
        )
    made = stage_class(**_members(stage_class, stored["parameters"]))
    fitted = {field.name for field in dataclasses.fields(made) if not field.init}
    if fitted != set(stored["fitted"]):
        raise UnreadableCalibrationError(
            f"{name} is fitted with {', '.join(sorted(fitted))}; got "
            f"{', '.join(sorted(stored['fitted']))}"
        )
    for key, value in _members(stage_class, stored["fitted"]).items():
        object.__setattr__(made, key, value)
    return cast("Stage", made)


def _members(stage_class: Any, stored: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by name; one that is no value of its member is refused with the name."""
    kinds = {field.name: field.type for field in dataclasses.fields(stage_class)}
    found = {}
    for key, value in stored.items():
        try:
            found[key] = _value(value)
            if isinstance(value, bool) and kinds.get(key) in {"float", "int", float, int}:
                raise TypeError(f"expected a number, got {value}")
        except _MISFITS as error:
            said = f"the calibration is damaged: {error} ({stage_class.about.name}, {key})"
            raise UnreadableCalibrationError(said) from error
    return found


def _plain(value: Any) -> Any:
    """Spell a value in JSON's words; numbers keep every bit."""
    if isinstance(value, np.generic):
        value = value.item()
    spelt = value
    if isinstance(value, np.ndarray):
        spelt = {
            "array": [_number(v) for v in value.ravel().tolist()],
            "shape": list(value.shape),
            "dtype": value.dtype.str.lstrip("<|="),
        }
    elif isinstance(value, float):
        spelt = _number(value)
    elif isinstance(value, str):
        spelt = str(value)  # of an enumeration, its text
    elif isinstance(value, tuple | list):
        spelt = {"tuple": [_plain(v) for v in value]}
    elif isinstance(value, Mapping):
        spelt = {"mapping": {str(k): _plain(v) for k, v in value.items()}}
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        kind = type(value)
        spelt = {
            "object": f"{kind.__module__}:{kind.__qualname__}",
            "fields": {f.name: _plain(getattr(value, f.name)) for f in dataclasses.fields(value)},
        }
    elif not (value is None or isinstance(value, bool | int)):
        raise TypeError(f"a calibration holds numbers, text and tables of them; got {type(value)}")
    return spelt


def _number(value: Any) -> Any:
    """Spell what JSON has no word for: infinity and NaN."""
    if isinstance(value, float) and not math.isfinite(value):
        return {"float": repr(value)}
    return value


def _value(stored: Any) -> Any:
    if isinstance(stored, list):
        raise TypeError("a bare list")
    if not isinstance(stored, dict):
        if isinstance(stored, int | float) and abs(stored) > _LARGEST:
            raise ValueError(f"expected a number of at most {_LARGEST:g}, got {stored!r:.40}")
        return stored
    if "array" in stored:
        return _array(stored)
    if "float" in stored:
        return float(stored["float"])
    if "tuple" in stored:
        return tuple(_value(v) for v in stored["tuple"])
    if "mapping" in stored:
        return {key: _value(v) for key, v in stored["mapping"].items()}
    module, _, name = stored["object"].partition(":")
    if not module.startswith("algorithms."):  # nothing else is loaded on a document's word
        raise UnreadableCalibrationError(f"a calibration holds no {stored['object']}")
    kind = getattr(importlib.import_module(module), name)
    if not (isinstance(kind, type) and dataclasses.is_dataclass(kind)):
        raise UnreadableCalibrationError(f"a calibration holds no {stored['object']}")
    return kind(**{key: _value(v) for key, v in stored["fields"].items()})


def _array(stored: Mapping[str, Any]) -> Any:
    kind = np.dtype(stored["dtype"])
    if kind.kind not in _ENTRIES:
        raise TypeError(f"an array of {stored['dtype']!r}")
    values = [_value(v) for v in stored["array"]]
    if wrong := [v for v in values if type(v) not in _ENTRIES[kind.kind]]:
        raise TypeError(f"expected an array of {kind}, got {wrong[0]!r} in it")
    return np.array(values, dtype=kind).reshape(stored["shape"])


def _without_none(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}
