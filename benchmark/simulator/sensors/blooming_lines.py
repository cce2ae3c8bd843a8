"""Linear CCDs whose saturated pixels spill charge along the line: `BloomingLineSensor`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.readout.noise import NoiseStreams, draw_counts
from benchmark.simulator.readout.quantisation import ROUNDING, charge_variance
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.blooming import spill
from benchmark.simulator.sensors.line_sensor import LineSensor


@dataclass(frozen=True)
class BloomingLineSensor(LineSensor):
    """A `LineSensor` of CCDs without anti-blooming drains.

    What a pixel holds too much flows to its neighbours on either side, half and half, until there
    is room for it or the line ends (`spill`). The converter must reach the full well.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        detector = self.detector
        top = (detector.full_scale_dn - detector.offset_dn) * detector.gain_e_per_dn
        if top < detector.full_well_e:
            raise ValueError(
                f"the converter must reach the full well of {detector.full_well_e:g} electrons; it "
                f"ends at {top:g}"
            )

    def held(self, charge: Floats) -> tuple[Floats, Floats]:
        """Charges (N, W) after spilling, and (N, arrays) what left the ends of each array."""
        lines = charge.reshape(-1, self.detector.columns, 1)
        held, drained = spill(lines, self.detector.full_well_e)
        return held.reshape(charge.shape), drained.reshape(len(charge), len(self.axes))

    def picture(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, W) digital numbers of the mean electrons: no noise, no rounding."""
        held, _ = self.held(self._electrons(scene, pattern))
        held = self._amplify(held, pattern)
        return np.asarray(self.detector.offset_dn + held / self.detector.gain_e_per_dn)

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, W + arrays) charges that determine the profile, electrons.

        Every pixel's own charge, cut at the full well, then each array's overflow: the profile is
        made of these alone where one run of pixels overflows, so no estimator can know more than
        they tell. Pixels at the full well do not change and tell nothing.
        """
        full = self.detector.full_well_e
        charge = self._electrons(scene, pattern)
        lines = charge.reshape(len(scene), len(self.axes), self.detector.columns)
        over = np.sum(np.maximum(lines - full, 0.0), axis=2)
        return np.concatenate([np.minimum(charge, full), over], axis=1)

    def variance(self, expected: Floats) -> Floats:
        """Squared electrons: shot noise of the charges, read noise, what rounding costs.

        An overflow has the shot noise of all charge in the saturated pixels, and the read noise of
        the two pixels in which its trail ends.
        """
        detector, arrays = self.detector, len(self.axes)
        charges = np.maximum(expected, 0.0)
        variance = self._pixel_variance(charges)
        single = detector.read_noise_e**2 + detector.gain_e_per_dn**2 * ROUNDING
        lines = expected[:, :-arrays].reshape(len(expected), arrays, detector.columns)
        full = np.sum(lines >= detector.full_well_e, axis=2)
        over = charges[:, -arrays:] + full * detector.full_well_e
        variance[:, -arrays:] = over + 2.0 * single
        return np.asarray(variance)

    def _pixel_variance(self, charge: Floats) -> Floats:
        """Squared electrons of charge that is read by amplifiers that may bend it."""
        detector, errors = self.detector, self.detector.errors
        if not (errors.nonlinearity or errors.column_noise_e):
            return charge_variance(detector, charge, charge)
        charge = np.minimum(charge, detector.full_well_e)
        bent = errors.slope(charge, detector.full_well_e)
        read = errors.read(charge, detector.full_well_e)
        # read noise is bent with the signal, what amplifiers add behind it is not
        shot = bent**2 * charge + errors.column_noise_e**2
        shot -= (1.0 - bent**2) * detector.read_noise_e**2
        return np.asarray(charge_variance(detector, read, shot) / bent**2)

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> None:
        """None: an overflow is of many pixels together (the arguments are the protocol's)."""

    def observe(
        self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams
    ) -> NDArray[np.uint16]:
        """(N, W) uint16 digital numbers with trails on either side of what is saturated."""
        detector = self.detector
        mean = self._electrons(scene, pattern)
        charge, read = np.empty_like(mean), np.empty(mean.shape, dtype=np.float32)
        for n in range(len(scene)):  # one by one: a sample's randomness is drawn in one run
            charge[n] = draw_counts(mean[n], 0.0, streams)
            read[n] = streams.gaussian.standard_normal(mean.shape[1], dtype=np.float32)
        held, _ = self.held(charge)
        held += read * detector.read_noise_e
        held = self._amplify(held, pattern)
        if detector.errors.column_noise_e:
            held += streams.column_noise(detector.errors.column_noise_e, held.shape)
        values = np.rint(detector.offset_dn + held / detector.gain_e_per_dn)
        return np.clip(values, 0, detector.full_scale_dn).astype(np.uint16)
