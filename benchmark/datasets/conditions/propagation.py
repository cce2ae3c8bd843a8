"""Light that families share: how much there is, how it reaches the detector, and why that will do.

The last is a card's `regime`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.optics.plates import CoverGlass, Plate, fresnel_number

#: Unfiltered, with a little that is scattered.
LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)
#: A cover on the detector, wherever there is one.
GLASS = CoverGlass((Plate(0.5, 1.52),))

#: Of sensors without a mask.
NOTHING_SHADES: Mapping[str, Any] = {
    "propagation": "geometric",
    "reason": "nothing casts a shadow",
}


def geometric(
    width_mm: float, distance_mm: float, number: str = "a^2 / (lambda h)", far: str = ""
) -> dict[str, Any]:
    """Return the regime of an opening so wide that diffraction may be left out.

    Parameters
    ----------
    width_mm, distance_mm
        Of the narrowest opening, and from it to the detector.
    number, far
        The Fresnel number in words, and how it lies to 10 where "above" says too little.
    """
    return {
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(width_mm / 2.0, distance_mm), 2),
        "wavelength_nm": 550,
        "reason": f"{number} at normal incidence is {far}above 10; diffraction is left out",
    }


def measured(error_percent: float, field_deg: float) -> dict[str, Any]:
    """Return the regime of openings whose shadows were measured to do.

    Parameters
    ----------
    error_percent
        Largest `geometric_error` over the field, which a test measures again.
    field_deg
        Half the field it was measured over.

    Raises
    ------
    ValueError
        When it is 1 % or more: then light has to be diffracted.
    """
    if not 0 <= error_percent < 1.0:
        raise ValueError(
            f"shadows will do where they are within 1 % of the peak; got {error_percent} %"
        )
    return {
        "propagation": "geometric",
        "error_percent": error_percent,
        "field_deg": field_deg,
        "reason": "the geometric rendering differs from the diffracted one by less than 1 % of "
        "the peak over the whole field; diffraction is left out",
    }
