"""Currents of photodiodes behind a code dial with coarse and fine rows: `CodeDialSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.memory import digest_of
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.diffraction_tables import landing_points, layers
from benchmark.simulator.optics.earthlight import EarthInView, on_elements
from benchmark.simulator.optics.edge_light import REFERENCE_NM, light_across_edge
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.projection import Camera, ProjectedLight
from benchmark.simulator.readout.currents import CurrentSensor, currents, element_gains
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.line_sensor import LineAxis

#: Sine of the widest incidence that diffraction is worked out for.
_WIDEST_SINE = 0.9998
FineRows = Literal["sine", "square"]


@dataclass(frozen=True)
class CodeDial:
    """Tracks side by side across the dial, a photodiode behind each (Fan2013).

    `bits` coarse tracks carry the Gray code of the cell, most significant bit first; then come
    the fine rows F1..F4 in quadrature (eq:fourier): behind a narrow slit at u they pass
    ``(1 - cos p)/2, (1 - sin p)/2, (1 + cos p)/2, (1 + sin p)/2`` with ``p = 2 pi u / period``,
    so that ``p = atan2(F4 - F2, F3 - F1)``. u counts from the dial's middle.

    Attributes
    ----------
    bits, cell_mm
        ``2^bits`` cells of equal length; beyond them the dial is opaque.
    period_mm
        Of the fine rows.
    track_height_mm, track_pitch_mm
        Height of each track, and distance from one to the next.
    fine_rows
        ``sine``: outlines that pass one harmonic only, as the ideal output has; ``square``: plain
        windows of half a period, whose output has all odd harmonics.
    track_error_mm
        Standard deviation over tracks of each built pattern's displacement along the dial.
    """

    bits: int
    cell_mm: float
    period_mm: float
    track_height_mm: float
    track_pitch_mm: float
    fine_rows: FineRows = "sine"
    track_error_mm: float = 0.0

    def __post_init__(self) -> None:
        if not 1 <= self.bits <= 16:
            raise ValueError(f"bits must be in [1, 16]; got {self.bits}")
        if not (self.cell_mm > 0 and self.period_mm > 0):
            raise ValueError("cell_mm and period_mm must be positive")
        if not 0 < self.track_height_mm <= self.track_pitch_mm:
            raise ValueError("track_height_mm must be above 0 and at most track_pitch_mm")
        if self.fine_rows not in {"sine", "square"}:
            raise ValueError(f"fine_rows must be 'sine' or 'square'; got {self.fine_rows!r}")

    @property
    def tracks(self) -> int:
        """Coarse and fine ones together."""
        return self.bits + 4

    @property
    def reach_mm(self) -> float:
        """From the dial's middle to either end."""
        return self.cell_mm * 2.0**self.bits / 2.0

    def gray(self) -> NDArray[np.int64]:
        """(bits, cells) what the coarse tracks show: 1 open, 0 opaque."""
        number = np.arange(2**self.bits)
        code = number ^ (number >> 1)
        return np.array([(code >> bit) & 1 for bit in reversed(range(self.bits))])

    def table(self, shifts_mm: Floats) -> Floats:
        """(T, 4 + cells + 1) as `dial_kernel.read_dial` wants it, patterns moved by `shifts_mm`."""
        table = np.zeros((self.tracks, 5 + 2**self.bits))
        table[self.bits :, 0] = (1.0, 2.0, 3.0, 4.0)
        table[:, 1] = (np.arange(self.tracks) - (self.tracks - 1) / 2.0) * self.track_pitch_mm
        table[:, 2] = self.track_height_mm / 2.0
        table[:, 3] = shifts_mm
        table[: self.bits, 5:] = np.cumsum(self.gray(), axis=1) * self.cell_mm
        return table


