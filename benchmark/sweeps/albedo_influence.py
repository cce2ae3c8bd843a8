"""How far light from the sunlit Earth moves an estimate: on photodiodes, bare or behind an opening.

And on pixels behind a pinhole.

The same Earth, the same random positions in orbit; noise is left out, so that what moves is moved
by the Earth alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Floats, Observation
from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.pipeline import Pipeline
from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.metrics.separation import separation_deg
from benchmark.seeds import generator
from benchmark.simulator.flight.time_series import TimedScene
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.sensors.faces import FaceSensor
from benchmark.simulator.sensors.frames import FrameSensor

#: Currents of a balance along two axes.
_BALANCED = 4


class NoInfluenceError(TypeError):
    """The influence of the Earth's light on a dataset's sensor is not worked out."""


@dataclass(frozen=True)
class Influence:
    """Angle (N,) by which light from the Earth moves each sample's estimate, and the bound."""

    moved_deg: Floats
    bound_deg: Floats

    @property
    def worst_deg(self) -> float:
        """Largest movement."""
        return float(np.nanmax(self.moved_deg))

    @property
    def rms_deg(self) -> float:
        """Root mean square movement."""
        return float(np.sqrt(np.nanmean(self.moved_deg**2)))

    @property
    def rms_over_bound(self) -> float:
        """Root mean square movement over that of the bound, where both are finite."""
        both = np.isfinite(self.moved_deg) & np.isfinite(self.bound_deg)
        moved, bound = self.moved_deg[both], self.bound_deg[both]
        return float(np.sqrt(np.mean(moved**2) / np.mean(bound**2)))

    @property
    def share_above_a_tenth(self) -> float:
        """Share of samples moved by more than a tenth of their own bound."""
        both = np.isfinite(self.moved_deg) & np.isfinite(self.bound_deg)
        return float(np.mean(self.moved_deg[both] > 0.1 * self.bound_deg[both]))


def influence(name: str, samples: int | None = None) -> Influence:
    """Say how far the Earth's light moves the estimates of a dataset's sensor.

    `on_cube`, `on_balance` or `on_aperture`, whichever its sensor is for.
    Of the first samples of the test split, or all. NoInfluenceError for a sensor of another kind.
    """
    preset = datasets.get(name)
    if isinstance(preset.condition(preset.conditions[0]).sensor, FaceSensor):
        return on_cube(name, samples)
    if preset.observation is Observation.CURRENTS and preset.geometry.aperture_width_mm is not None:
        return on_balance(name, samples)
    return on_aperture(name, samples)


def maximum_currents(currents: Floats) -> Floats:
    """Sun directions (N, 3) of a cube's currents (N, 6), faces +x, -x, +y, -y, +z, -z.

    The larger of each pair with its sign, made a unit vector (eq:albedo1, Frezza2022).
    """
    plus, minus = currents[:, ::2], currents[:, 1::2]
    found = np.where(plus >= minus, plus, -minus)
    return np.asarray(found / np.sqrt(np.sum(found**2, axis=1, keepdims=True)))


def on_cube(name: str = "pd-maskless-cube", samples: int | None = None) -> Influence:
    """Move the maximum-currents estimate of a photodiode cube's albedo condition."""
    preset = _with_albedo(name)
    sensor = preset.condition("albedo").sensor
    if not isinstance(sensor, FaceSensor) or not _is_cube(sensor):
        raise NoInfluenceError(f"dataset {name} has no cube of photodiodes")
    scene, pattern = preset.scene("albedo", "test"), preset.fixed_pattern("albedo")
    scene = scene.part(0, len(scene) if samples is None else samples)
    with_earth = maximum_currents(sensor.expected(scene, pattern))
    without = maximum_currents(sensor.expected(replace(scene, albedo=None), pattern))
    bound = preset.bound("albedo", "test", samples).angle_deg
    return Influence(separation_deg(with_earth, without), bound)


