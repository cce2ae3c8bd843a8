"""Calibration from Python: readings and directions as arrays, or as columns of a data frame."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats
from calibrate.calibration import Calibration, calibrate_tables
from calibrate.readings import features_of
from calibrate.roles import understood
from calibrate.settings import COLUMNS, Settings, SettingsError, parse_settings
from calibrate.table import Table, table_of

if TYPE_CHECKING:
    import pandas as pd

#: Columns that a table of arrays gets beside those of the readings.
_SUN, _ROWS = ("sun_x", "sun_y", "sun_z"), ("run", "time_s", "temperature_K")


@dataclass(frozen=True)
class CalibratedSensor:
    """A calibrated sensor: answers readings with directions.

    Attributes
    ----------
    found : Calibration
        The model, its errors, the verdict and all that was found.
    """

    found: Calibration

    def predict(self, readings: ArrayLike, *, temperature_K: ArrayLike | None = None) -> Floats:
        """Return the direction of the light for each reading.

        Parameters
        ----------
        readings : array_like, shape (N, F)
            In the order and units of those that were calibrated; dark level, gain and changes of
            axes are applied here.
        temperature_K : array_like, shape (N,), optional
            Of a model that uses it.

        Returns
        -------
        ndarray, shape (N, 3)
            Unit vectors; NaN outside the calibrated region.
        """
        features, context = self._features(readings, temperature_K)
        return np.asarray(self.found.model.predict(features, context))

    def covariance(self, readings: ArrayLike, *, temperature_K: ArrayLike | None = None) -> Floats:
        """Return the covariance of each direction of `predict`, square radians.

        Parameters
        ----------
        readings, temperature_K
            As `predict` takes them.

        Returns
        -------
        ndarray, shape (N, 3, 3)
            Of rank two: a unit vector errs square to itself alone. NaN where nothing is answered.
        """
        return self.found.covariance(*self._features(readings, temperature_K))

    def _features(
        self, readings: ArrayLike, temperature: ArrayLike | None
    ) -> tuple[Floats, dict[str, Floats]]:
        raw = np.asarray(readings, dtype=np.float64)
        count = len(self.found.settings.readings.columns)
        if raw.ndim != 2 or raw.shape[1] != count:
            raise ValueError(f"readings: expected an array (N, {count}); got {raw.shape}")
        context: dict[str, Floats] = {}
        if "temperature_K" in tuple(self.found.model.about.context):
            if temperature is None:
                raise ValueError("temperature_K: expected an array (N,), which this model uses")
            context["temperature_K"] = np.asarray(temperature, dtype=np.float64)
        return features_of(raw, self.found.settings), context


def calibrate_arrays(
    readings: ArrayLike,
    sun: ArrayLike,
    *,
    kind: str = "spot",
    run: ArrayLike | None = None,
    time_s: ArrayLike | None = None,
    temperature_K: ArrayLike | None = None,
    settings: Mapping[str, Any] | None = None,
    apply: bool = False,
    thorough: bool = False,
    models: Sequence[str] | None = None,
) -> CalibratedSensor:
    """Calibrate a sensor from arrays.

    Parameters
    ----------
    readings : array_like, shape (N, F)
        A reading a row, in the order of its kind (`ReadingsSettings.kind`).
    sun : array_like, shape (N, 3)
        Unit vectors towards the light.
    kind : {"spot", "balance", "quadrants", "electrodes", "channels"}
        What the readings are.
    run : array_like, shape (N,), optional
        Name or number of the run of each row; one run by default.
    time_s, temperature_K : array_like, shape (N,), optional
        Time, seconds, and temperature, kelvin.
    settings : mapping, optional
        Further settings by section, as in ``sensor.toml``, such as ``{"bench": {"floor_deg":
        0.01}, "readings": {"dark": 12.0}}``.
    apply, thorough, models
        As `calibrate.calibration.calibrate` takes them.

    Returns
    -------
    CalibratedSensor
        Row numbers in it count from 0.

    Raises
    ------
    ValueError
        If shapes do not fit each other; SettingsError and TableError are among them.
    UnusableDataError
        If the rows settle no model; the message says what would.
    """
    if kind not in COLUMNS or kind == "frames":
        known = ", ".join(name for name in COLUMNS if name != "frames")
        raise SettingsError(f"kind: expected one of {known}; got {kind!r}")
    raw, light = (np.asarray(one, dtype=np.float64) for one in (readings, sun))
    if raw.ndim != 2:
        raise ValueError(f"readings: expected an array (N, F); got {raw.shape}")
    if light.shape != (len(raw), 3):
        raise ValueError(f"sun: expected an array ({len(raw)}, 3); got {light.shape}")
    names = [f"reading_{at}" for at in range(raw.shape[1])]
    columns: dict[str, NDArray[Any]] = dict(zip([*names, *_SUN], [*raw.T, *light.T], strict=True))
    given = {"run": run, "time_s": time_s, "temperature_K": temperature_K}
    for name, one in given.items():
        if one is not None:
            column = np.asarray(one)
            if column.shape != (len(raw),):
                raise ValueError(f"{name}: expected an array ({len(raw)},); got {column.shape}")
            columns[name] = column if name == "run" else column.astype(np.float64)
    stated = {section: dict(values) for section, values in (settings or {}).items()}
    stated["readings"] = {**stated.get("readings", {}), "kind": kind, "columns": names}
    stated["direction"] = {"form": "vector", "columns": list(_SUN)}
    stated["rows"] = {**stated.get("rows", {}), **{n: n for n in _ROWS if given[n] is not None}}
    table = Table(columns, 0, "arrays", {})
    return _calibrated(table, parse_settings(stated, "settings"), apply, thorough, models)


def calibrate_frame(
    frame: pd.DataFrame,
    settings: Mapping[str, Any] | None = None,
    *,
    apply: bool = False,
    thorough: bool = False,
    models: Sequence[str] | None = None,
) -> CalibratedSensor:
    """Calibrate a sensor from a data frame.

    Parameters
    ----------
    frame : DataFrame
        A row per reading: columns of readings and of the direction of the light.
    settings : mapping, optional
        Sections as in ``sensor.toml``: ``{"readings": {"kind": "spot", "columns": ["u", "v"]},
        "direction": {"columns": ["pan", "tilt"], "form": "alpha-inner"}}``; by default guessed
        from the names of the columns.
    apply, thorough, models
        As `calibrate.calibration.calibrate` takes them.

    Returns
    -------
    CalibratedSensor
        Row numbers in it count from 0.

    Raises
    ------
    SettingsError, TableError
        If settings are not valid, or columns are missing, not recognised or no numbers.
    UnusableDataError
        If the rows settle no model; the message says what would.
    """
    table = table_of(frame, "data frame")
    stated = (
        understood(table).settings
        if settings is None
        else parse_settings(dict(settings), "settings")
    )
    if stated.readings.kind == "frames":
        raise SettingsError(
            "readings.kind: expected readings in the frame; pictures are read by "
            "calibrate.calibration.calibrate"
        )
    return _calibrated(table, stated, apply, thorough, models)


def _calibrated(
    table: Table, stated: Settings, apply: bool, thorough: bool, models: Sequence[str] | None
) -> CalibratedSensor:
    found = calibrate_tables([table], stated, apply=apply, thorough=thorough, models=models)
    state = hashlib.sha256()
    for name, column in table.columns.items():
        state.update(name.encode() + np.ascontiguousarray(column).tobytes())
    digest = state.hexdigest()
    return CalibratedSensor(replace(found, digest=digest[:32], digests=(digest,)))
