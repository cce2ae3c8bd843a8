"""Light that families share: how much there is, how it reaches the detector, and why that will do.

The last is a card's `regime`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.optics.plates import CoverGlass, Plate

#: Unfiltered, with a little that is scattered.
LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)
#: A cover on the detector, wherever there is one.
GLASS = CoverGlass((Plate(0.5, 1.52),))

#: Of sensors without a mask.
NOTHING_SHADES: Mapping[str, Any] = {
    "propagation": "geometric",
    "reason": "nothing casts a shadow",
}


def measured_geometric(percent: float, bound_ratios: tuple[float, float, float]) -> dict[str, Any]:
    """Return the regime of currents that diffraction hardly changes, with what was measured.

    Parameters
    ----------
    percent
        Largest difference of a current to that in diffracted light over the field, of full light.
    bound_ratios
        The bound in diffracted light over the geometric one on the boresight, half way to the
        field's edge along x, and there.

    Raises
    ------
    ValueError
        When it is 1 % or more: then light has to be diffracted.
    """
    if not 0 <= percent < 1.0:
        raise ValueError(f"currents of shadows will do within 1 % of full light; got {percent} %")
    centre, half, edge = bound_ratios
    return {
        "propagation": "geometric",
        "largest_difference_percent": percent,
        "bound_ratio": {"boresight": centre, "half_field": half, "field_edge": edge},
        "reason": "currents of a point Sun in Fresnel diffraction over the spectrum of silicon in "
        "sunlight differ by less than 1 % of full light all over the field",
    }
