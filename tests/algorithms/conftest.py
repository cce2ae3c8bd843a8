"""A sensor, and observations and calibrations of every kind an implementation may read."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from dataclasses import field as field_
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.angles import sun_from_angles
from algorithms.calibration.parametric import tangent_axes
from algorithms.context import CONTEXT
from algorithms.contract import FeatureKind, Observation, SensorGeometry
from algorithms.spot_lists import list_length

Floats = NDArray[np.float64]

# The suite's modules import each other by name; what they assert is spelt out where it fails.
sys.path.append(str(Path(__file__).parent / "suite"))
pytest.register_assert_rewrite(
    "expectations", "compensation_checks", "extractor_checks", "model_checks", "sequence_checks"
)

from designs import (  # noqa: E402 - of the suite's folder
    DIAL,
    FACES,
    HOLES,
    LINE_PIXELS,
    LISTS,
    MULTI_SPOT,
    OWN_DESIGN,
    PYRAMID,
    PYRAMIDS,
)

#: Middle and spread of numbers that a context holds.
USUAL = {"temperature_K": (298.0, 30.0), "illumination": (1.0, 0.03), "time_s": (500.0, 500.0)}
COMMON_SUITE = "test_common_suite.py::test_"
KINDS = ("compensation", "extractor", "model", "sequence")


@dataclass(frozen=True)
class Calibration:
    """Features of known Suns, with what a model reads beside them."""

    features: Floats
    sun: Floats
    context: dict[str, Floats] = field_(default_factory=dict)

    def of(self, rows: Any) -> Calibration:
        """Those rows."""
        context = {name: column[rows] for name, column in self.context.items()}
        return Calibration(self.features[rows], self.sun[rows], context)

    def beside(self, names: tuple[str, ...]) -> Calibration:
        """The same with context: numbers of a column's usual size, unit vectors."""
        rng, context = np.random.default_rng(19), {}
        for name in names:
            middle, spread = USUAL.get(name, (0.0, 1.0))
            column = middle + spread * rng.uniform(-1.0, 1.0, (len(self.sun), *CONTEXT[name]))
            if column.ndim == 2:
                column /= np.linalg.norm(column, axis=1, keepdims=True)
            context[name] = column
        # the sensor's axes are the inertial ones here
        if "sun_inertial" in context:
            context["sun_inertial"] = self.sun.copy()
        if {"magnetic_field_nT", "magnetic_field_inertial_nT"} <= context.keys():
            context["magnetic_field_inertial_nT"] = context["magnetic_field_nT"].copy()
        return replace(self, context=context)


@pytest.fixture(scope="session")
def geometry() -> SensorGeometry:
    """A sensor with every field known, so that every implementation can be made for it."""
    return SensorGeometry(
        focal_length_mm=2.0,
        pixel_pitch_mm=0.01,
        centre_px=(200.0, 150.0),
        aperture_width_mm=4.0,
        aperture_shape="square",
        face_normals=FACES,
        half_fov_deg=35.0,
    )


@pytest.fixture(scope="session")
def design_for(geometry: SensorGeometry) -> Callable[[Any], SensorGeometry]:
    """The sensor one class is made for: lines behind a slit, code dials, a pyramid of faces."""

    def make(implementation: Any) -> SensorGeometry:
        if "code_bits" in implementation.about.needs:
            return replace(geometry, line_axes=("x", "y"), **DIAL)
        # faces that are all lit, whatever the Sun
        if implementation.about.name in PYRAMIDS:
            return replace(geometry, face_normals=PYRAMID)
        if implementation.about.name in MULTI_SPOT:
            return replace(geometry, focal_length_mm=0.5, aperture_width_mm=0.05, apertures=HOLES)
        if getattr(implementation.about, "observation", None) is Observation.PROFILES:
            return replace(
                geometry,
                pixel_pitch_mm=0.05,
                line_axes=("x", "y"),
                line_pixels=LINE_PIXELS,
                slits=((0.0, 0.0, 0.3),),
            )
        return replace(geometry, **OWN_DESIGN.get(implementation.about.name, {}))

    return make


@pytest.fixture(scope="session")
def field() -> Floats:
    """Suns on a turntable's grid, 35 degrees to each side, then at random in between."""
    steps = np.linspace(-35.0, 35.0, 11)
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    between = np.random.default_rng(5).uniform(-34.0, 34.0, (40, 2))
    return sun_from_angles(np.vstack([grid, between]))


