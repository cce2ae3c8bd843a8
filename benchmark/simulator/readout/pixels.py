"""Readings of pixels as digital numbers: `PixelSensor`, the base of arrays of them."""

from __future__ import annotations

from collections.abc import Mapping

from algorithms.contract import Floats
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.quantisation import pixel_variance
from benchmark.simulator.readout.references import (
    References,
    pixel_references,
    pixel_unit_variance,
)
from benchmark.simulator.scene import Scene


class PixelSensor:
    """Pixels read out as digital numbers: the base of frozen dataclasses with this field."""

    detector: PixelArray

    def variance(self, expected: Floats) -> Floats:
        """Squared digital numbers: shot and read noise, and what rounding and clipping cost."""
        return pixel_variance(self.detector, expected)

    def unit_variance(
        self,
        expected: Floats,
        scene: Scene,  # noqa: ARG002 - the protocol's
        references: References,
    ) -> Floats | None:
        """Squared digital numbers that unknown gains and dark signals of the pixels add."""
        return pixel_unit_variance(self.detector, expected, references)

    def reference_readings(
        self, pattern: Mapping[str, Floats], references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_dn`` and ``flat_dn`` of all pixels: mean readings of the whole detector."""
        return pixel_references(self.detector, pattern, references, streams)
