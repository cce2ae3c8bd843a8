"""Processors on spacecraft and how much slower they are than the machine of the published times.

Estimates from CoreMark, which does integer arithmetic on one core: a processor without
double-precision hardware, such as a Cortex-M4, takes longer than estimated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

#: CoreMark of the machine of the published times, measured there on 2026-11-28: one core, version
#: 1.0 compiled by GCC 12.2.0 with -O3.
REFERENCE_COREMARK = 19869.0


@dataclass(frozen=True)
class Processor:
    """A processor.

    Attributes
    ----------
    name
        Chip or board, core and clock.
    coremark
        Iterations per second on one core.
    source
        Where the figure is from.
    """

    name: str
    coremark: float
    source: str

    @property
    def factor(self) -> float:
        """Time of a calculation as a multiple of that on the machine of the published times."""
        return float(f"{REFERENCE_COREMARK / self.coremark:.2g}")


_IBRAHIM = (
    "Ibrahim, ARM-Based Microcontroller Projects Using mbed (2019), table 3.2: {:g} CoreMark/MHz"
)
_FM4DD = "github.com/fm4dd/sbc-benchmarks, cm-benchmark.md (2017)"

PROCESSORS: Mapping[str, Processor] = MappingProxyType(
    {
        "zynq-7000": Processor(
            "AMD Zynq-7000, Cortex-A9 at 667 MHz", 4.15 * 667, _IBRAHIM.format(4.15)
        ),
        "beaglebone-black": Processor("BeagleBone Black, Cortex-A8 at 1 GHz", 2497.0, _FM4DD),
        "raspberry-pi-zero": Processor("Raspberry Pi Zero W, ARM11 at 1 GHz", 2084.0, _FM4DD),
        "imx-rt1060": Processor(
            "NXP i.MX RT1060, Cortex-M7 at 600 MHz",
            2393.83,
            "github.com/Masmiseim36/Coremark_iMXRT, -O3",
        ),
        "samv71": Processor(
            "Microchip SAMV71, Cortex-M7 at 300 MHz", 5.01 * 300, _IBRAHIM.format(5.01)
        ),
        "stm32f4": Processor("ST STM32F4, Cortex-M4 at 168 MHz", 3.4 * 168, _IBRAHIM.format(3.4)),
    }
)


def is_processor(processor: str | float | None) -> bool:
    """Whether `factor` knows the processor: None, a name of `PROCESSORS` or a positive number."""
    return _factor(processor) is not None


def factor(processor: str | float | None) -> float:
    """Return its time as a multiple of that on the machine of the published times.

    Parameters
    ----------
    processor
        A name of `PROCESSORS`, the multiple itself, or None for that machine.

    Raises
    ------
    ValueError
        For anything else.
    """
    found = _factor(processor)
    if found is None:
        known = ", ".join(PROCESSORS)
        raise ValueError(f"expected one of {known}, or a positive number, not {processor!r}")
    return found


def _factor(processor: str | float | None) -> float | None:
    if processor is None:
        return 1.0
    if isinstance(processor, str) and processor in PROCESSORS:
        return PROCESSORS[processor].factor
    try:
        number = float(processor)
    except ValueError:
        return None
    return number if 0 < number < math.inf else None