def on_balance(name: str = "qpd-single-aperture", samples: int | None = None) -> Influence:
    """Move the voltage balance of photodiodes behind an opening by Earth's light.

    Its directions are those of the standard projection, fitted on the ground.
    """
    preset = _with_albedo(name)
    sensor, pattern = preset.condition("albedo").sensor, preset.fixed_pattern("albedo")
    ground = preset.scene("albedo", "calibration")
    currents = sensor.expected(ground, pattern)
    if currents.shape[1] != _BALANCED:
        raise NoInfluenceError(f"dataset {name} has {currents.shape[1]} currents, no balance")
    pipeline = Pipeline.for_sensor(VoltageBalance, StandardProjection, preset.geometry)
    pipeline.fit(currents, ground.sun)
    scene = preset.scene("albedo", "test")
    scene = scene.part(0, len(scene) if samples is None else samples)
    with_earth, without = (
        pipeline.predict(sensor.expected(seen, pattern))
        for seen in (scene, replace(scene, albedo=None))
    )
    bound = preset.bound("albedo", "test", samples).angle_deg
    return Influence(separation_deg(with_earth, without), bound)


def _with_albedo(name: str) -> datasets.Preset:
    preset = datasets.get(name)
    if "albedo" not in preset.conditions:
        raise NoInfluenceError(f"dataset {name} has no condition 'albedo'")
    return preset


def _is_cube(sensor: FaceSensor) -> bool:
    axes = np.repeat(np.eye(3), 2, axis=0) * np.tile([1.0, -1.0], 3)[:, None]
    return len(sensor.normals) == 6 and bool(np.allclose(sensor.normals, axes))


@dataclass(frozen=True)
class Patches:
    """The visible Earth cut up: directions (P, 3) and irradiance (P,) across each of them."""

    directions: Floats
    light: Floats


def lit_patches(
    earth: Earth, sun: Floats, nadir: Floats, rings: int = 64, spokes: int = 192
) -> Patches:
    """Cut the visible, sunlit Earth into patches for one sample's Sun and nadir (3,).

    Light is in units of mean sunlight at normal incidence: Lambert radiance
    ``reflectance cos(sun zenith) / pi`` times the patch's solid angle. Patches are equally wide in
    the cosine of the nadir angle and in azimuth, each taken at its middle.
    """
    edge = math.cos(math.radians(earth.half_angle_deg))
    cosine = 1.0 - (1.0 - edge) * (np.arange(rings) + 0.5) / rings
    sine = np.sqrt(1.0 - cosine**2)
    turns = math.tau * (np.arange(spokes) + 0.5) / spokes
    first, second = (axis[0] for axis in tangent_axes(nadir[None, :]))
    around = np.cos(turns)[:, None] * first + np.sin(turns)[:, None] * second
    sight = (cosine[:, None, None] * nadir + sine[:, None, None] * around).reshape(-1, 3)
    centre = earth.radius_km + earth.altitude_km
    half = np.repeat(centre * cosine, spokes)
    distance = half - np.sqrt(np.maximum(half**2 - centre**2 + earth.radius_km**2, 0.0))
    ground = (distance[:, None] * sight - centre * nadir) / earth.radius_km
    lit = np.maximum(ground @ sun, 0.0)
    solid_angle = math.tau * (1.0 - edge) / (rings * spokes)
    seen = lit > 0
    return Patches(sight[seen], earth.reflectance / math.pi * lit[seen] * solid_angle)