def _spots(count: int = 9, height: int = 24, width: int = 31) -> NDArray[np.uint8]:
    """Small noisy spots on a background, whole numbers that every dtype holds."""
    rng = np.random.default_rng(11)
    y, x = np.mgrid[:height, :width]
    centres = rng.uniform((8.0, 8.0), (width - 8.0, height - 8.0), (count, 2))
    frames = np.empty((count, height, width))
    for frame, (cx, cy) in zip(frames, centres, strict=True):
        frame[:] = 200 * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / 9.0)
    return (frames + rng.integers(0, 12, frames.shape)).astype(np.uint8)


def _squares(geometry: SensorGeometry, count: int = 5) -> NDArray[np.uint8]:
    """Noisy spots as wide as the sensor's square aperture, whole numbers that every dtype holds."""
    width = round(geometry.aperture_width_mm / geometry.pixel_pitch_mm)
    rng = np.random.default_rng(13)
    frames = rng.integers(0, 12, (count, width + 10, width + 13)).astype(np.uint8)
    for frame, (left, top) in zip(frames, rng.integers(2, 9, (count, 2)), strict=True):
        frame[top : top + width, left : left + width] += 200
    return frames


def _many_spots(geometry: SensorGeometry, count: int = 6) -> NDArray[np.uint8]:
    """Noisy spots of a few square holes, whole numbers that every dtype holds."""
    rng = np.random.default_rng(15)
    y, x = np.mgrid[:40, :46]
    light = np.zeros((count, 40, 46))
    for frame, (left, top) in zip(light, rng.uniform((19, 17), (26, 22), (count, 2)), strict=True):
        for place_x, place_y, width in np.array(HOLES) / geometry.pixel_pitch_mm:
            away = np.maximum(np.abs(x - left - place_x), np.abs(y - top - place_y))
            frame[:] += 200 / (1 + np.exp(4 * (away - width / 2)))
    return (light + rng.integers(0, 12, light.shape)).astype(np.uint8)


def _black_suns(count: int = 7) -> NDArray[np.uint8]:
    """Black discs in saturated halos, with noise, whole numbers that every dtype holds."""
    rng = np.random.default_rng(16)
    y, x = np.mgrid[:40, :44]
    frames = rng.integers(0, 12, (count, 40, 44)).astype(np.uint8)
    for n, (cx, cy) in enumerate(rng.uniform(16.0, 24.0, (count, 2))):
        away = np.hypot(x - cx, y - cy)
        frames[n, (away > 3.5) & (away < 9.0)] = 240
    return frames


def _blooming_suns(count: int = 7) -> NDArray[np.uint8]:
    """Saturated discs in halos with lines along their columns, whole numbers for every dtype."""
    rng = np.random.default_rng(17)
    y, x = np.mgrid[:60, :44]
    frames = np.empty((count, 60, 44))
    for frame, (cx, cy) in zip(frames, rng.uniform((16, 26), (28, 34), (count, 2)), strict=True):
        frame[:] = 1500.0 / (1.0 + ((x - cx) ** 2 + (y - cy) ** 2) / 4.0) ** 1.5
        frame[(np.abs(x - cx) <= 1.5) & (np.abs(y - cy) <= 20.0)] = 240
    return (np.minimum(frames, 240) + rng.integers(0, 6, frames.shape)).astype(np.uint8)


def _lines(count: int = 7) -> NDArray[np.uint8]:
    """Noisy L of two lines eight pixels wide, whole numbers that every dtype holds."""
    rng = np.random.default_rng(20)
    y, x = np.mgrid[:60, :64]
    frames = rng.integers(0, 6, (count, 60, 64)).astype(np.uint8)
    for frame, (cx, cy) in zip(frames, rng.uniform(11.0, 15.0, (count, 2)), strict=True):
        upright = (y > cy + 12) & (y < cy + 38)
        flat = (x > cx + 12) & (x < cx + 38)
        lit = upright / (1 + np.exp(2 * (np.abs(x - cx) - 4)))
        frame[:] += (200 * (lit + flat / (1 + np.exp(2 * (np.abs(y - cy) - 4))))).astype(np.uint8)
    return frames


