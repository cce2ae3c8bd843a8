"""Sensors as telemetry has them: raw rows of five kinds, and what their models read of them.

Dark, inversion, order, formula and turns are written out again: nothing here is the project's.
"""

from __future__ import annotations

import importlib.util
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import bench
import numpy as np

from algorithms.contract import FeatureKind
from algorithms.discovery import discover_chains
from calibrate.calibration import Calibration
from calibrate.causes.bad_cells import limits_of
from calibrate.flight.code import FlightCode
from calibrate.readings import Readings
from calibrate.selection import Candidate, fitted, geometry_of
from calibrate.settings import parse_settings

DARK = 4.8
WARMTH = {"temperature_K": "temp_C", "temperature_unit": "degC"}
KINDS = {"spot": FeatureKind.SPOT, "channels": FeatureKind.SIGNALS}


@dataclass(frozen=True)
class Sensor:
    """A sensor of one kind: rows in the file's order, and the features that a model reads."""

    columns: tuple[str, ...]
    readings: dict[str, Any]
    read: Callable[[np.ndarray, int], np.ndarray]
    features: Callable[[np.ndarray], np.ndarray]
    model: str
    half_deg: float | None
    form: str = "alpha-inner"
    apply: tuple[str, ...] = ()
    drift: np.ndarray | None = None
    sensor: dict[str, Any] = field(default_factory=dict)

    def suns(self, seed: int, count: int = 400) -> np.ndarray:
        """Directions over the field."""
        if self.half_deg is None:
            return bench.sphere(count, seed)
        drawn = np.random.default_rng([seed, 7])
        return bench.sun_of(drawn.uniform(-self.half_deg, self.half_deg, (count, 2)))

    def context(self, seed: int, count: int = 400) -> dict[str, np.ndarray]:
        """Temperatures, where the model reads them."""
        kelvin = np.random.default_rng([seed, 8]).uniform(255.0, 330.0, count)
        return {} if self.drift is None else {"temperature_K": kelvin}

    def raw(self, seed: int, count: int = 400) -> np.ndarray:
        """Rows in the file's order."""
        rows = self.read(self.suns(seed, count), seed)
        if self.drift is None:
            return rows
        kelvin = self.context(seed, count)["temperature_K"]
        return rows * (1.0 + self.drift * (kelvin - 290.0)[:, None])

    def celsius(self, seed: int) -> np.ndarray | None:
        """Temperatures as the file has them."""
        kelvin = self.context(seed).get("temperature_K")
        return None if kelvin is None else kelvin - 273.15

    def telemetry(self, seed: int) -> np.ndarray:
        """Rows with their temperature, where there is one."""
        celsius = self.celsius(seed)
        rows = self.raw(seed)
        return rows if celsius is None else np.column_stack([rows, celsius])

    def answers(self, model: Any, seed: int) -> np.ndarray:
        """Directions that a model gives of rows."""
        return np.asarray(model.predict(self.features(self.raw(seed)), self.context(seed)))

    def calibrated(self, base: Calibration, seed: int = 1) -> Calibration:
        """A calibration by one model, without the search for one; its error is of other rows."""
        columns = ("a", "b", "c") if self.form == "vector" else ("a", "b")
        settings = parse_settings(
            {
                "readings": self.readings,
                "direction": {"columns": columns, "form": self.form},
                "apply": self.apply,
                "sensor": self.sensor,
                "rows": {} if self.drift is None else WARMTH,
            },
            "test",
        )
        stated = settings.readings
        raw, sun = self.raw(seed), self.suns(seed)
        ordered = raw[:, [self.columns.index(name) for name in stated.columns]]
        signals = (-1.0 if stated.inverted else 1.0) * (ordered - stated.dark) / stated.gain
        made = Readings(
            self.features(raw),
            sun,
            KINDS.get(stated.kind, FeatureKind.BALANCE),
            np.arange(len(sun)) + 2,
            np.zeros(len(sun), dtype=np.int64),
            ("run",),
            signals,
            self.context(seed),
        )
        model = fitted(discover_chains()[self.model], made, geometry_of(made, settings))
        off = apart_deg(self.answers(model, 2), self.suns(2))
        return replace(
            base,
            settings=settings,
            readings=made,
            model=model,
            chosen=Candidate(self.model, rms_deg=float(np.sqrt(np.nanmean(off**2)))),
            intervals=None,
            limits=limits_of(made, settings, {}),
            columns=self.columns,
            sources=("bench.csv",),
        )