@dataclass(frozen=True)
class CodeDialSensor(CurrentSensor):
    """One code dial an axis, each under its own slit.

    Attributes
    ----------
    camera
        Light; its mask is the slit, in a dial's own coordinates: x along the dial (u), y across
        it (v); for a dial along the detector's y axis they are swapped.
    dial
        Of every axis.
    readout
        ``sunlit_ua`` is the current of a track without pattern.
    axes
        Along which axis each dial lies, in the order of the currents.
    deflection_deg
        Rotation of the slits against the dials, from x towards y: light of the slit falls
        further along on tracks further across.
    spectrum
        Of light that diffracts at the slit's edges, or None for geometric light.
    ghost
        Light reflected between each dial and its slit, or None; the same from open and opaque
        parts of a dial.
    """

    camera: Camera
    dial: CodeDial
    readout: CurrentReadout
    axes: tuple[LineAxis, ...] = ("x", "y")
    deflection_deg: float = 0.0
    spectrum: Spectrum | None = None
    ghost: Ghost | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        apertures = self.camera.mask.apertures
        if len(apertures) != 1 or apertures[0].shape != "rectangle":
            raise ValueError("a code dial has one rectangular slit")
        if not self.axes or any(axis not in {"x", "y"} for axis in self.axes):
            raise ValueError(f"axes must be 'x' or 'y', one a dial; got {self.axes}")

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` and ``shift_mm`` (K,): gains of the channels, displacements of the patterns."""
        count = self.dial.tracks * len(self.axes)
        shifts = generator(*names, "tracks").standard_normal(count)
        return {
            "gain": element_gains(self.readout, count, *names),
            "shift_mm": self.dial.track_error_mm * shifts,
        }

    def lit(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) light behind the tracks in units of what the slit gives an open one at noon."""
        lit = self._behind(self.camera.project(scene.sun), scene, pattern, self._diffraction(scene))
        if self.ghost is not None:
            sharp = np.empty(0), np.empty((len(scene), 2))
            lit += self._behind(self.ghost.project(self.camera, scene.sun), scene, pattern, sharp)
        return lit

    def _behind(
        self,
        projected: ProjectedLight,
        scene: Scene,
        pattern: FixedPattern,
        diffraction: tuple[Floats, Floats],
    ) -> Floats:
        """(N, K) what of the slit's light is behind the tracks."""
        from benchmark.simulator.kernels.dial import read_dial  # noqa: PLC0415 - Numba on demand

        light = projected.light * scene.irradiance[:, None]
        slit = self.camera.mask.table()[0]
        count = self.dial.tracks
        edge, scales = diffraction
        out = np.empty((len(scene), count * len(self.axes)))
        for number, axis in enumerate(self.axes):
            # swapped axes see the slit turn the other way
            side = 1.0 if axis == "x" else -1.0
            turn = math.radians(self.camera.mask.apertures[0].rotation_deg)
            turn += side * math.radians(self.deflection_deg)
            numbers = np.array(
                [
                    self.dial.period_mm,
                    self.dial.cell_mm,
                    1.0 if self.dial.fine_rows == "square" else 0.0,
                    *slit[1:5],
                    math.cos(turn),
                    math.sin(turn),
                ]
            )
            rims = projected.rims_mm
            if axis == "y":
                rims = np.ascontiguousarray(rims[..., ::-1])
            part = np.empty((len(scene), count))
            columns = slice(number * count, (number + 1) * count)
            table = self.dial.table(pattern["shift_mm"][columns])
            unit = np.ascontiguousarray(scales[:, 0 if axis == "x" else 1])
            read_dial(part, table, (rims, light), numbers, (edge, unit))
            out[:, columns] = part / self.camera.mask.apertures[0].width_mm
        return out

    def _diffraction(self, scene: Scene) -> tuple[Floats, Floats]:
        """Table of light past an edge for the kernel, and (N, 2) its unit along x and y, mm.

        ``sqrt(lambda J / 2)`` with J the part of `landing_points`'s along the axis, for the Sun's
        centre.
        """
        if self.spectrum is None:
            return np.empty(0), np.empty((len(scene), 2))
        camera = self.camera
        head = camera.assembly.to_head(scene.sun)
        square = np.minimum(head[:, 0] ** 2 + head[:, 1] ** 2, _WIDEST_SINE**2)
        landed = landing_points(np.sqrt(square), layers(camera.height_mm, camera.glass))
        bend = (landed[:, 1] - landed[:, 2]) / np.maximum(square, 1e-12)
        spread = landed[:, 2:] + bend[:, None] * head[:, :2] ** 2
        table, steps = light_across_edge(self.spectrum)
        return np.append(table, steps), np.sqrt(REFERENCE_NM * 1e-6 * spread / 2.0)

    def receive(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) all light: direct, stray and from the Earth; units as of `lit`."""
        response = self.lit(scene, pattern) + scene.stray[:, None]
        if scene.albedo is not None:
            response += scene.albedo
        return np.asarray(response)

    def earth_through(
        self, earth: Earth, nadir: Floats, scene: Scene, pattern: FixedPattern
    ) -> Floats:
        """(N, K) light of the Earth, as `lit` has that of the Sun; for nadir (N, 3)."""

        def lit(camera: Camera, sky: Scene) -> Floats:
            return replace(self, camera=camera, spectrum=None).lit(sky, pattern)

        unit = self, *(digest_of(np.asarray(pattern[name])) for name in sorted(pattern))
        return on_elements(self.camera, lit, EarthInView(earth, nadir, scene.sun), unit)

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean microamperes."""
        return currents(self.readout, self.receive(scene, pattern), pattern)