def _spikes(count: int = 7) -> NDArray[np.uint8]:
    """First events of a spot five pixels wide, whole numbers that every dtype holds."""
    rng = np.random.default_rng(18)
    y, x = np.mgrid[:40, :44]
    events = np.empty((count, 24, 3), dtype=np.uint8)
    for sample, (cx, cy) in zip(events, rng.uniform(10.0, 29.0, (count, 2)), strict=True):
        times = 60.0 + (np.hypot(x - cx, y - cy) / 0.7) ** 4 + rng.uniform(0, 9, x.shape)
        first = np.argsort(times, axis=None)[:24]
        sample[:] = np.column_stack([x.flat[first], y.flat[first], times.flat[first].clip(0, 250)])
    return events


def _profiles(count: int = 9) -> NDArray[np.uint8]:
    """Noisy light of a slit six pixels wide on two lines, whole numbers that every dtype holds."""
    rng = np.random.default_rng(14)
    at = np.arange(LINE_PIXELS)
    centres = rng.uniform(12.0, LINE_PIXELS - 13.0, (count, 2, 1))
    light = 200 / (1 + np.exp(4 * (np.abs(at - centres) - 3.0)))
    profiles = (light + rng.integers(0, 12, light.shape)).astype(np.uint8)
    return profiles.reshape(count, 2 * LINE_PIXELS)


def _dial_signals(geometry: SensorGeometry, tangents: Floats) -> Floats:
    """Light behind the tracks of ideal code dials, one an axis, under a slit without width."""
    parts = []
    for tangent in tangents.T:
        place = geometry.focal_length_mm * tangent
        cell = np.floor(place / geometry.code_cell_mm).astype(int) + 2 ** (geometry.code_bits - 1)
        gray = cell ^ (cell >> 1)
        parts += [(gray >> bit) & 1 for bit in reversed(range(geometry.code_bits))]
        phase = 2 * np.pi * place / geometry.fine_period_mm
        parts += [(1 - np.cos(phase)) / 2, (1 - np.sin(phase)) / 2]
        parts += [(1 + np.cos(phase)) / 2, (1 + np.sin(phase)) / 2]
    return np.column_stack(parts).astype(np.float64)


def _spot_lists(geometry: SensorGeometry, tangents: Floats) -> Floats:
    """Spots of a mask well on its detector, for each of the Sun's tangents (x, y)."""
    middle, holes = np.array(geometry.centre_px), np.array(geometry.apertures)[:, :2]
    if np.ptp(holes, axis=0).max() < geometry.pixel_pitch_mm * middle.min():  # all seen at once
        spots = (
            middle
            + (holes + geometry.focal_length_mm * tangents[:, None]) / geometry.pixel_pitch_mm
        )
        return np.dstack([spots, np.full(spots.shape[:2], 1000.0)]).reshape(len(spots), -1)
    lists = np.zeros((len(tangents), list_length(geometry, "suite"), 3))
    for row, tangent in zip(lists, tangents, strict=True):
        spots = middle + (holes + geometry.focal_length_mm * tangent) / geometry.pixel_pitch_mm
        seen = spots[(np.abs(spots - middle) < middle - 4.0).all(axis=1)]
        row[: len(seen), :2] = seen
        row[: len(seen), 2] = 1000.0
    return lists.reshape(len(lists), -1)


def _ruled(geometry: SensorGeometry, tangents: Floats) -> Floats:
    """Light of equal slits on each line of pixels, for each of the Sun's tangents (x, y)."""
    places, _, widths = np.array(geometry.slits).T
    at = geometry.pixel_pitch_mm * (np.arange(geometry.line_pixels) - geometry.centre_px[0])
    lines = []
    for axis in geometry.line_axes:
        shift = geometry.focal_length_mm * tangents[:, 0 if axis == "x" else 1]
        away = np.abs(at - shift[:, None, None] - places[:, None])
        lit = (widths[0] / 2.0 - away) / geometry.pixel_pitch_mm + 0.5
        lines.append(np.clip(lit, 0.0, 1.0).sum(axis=1))
    return np.hstack(lines)


#: Makers of samples, by an implementation's name where it needs its own, else by observation.
OWN_SAMPLES: dict[str, Callable[[], NDArray[Any]]] = {
    "bscm": _black_suns,
    "hough-lines": _blooming_suns,
    "line-windows": _lines,
    Observation.FRAMES: _spots,
    Observation.PROFILES: _profiles,
    Observation.EVENTS: _spikes,
}