def aperture_earthlight(
    sensor: FrameSensor, patches: Patches, origin_px: NDArray[np.int64]
) -> Floats:
    """(H, W) irradiance of Earth on a window's pixels, in units of mean normal sunlight.

    Earth is an extended source: every patch throws its own displaced image of the aperture, as
    every point of the Sun does, weighted by its irradiance and the cosine of incidence. Approximate
    in that a patch (1 to 3 deg wide) counts as a point, a fraction of the aperture's own 9.5 deg
    seen from the detector.
    """
    from benchmark.simulator.kernels.rasteriser import render  # noqa: PLC0415 - Numba on demand

    camera, detector = sensor.camera, sensor.detector
    head = camera.assembly.to_head(patches.directions)
    point = replace(camera, sun=replace(camera.sun, diameter_deg=0.0))
    front = head[:, 2] > 0.05
    light = point.project(patches.directions[front])
    pitch = detector.pitch_mm
    columns, rows = sensor.window_px
    first = origin_px - 0.5 - np.asarray(detector.centre_px)
    reach = max(max(a.width_mm, a.height_mm) for a in camera.mask.apertures) / pitch
    place = light.rims_mm[0, :, 0] / pitch - first
    near = np.all((place > -reach) & (place < np.array([columns, rows]) + reach), axis=1)
    flux = np.zeros((1, rows, columns))
    render(
        flux,
        camera.mask.table(pitch),
        light.rims_mm[:, near, 0][:, None] / pitch,
        (light.light[near, 0] * patches.light[front][near])[None, :],
        first[None, :],
    )
    return np.asarray(flux[0])


def _is_one_hole(sensor: FrameSensor) -> bool:
    """Say whether there is one spot: a slit's light has a centre in one direction only."""
    apertures = sensor.camera.mask.apertures
    return len(apertures) == 1 and apertures[0].width_mm < 2.0 * apertures[0].height_mm < (
        4.0 * apertures[0].width_mm
    )


def on_aperture(
    name: str = "cmos-single-aperture",
    samples: int | None = None,
    extractor: Extractor | None = None,
    earth: Earth | None = None,
) -> Influence:
    """Move the centroid behind one aperture by Earth's light, for the same random positions.

    The spot is that of the thresholded centroid, the Earth that of ``pd-maskless-cube``, unless
    others are given.
    """
    preset = datasets.get(name)
    sensor = preset.condition("nominal").sensor
    if not isinstance(sensor, FrameSensor) or not _is_one_hole(sensor):
        raise NoInfluenceError(f"dataset {name} has no pixel array behind one aperture")
    geometry = preset.geometry
    geometry.require("focal_length_mm", "pixel_pitch_mm", by="albedo_influence")
    scene = preset.scene("nominal", "test")
    scene = scene.part(0, len(scene) if samples is None else samples)
    if scene.origin_px is None or isinstance(scene, TimedScene):
        raise NoInfluenceError(f"dataset {name} has no window at random directions of the Sun")
    pattern = preset.fixed_pattern("nominal")
    reader = ThresholdedCentroid.for_sensor(geometry) if extractor is None else extractor
    seen = earth or datasets.get("pd-maskless-cube").condition("albedo").earth or Earth()
    nadir = seen.draw_nadir(scene.sun, generator(name, preset.version, "test", "nadir"))
    detector, (columns, rows) = sensor.detector, sensor.window_px
    spots = np.empty((2, len(scene), 2))
    for n in range(len(scene)):
        one = scene.part(n, n + 1)
        x, y = np.asarray(one.origin_px)[0]
        frame = sensor.expected(one, pattern)
        spots[0, n] = reader.extract(frame)[0]
        patches = lit_patches(seen, one.sun[0], nadir[n])
        light = aperture_earthlight(sensor, patches, np.array([x, y]))
        gain = pattern["gain"][y : y + rows, x : x + columns]
        frame = frame + detector.sunlit_e * one.irradiance[0] * light * gain / (
            detector.gain_e_per_dn
        )
        spots[1, n] = reader.extract(frame)[0]
    # from spots to directions by the nominal pinhole: only their difference counts
    scale = (geometry.pixel_pitch_mm or math.nan) / (geometry.focal_length_mm or math.nan)
    offset = np.asarray(scene.origin_px) - np.asarray(detector.centre_px)
    sight = np.concatenate([scale * (spots + offset), np.ones((2, len(scene), 1))], axis=2)
    sight /= np.sqrt(np.sum(sight**2, axis=2, keepdims=True))
    bound = cramer_rao(sensor, scene, pattern, preset.condition("nominal").irradiance).angle_deg
    return Influence(separation_deg(sight[0], sight[1]), bound)