def apart_deg(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Angles between directions (N, 3)."""
    cross = np.linalg.norm(np.cross(one, other), axis=1)
    return np.degrees(np.arctan2(cross, (one * other).sum(axis=1)))


def quadrant_volts(sun: np.ndarray, seed: int) -> np.ndarray:
    """Outputs of a turned detector that fall from 4.8 V, wired third, first, fourth, second."""
    turned = np.column_stack([sun[:, 1], -sun[:, 0], sun[:, 2]])
    return DARK - 1.1 * bench.quadrants(turned, seed)[:, [2, 0, 3, 1]]


def turned_balances(raw: np.ndarray) -> np.ndarray:
    """Balances of those, rotated by 90 degrees."""
    third, first, fourth, second = (DARK - raw).T
    total = first + second + third + fourth
    x = (second + third - first - fourth) / total
    y = (first + second - third - fourth) / total
    return np.column_stack([-y, x])


def electrode_balances(raw: np.ndarray) -> np.ndarray:
    """Balances of currents with a dark level and a gain."""
    right, left, up, down = ((raw - 0.2) / 3.0).T
    return np.column_stack([(right - left) / (right + left), (up - down) / (up + down)])


def cells(normals: np.ndarray) -> Callable[[np.ndarray, int], np.ndarray]:
    """Plain cosine cells whose gains differ."""

    def read(sun: np.ndarray, seed: int) -> np.ndarray:
        light = np.maximum(sun @ normals.T, 0.0) * np.linspace(1.0, 1.06, len(normals))
        return light + np.random.default_rng(seed).normal(0.0, 0.004, light.shape)

    return read


def tilted(count: int = 4, tilt_deg: float = 35.0) -> np.ndarray:
    """Normals of a regular pyramid."""
    tilt, around = np.radians(tilt_deg), 2.0 * np.pi * (np.arange(count) + 0.5) / count
    flat = np.sin(tilt) * np.column_stack([np.cos(around), np.sin(around)])
    return np.column_stack([flat, np.full(count, np.cos(tilt))])


def array(normals: np.ndarray, model: str, half_deg: float | None, **more: Any) -> Sensor:
    """Cells that look along normals, which the drawing names."""
    names = tuple(f"cell{number}" for number in range(len(normals)))
    drawn = {"face_normals": tuple(tuple(row) for row in normals.tolist())}
    if half_deg is not None:
        drawn["half_fov_deg"] = half_deg
    return Sensor(
        names,
        {"kind": "channels", "columns": names},
        cells(normals),
        lambda raw: raw,
        model,
        half_deg,
        "vector",
        sensor=drawn,
        **more,
    )


CUBE = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
ELECTRODES = ("xp", "xm", "yp", "ym")
DRIFTS = np.array([1.0, 2.0, 0.5, -1.0, 1.5, 0.7]) * 1e-3
SENSORS = {
    "spots": Sensor(
        ("y_px", "x_px"),
        {"kind": "spot", "columns": ("x_px", "y_px")},
        lambda sun, seed: bench.spots(sun, seed)[:, ::-1],
        lambda raw: raw,
        "homography",
        50.0,
        "projection",
        ("swap-xy",),
    ),
    "quadrants": Sensor(
        ("q3", "q1", "q4", "q2"),
        {"kind": "quadrants", "columns": ("q1", "q2", "q3", "q4"), "dark": DARK, "inverted": True},
        quadrant_volts,
        turned_balances,
        "fourier-balance",
        30.0,
        apply=("rotate-90",),
    ),
    "electrodes": Sensor(
        ELECTRODES,
        {"kind": "electrodes", "columns": ELECTRODES, "dark": 0.2, "gain": 3.0},
        lambda sun, seed: 0.2 + 3.0 * bench.electrodes(sun, seed),
        electrode_balances,
        "lut-polynomial",
        50.0,
        "beta-inner",
    ),
    "six faces": array(CUBE, "trig", None),
    "four tilted cells": array(tilted(), "assembled-faces", 35.0),
    "warm faces": array(CUBE, "temperature + basic", None, drift=DRIFTS),
}
#: Other models of faces.
OTHERS = {
    **{
        name: array(CUBE, name, None)
        for name in (
            *("basic", "solar-panel", "trig-averaged", "assembled-faces", "polynomial-signals"),
            *("angular-loss + basic", "maximum-currents + solar-panel"),
        )
    },
    **{
        name: array(tilted(), name, 35.0)
        for name in ("pyramidal", "pyramidal-constant", "angular-loss + pyramidal")
    },
    "panoramic": array(bench.sphere(20, 9), "panoramic", None),
    "panoramic-temperature": array(
        bench.sphere(20, 9), "panoramic-temperature", None, drift=np.full(20, 1e-3)
    ),
}


def compiled(directory: Path, *command: str, **known: Any) -> str:
    """Run a command; returns its words, or fails with those of its errors."""
    run = subprocess.run(
        command, cwd=directory, check=False, capture_output=True, text=True, **known
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert not run.stderr
    return run.stdout


FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic")
CHECKED = ("-fsanitize=undefined,address", "-fno-sanitize-recover=all")


def written(code: FlightCode, directory: Path, digest: str = "0" * 32) -> Path:
    """Write the files of code by the name ``ss``."""
    for name, text in code.files("ss", {"Model": "test"}, digest).items():
        (directory / name).write_text(text)
    return directory


def module_of(directory: Path) -> Any:
    """Import the Python module of written code."""
    spec = importlib.util.spec_from_file_location("ss", directory / "ss.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def c_answers(directory: Path, rows: np.ndarray, flags: tuple[str, ...] = CHECKED) -> np.ndarray:
    """Status, direction, angles and 1-sigma (N, 8) of rows, by the compiled example."""
    if not (directory / "example").exists():
        files = ("ss.c", "ss_example.c", "-o", "example", "-lm")
        compiled(directory, "gcc", *FLAGS, *flags, *files)
    text = "\n".join(" ".join(f"{value:.17g}" for value in row) for row in rows)
    lines = compiled(directory, "./example", input=text).splitlines()
    return np.array([line.split() for line in lines], dtype=float)
