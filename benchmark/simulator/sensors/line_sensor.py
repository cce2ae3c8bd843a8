"""Profiles of linear arrays behind slits: `LineSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.memory import memory
from benchmark.simulator.light.stray_slope import slope
from benchmark.simulator.masks.slits import SlitErrors
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.diffraction_tables import layers
from benchmark.simulator.optics.earthlight import EarthInView, add_between, on_array
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.optics.slit_diffraction import SlitProfiles
from benchmark.simulator.readout.detectors import PixelArray, tunnel_response
from benchmark.simulator.readout.noise import NoiseStreams, draw_counts
from benchmark.simulator.readout.pixels import PixelSensor
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern

LineAxis = Literal["x", "y"]
#: Lines along an array on which ghosts of slits are worked out that slant by more than this sine.
_LINES, _UPRIGHT = 8, 0.02


@dataclass(frozen=True)
class LineSensor(PixelSensor):
    """One or two linear arrays, each behind slits of the same layout.

    Attributes
    ----------
    camera
        Light. The mask is written in each array's own coordinates: x along the array (u), y
        across it (v); for an array along the detector's y axis they are swapped. Every array
        sees its own slits only, as behind separate slots or a baffle.
    detector
        One array: ``rows`` is 1, ``columns`` its pixels, ``pitch_mm`` their distance.
    axes
        Along which detector axis each array lies, in the order of the profile's columns.
    pixel_height_mm
        Of the pixels, across the array.
    fill_factor
        Sensitive share of the pitch.
    errors
        How the plate with the slits stands over the arrays.
    spectrum
        Of the light, as the pixels detect it; None for light that does not diffract.
    ghost
        Light reflected between each array and its slits, or None.

    Raises
    ------
    ValueError
        On more than one row of pixels, on openings that are no slits, and sizes out of range.
    """

    camera: Camera
    detector: PixelArray
    pixel_height_mm: float
    axes: tuple[LineAxis, ...] = ("x", "y")
    fill_factor: float = 1.0
    errors: SlitErrors = field(default_factory=SlitErrors)
    spectrum: Spectrum | None = SUNLIT_SILICON
    ghost: Ghost | None = field(default=None, kw_only=True)
    sees_slopes: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if self.detector.rows != 1:
            raise ValueError(f"a linear array has one row of pixels; got {self.detector.rows}")
        if not self.axes or any(axis not in {"x", "y"} for axis in self.axes):
            raise ValueError(f"axes must be 'x' or 'y', one an array; got {self.axes}")
        if not self.pixel_height_mm > 0:
            raise ValueError(f"pixel_height_mm must be positive; got {self.pixel_height_mm}")
        if not 0 < self.fill_factor <= 1:
            raise ValueError(f"fill_factor must be in (0, 1]; got {self.fill_factor}")
        if any(aperture.shape != "rectangle" for aperture in self.camera.mask.apertures):
            raise ValueError("linear arrays are simulated behind rectangular slits only")

    @property
    def width_px(self) -> int:
        """Columns of a profile, all arrays together."""
        return self.detector.columns * len(self.axes)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` and ``dark_e``, (W,): the pixels' relative gain and dark signal.

        With ``column_e`` (W,) where their amplifiers have offsets.
        """
        return self.detector.built((self.width_px,), *names)

    def origins(self, sun: Floats, generator: np.random.Generator) -> None:
        """Nothing is windowed (the arguments are the protocol's)."""

    def _slits(self, axis: LineAxis) -> Floats:
        """`Mask.table` of one array in pixels, the plate turned by its deflection."""
        table = self.camera.mask.table(self.detector.pitch_mm)
        turn = math.radians(self.errors.deflection_deg)
        c, s = math.cos(turn), math.sin(turn)
        if axis == "y":  # swapped axes see the plate turn the other way
            s = -s
        x, y, cosine, sine = (table[:, column].copy() for column in (1, 2, 5, 6))
        table[:, 1], table[:, 2] = c * x - s * y, s * x + c * y
        table[:, 5], table[:, 6] = c * cosine - s * sine, s * cosine + c * sine
        return table

    def lit(self, scene: Scene) -> Floats:
        """(N, W) irradiance averaged over each pixel, in units of mean normal sunlight.

        This is the rendering itself: no fixed pattern, no noise, no stray light.
        """
        detector = self.detector
        pixels = detector.columns, detector.pitch_mm, self.pixel_height_mm, self.fill_factor
        key = (type(self).__name__, self.camera, pixels, self.axes, self.errors, self.spectrum)
        suns, ghost = scene.sun.tobytes(), self.ghost
        flux = memory.render((*key, suns), lambda: self._render(scene.sun))
        if ghost is not None:
            flux += memory.render((*key, ghost, suns), lambda: self._ghosts(scene.sun, ghost))
        flux *= scene.irradiance[:, None]
        if detector.tunnel:
            cosine = self.camera.assembly.to_head(scene.sun)[:, 2]
            flux *= tunnel_response(cosine, detector.tunnel)[:, None]
        return flux

    def _render(self, sun: Floats) -> Floats:
        """(N, W) light of the mean sunlight from (N, 3)."""
        flux = np.empty((len(sun), self.width_px))
        if self.spectrum is None:
            self._cast_shadows(flux, sun)
        else:
            self._diffract(flux, sun, self.spectrum)
        return flux

    def _diffract(self, flux: Floats, sun: Floats, spectrum: Spectrum) -> None:
        """Fill `flux` with diffracted light."""
        camera, pitch, columns = self.camera, self.detector.pitch_mm, self.detector.columns
        head = camera.assembly.to_head(sun)
        offset = camera.assembly.offset_x_mm / pitch, camera.assembly.offset_y_mm / pitch
        tilt = math.radians(self.errors.inclination_deg)
        for number, axis in enumerate(self.axes):
            turned = np.ascontiguousarray(head if axis == "x" else head[:, [1, 0, 2]])
            plate = (
                math.cos(tilt),
                math.sin(tilt),
                camera.mask.thickness_mm / pitch,
                *(offset if axis == "x" else offset[::-1]),
                self.pixel_height_mm / pitch / 2.0,
            )
            profiles = SlitProfiles(
                slits=self._slits(axis),
                layers=layers(camera.height_mm, camera.glass) / np.array([pitch, 1.0]),
                sun=camera.sun,
                spectrum=spectrum,
                pitch_mm=pitch,
                plate=plate,
            )
            part = profiles.light(turned, columns, self.fill_factor)
            flux[:, number * columns : (number + 1) * columns] = part

    def _cast_shadows(self, flux: Floats, sun: Floats) -> None:
        """Fill `flux` with light that does not diffract."""
        from benchmark.simulator.kernels.lines import expose  # noqa: PLC0415 - Numba on demand

        pitch, columns = self.detector.pitch_mm, self.detector.columns
        projected = self.camera.project(sun)
        light = projected.light
        lower, upper = projected.rims_mm
        tangents = np.zeros_like(lower)
        tilt = math.radians(self.errors.inclination_deg)
        if tilt != 0.0:
            points = self.camera.sun.directions(self.camera.assembly.to_head(sun))
            tangents = points[..., :2] / np.maximum(points[..., 2:], 1e-6)
        half_height = self.pixel_height_mm / pitch / 2.0
        numbers = -columns / 2.0, half_height, self.fill_factor, math.cos(tilt), math.sin(tilt)
        for number, axis in enumerate(self.axes):
            along = np.stack([lower / pitch, upper / pitch, tangents])
            if axis == "y":
                along = np.ascontiguousarray(along[..., ::-1])
            if tilt != 0.0:
                self._tilt(along, tilt)
            part = np.empty((len(sun), columns))
            expose(part, self._slits(axis), along, light, numbers)
            flux[:, number * columns : (number + 1) * columns] = part

    def _ghosts(self, sun: Floats, ghost: Ghost) -> Floats:
        """(N, W) light of the mean sunlight that comes a second time.

        The plate's inclination is left out.
        """
        from benchmark.simulator.kernels.line_ghosts import add_ghosts  # noqa: PLC0415 - Numba on demand

        pitch, columns = self.detector.pitch_mm, self.detector.columns
        near, far, light = ghost.paths(self.camera, sun)
        paths = np.stack([near, far]) / pitch
        numbers = -columns / 2.0, self.fill_factor, 1.0 if ghost.surface == "mask" else 0.0
        parts = []
        for axis in self.axes:
            slits = self._slits(axis)
            part = np.zeros((len(sun), columns))
            along = np.ascontiguousarray(paths if axis == "x" else paths[..., ::-1])
            # what slants crosses many pixels over the array's height
            count = _LINES if np.abs(slits[:, 6]).max() > _UPRIGHT else 1
            lines = ((np.arange(count) + 0.5) / count - 0.5) * (self.pixel_height_mm / pitch)
            add_ghosts(part, slits, (along, light), lines, numbers)
            parts.append(part)
        return np.concatenate(parts, axis=1)

    def _tilt(self, paths: Floats, tilt: float) -> None:
        """Let the plate's thickness stand along its own, tilted normal."""
        middle = (paths[0] + paths[1]) / 2.0
        thickness = self.camera.mask.thickness_mm / self.detector.pitch_mm
        through = thickness * (math.cos(tilt) * paths[2] - np.array([0.0, math.sin(tilt)]))
        paths[0], paths[1] = middle - through / 2.0, middle + through / 2.0

    def earth_through(
        self,
        earth: Earth,
        nadir: Floats,
        scene: Scene,
        pattern: FixedPattern,  # noqa: ARG002 - the protocol's
    ) -> Floats:
        """(N, A, P) irradiance from the Earth at points along each array, for nadir (N, 3).

        The first is the first pixel, the last the last one; profiles get what lies between. The
        plate's own errors are left out.
        """
        reach = (self.detector.columns - 1) * self.detector.pitch_mm
        view = EarthInView(earth, nadir, scene.sun)
        arrays = [on_array(self.camera, reach, view, swapped=axis == "y") for axis in self.axes]
        return np.stack(arrays, axis=1)

    def _places(self) -> Floats:
        """(W, 2) of the pixels, in units of half an array's length from its middle."""
        columns = self.detector.columns
        along = (np.arange(columns) - (columns - 1) / 2.0) / (columns / 2.0)
        zero = np.zeros(columns)
        return np.concatenate(
            [np.stack([along, zero] if axis == "x" else [zero, along], -1) for axis in self.axes]
        )

    def _electrons(self, scene: Scene, pattern: FixedPattern) -> Floats:
        electrons = self.lit(scene)
        if scene.albedo is not None:
            lines = electrons.reshape(len(scene) * len(self.axes), 1, -1)
            add_between(lines, scene.albedo.reshape(len(lines), 1, -1))
        electrons += slope(scene, self._places())
        if self.detector.errors.crosstalk:  # within an array
            arrays = electrons.reshape(-1, self.detector.columns)
            electrons = np.asarray(self.detector.errors.gather(arrays).reshape(electrons.shape))
        electrons *= self.detector.sunlit_e * pattern["gain"]
        electrons += pattern["dark_e"]
        return electrons

    def _amplify(self, electrons: Floats, pattern: FixedPattern) -> Floats:
        """Electrons (N, W) as the pixels' amplifiers show them, without their noise."""
        electrons = self.detector.errors.read(electrons, self.detector.full_well_e)
        return electrons + pattern["column_e"] if "column_e" in pattern else electrons

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, W) mean digital numbers before rounding."""
        detector = self.detector
        electrons = np.minimum(self._electrons(scene, pattern), detector.full_well_e)
        electrons = self._amplify(electrons, pattern)
        return np.asarray(detector.offset_dn + electrons / detector.gain_e_per_dn)

    def observe(
        self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams
    ) -> NDArray[np.uint16]:
        """(N, W) uint16 digital numbers."""
        detector = self.detector
        electrons = draw_counts(self._electrons(scene, pattern), detector.read_noise_e, streams)
        np.minimum(electrons, detector.full_well_e, out=electrons)
        electrons = self._amplify(electrons, pattern)
        if detector.errors.column_noise_e:
            electrons += streams.column_noise(detector.errors.column_noise_e, electrons.shape)
        values = np.rint(detector.offset_dn + electrons / detector.gain_e_per_dn)
        return np.clip(values, 0, detector.full_scale_dn).astype(np.uint16)