@pytest.fixture(scope="session")
def observations_for(geometry: SensorGeometry) -> Callable[[Any], NDArray[Any]]:
    """Observations (N, ...) with something to find in every row, for one extractor class."""

    def make(extractor: Any) -> NDArray[Any]:
        if extractor.about.name == "tm":  # its template is the sensor's aperture
            return _squares(geometry)
        if extractor.about.name in MULTI_SPOT | LISTS:
            return _many_spots(geometry)
        if make_own := OWN_SAMPLES.get(
            extractor.about.name, OWN_SAMPLES.get(extractor.about.observation)
        ):
            return make_own()
        if extractor.about.observation is Observation.CURRENTS:
            columns = {FeatureKind.BALANCE: 4, FeatureKind.SIGNALS: len(FACES)}[
                extractor.about.kind
            ]
            if "code_bits" in extractor.about.needs:
                columns = 2 * (DIAL["code_bits"] + 4)
            return np.random.default_rng(12).integers(20, 250, (9, columns)).astype(np.uint8)
        raise NotImplementedError(f"make sample {extractor.about.observation} here for {extractor}")

    return make


@pytest.fixture(scope="session")
def calibration_for(geometry: SensorGeometry, field: Floats) -> Callable[..., Calibration]:
    """Noiseless features of the sensor as drawn, of one kind; by default of `geometry`."""

    def make(kind: FeatureKind, geometry: SensorGeometry = geometry) -> Calibration:
        tan_beta, tan_alpha = (field[:, :2] / field[:, 2:]).T
        if kind is FeatureKind.SPOT:
            scale = geometry.focal_length_mm / geometry.pixel_pitch_mm
            x, y = geometry.centre_px
            return Calibration(
                np.column_stack([x + scale * tan_beta, y + scale * tan_alpha]), field
            )
        if kind is FeatureKind.BALANCE:
            scale = 2 * geometry.focal_length_mm / geometry.aperture_width_mm
            return Calibration(scale * np.column_stack([tan_beta, tan_alpha]), field)
        if kind is FeatureKind.SPOTS:
            return Calibration(_spot_lists(geometry, np.column_stack([tan_beta, tan_alpha])), field)
        if kind is FeatureKind.SIGNALS and geometry.line_pixels is not None:
            return Calibration(_ruled(geometry, np.column_stack([tan_beta, tan_alpha])), field)
        if kind is FeatureKind.SIGNALS and geometry.code_bits is not None:
            return Calibration(
                _dial_signals(geometry, np.column_stack([tan_beta, tan_alpha])), field
            )
        if kind is FeatureKind.SIGNALS:
            return Calibration(np.maximum(field @ np.array(geometry.face_normals).T, 0.0), field)
        raise NotImplementedError(f"make sample {kind} features here")

    return make


@pytest.fixture(scope="session")
def flight_for(geometry: SensorGeometry) -> Callable[..., Calibration]:
    """Noiseless features of the sensor on a body that turns, in the order of time."""
    import flights

    return lambda kind: Calibration(**flights.flight(kind, geometry))


@pytest.fixture(scope="session")
def coverage_of() -> Callable[..., float]:
    """Share of 95 % intervals that hold the truth, over parameters and 200 draws of noise.

    Of the turntable, 2e-4 rad, or of the features where their size is given.
    """

    def share(
        model: Any, features: Floats, sun: Floats, truth: Floats, of_features: float = 0.0
    ) -> float:
        model.starts = lambda *_: (truth,)  # the solution is the same, and sooner found
        first, second = tangent_axes(sun)
        held = []
        for seed in range(200):
            rng, read, stated = np.random.default_rng(seed), features, sun
            if of_features:
                read = features + rng.normal(0.0, of_features, features.shape)
            else:
                off = rng.normal(0.0, 2e-4, (2, len(sun), 1))
                stated = sun + off[0] * first + off[1] * second
                stated = stated / np.linalg.norm(stated, axis=1, keepdims=True)
            model.learn(read, stated, {})
            for parameter, value in zip(model.fitted_parameters(), truth, strict=True):
                low, high = parameter.interval()
                held.append(low <= value <= high)
        del model.starts
        return float(np.mean(held))

    return share


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many checks of the common suite passed, and on how many implementations."""
    passed = [
        report.nodeid
        for report in terminalreporter.stats.get("passed", [])
        if any(f"{COMMON_SUITE}{kind}[" in report.nodeid for kind in KINDS)
    ]
    if passed:
        names = {nodeid.split("[")[1].rsplit("-check_")[0] for nodeid in passed}
        terminalreporter.write_line(
            f"common suite: {len(passed)} checks passed on {len(names)} implementations"
        )
