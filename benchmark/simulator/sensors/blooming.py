"""A CCD whose saturated pixels spill charge along their columns: `spill`, `BloomingSensor`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.readout.noise import NoiseStreams, draw_counts
from benchmark.simulator.readout.quantisation import ROUNDING, charge_variance
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.lens_camera import LensCamera


def spill(charge: Floats, full_well: float) -> tuple[Floats, Floats]:
    """Let what exceeds the full well flow along the columns, half up and half down.

    Every pixel on the way keeps what it has room for; what reaches the end of a column leaves it.
    Where charge from above and from below compete for the same room, the mean of both orders of
    filling is taken, so that turning the frame over turns the result over.

    Parameters
    ----------
    charge
        (N, H, W) electrons; columns run along the second axis.
    full_well
        Largest charge of a pixel.

    Returns
    -------
    held
        (N, H, W), nowhere above `full_well`.
    drained
        (N, W) charge that left the columns; ``held`` and ``drained`` together are ``charge``.
    """
    held = np.minimum(charge, full_well)
    drained = np.zeros((charge.shape[0], charge.shape[2]))
    columns = np.nonzero((charge > full_well).any(axis=1))
    # (H, C): one row of all overflowing columns is contiguous
    start = np.ascontiguousarray(held[columns[0], :, columns[1]].T)
    half = (np.ascontiguousarray(charge[columns[0], :, columns[1]].T) - start) / 2.0
    rows = range(len(start))
    total, lost = np.zeros_like(start), np.zeros(start.shape[1])
    for order in ((rows, rows[::-1]), (rows[::-1], rows)):
        level = start.copy()
        for sweep in order:
            flow = np.zeros(start.shape[1])
            for row in sweep:
                taken = np.minimum(flow, full_well - level[row])
                level[row] += taken
                flow += half[row] - taken
            lost += flow / 2.0
        total += level / 2.0
    held[columns[0], :, columns[1]] = total.T
    drained[columns] = lost
    return held, drained


@dataclass(frozen=True)
class BloomingSensor:
    """A lens camera with a CCD without anti-blooming drains (fe:ht, Liu2016).

    Attributes
    ----------
    camera
        Lens and pixels; the converter must reach the full well.
    """

    camera: LensCamera

    def __post_init__(self) -> None:
        detector = self.camera.detector
        top = (detector.full_scale_dn - detector.offset_dn) * detector.gain_e_per_dn
        if top < detector.full_well_e:
            raise ValueError(
                f"the converter must reach the full well of {detector.full_well_e:g} electrons; it "
                f"ends at {top:g}"
            )

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain``, ``dark_e`` and ``alive`` of the pixels."""
        return self.camera.fixed_pattern(*names)

    def origins(self, sun: Floats, generator: np.random.Generator) -> NDArray[np.int64]:  # noqa: ARG002 - the protocol's
        """(N, 2) zeros: frames are whole."""
        return np.zeros((len(sun), 2), dtype=np.int64)

    def picture(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, H, W) digital numbers of the mean electrons: no noise, no rounding, clear sky."""
        charge = self.camera.photo_electrons(scene, pattern) + pattern["dark_e"]
        return self._numbers(charge, pattern)

    def _numbers(self, charge: Floats, pattern: FixedPattern) -> Floats:
        detector = self.camera.detector
        held, _ = spill(charge, detector.full_well_e)
        held *= pattern["alive"] / detector.gain_e_per_dn
        held += detector.offset_dn
        return held

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, H + 1, W) charges that determine the picture, electrons.

        Rows of every pixel's own charge, cut at the full well, then a row of the columns'
        overflow. The picture is made of these alone (the overflow of one run of saturated pixels
        goes where its sum says), so no estimator can know more than they tell; the pixels under
        a trail count as if it did not cover them. Pixels at the full well do not change and tell
        nothing.
        """
        full = self.camera.detector.full_well_e
        charge = self.camera.photo_electrons(scene, pattern)
        charge += pattern["dark_e"]
        over = np.sum(np.maximum(charge - full, 0.0), axis=1, keepdims=True)
        np.minimum(charge, full, out=charge)
        charge *= pattern["alive"]
        return np.concatenate([charge, over], axis=1)

    def variance(self, expected: Floats) -> Floats:
        """Squared electrons: shot noise of the charges, read noise, what rounding costs.

        The overflow has the shot noise of all charge in the saturated pixels, and the read noise
        of the two pixels in which its trail ends.
        """
        detector = self.camera.detector
        variance = charge_variance(detector, expected, expected)
        single = detector.read_noise_e**2 + detector.gain_e_per_dn**2 * ROUNDING
        full = np.sum(expected[:, :-1] >= detector.full_well_e, axis=1)
        variance[:, -1] = expected[:, -1] + full * detector.full_well_e + 2.0 * single
        return np.asarray(variance)

    def observe(
        self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams
    ) -> NDArray[np.uint16]:
        """(N, H, W) uint16 digital numbers with blooming columns."""
        detector = self.camera.detector
        shape = (len(scene), detector.rows, detector.columns)
        charge, read = np.empty(shape), np.empty(shape, dtype=np.float32)
        for n in range(len(scene)):  # one by one: a sample's randomness is drawn in one run
            one = scene.part(n, n + 1)
            light = self.camera.photo_electrons(one, pattern)[0]
            light += self.camera.cloud_electrons(one.sun, pattern, streams.gaussian)
            light += pattern["dark_e"]
            charge[n] = draw_counts(light, 0.0, streams)
            read[n] = streams.gaussian.standard_normal(shape[1:], dtype=np.float32)
        numbers = self._numbers(charge, pattern)
        numbers += read * (detector.read_noise_e / detector.gain_e_per_dn)
        np.rint(numbers, out=numbers)
        return np.clip(numbers, 0, detector.full_scale_dn).astype(np.uint16)
