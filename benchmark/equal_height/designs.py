"""Sensors that differ in their mask alone: one CMOS array, one height, one field.

Dimensions follow the standard data sets of the same masks. Where a mask is read by single lines,
these are lines of the same pixels. A mask whose light would leave the array within the field, or
whose parts would overlap, is no sensor there; the reason is said.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from benchmark.datasets.conditions import line_arrays as lines
from benchmark.datasets.conditions import many_spots as spots
from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.conditions.mission import with_flight
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.masks.coded import spacing_coded, subfield_pitch_mm
from benchmark.simulator.masks.layouts import grid, l_slit, slit
from benchmark.simulator.masks.slits import n_slit, slit_row, v_slit
from benchmark.simulator.sensors.line_sensor import LineAxis

#: The published comparison.
HEIGHT_MM, HALF_FOV_DEG = 0.5, 60.0
#: That of `cmos-slit` and `cmos-l-slit`.
DETECTOR = pixels.cmos(512, 0.012, sunlit_e=16_000.0)
#: As many for every mask; frames are rendered whole for some.
_STEPS, _TESTED = 13, 150
#: Of holes and slits, mm; light spreads by half as much again, and assembly moves it.
_WIDTH_MM, _MARGIN_MM, _FOIL_MM = 0.1, 0.1, 0.01
_VERSION = 1


class UnfitError(ValueError):
    """A mask cannot be built at this height and over this field."""


@dataclass(frozen=True)
class Place:
    """Height and half field, and how far the Sun's light moves within it.

    Raises
    ------
    UnfitError
        Where even one hole's spot would leave the array.
    """

    height_mm: float = HEIGHT_MM
    half_fov_deg: float = HALF_FOV_DEG

    def __post_init__(self) -> None:
        if not (self.height_mm > 0.0 and 0.0 < self.half_fov_deg < 90.0):
            raise UnfitError(
                "expected a height above 0 mm and a half field between 0 and 90 deg; got "
                f"{self.height_mm:g} mm and {self.half_fov_deg:g} deg"
            )
        if self.spare_mm < 0.0:
            raise UnfitError(
                f"light would leave the array: it moves by {self.shift_mm:.3g} mm and the array "
                f"has {self.shift_mm + self.spare_mm:.3g} mm on each side of its middle"
            )

    @property
    def shift_mm(self) -> float:
        """Shift of a spot along an axis at the edge of the field."""
        return self.height_mm * math.tan(math.radians(self.half_fov_deg))

    @property
    def spare_mm(self) -> float:
        """Room from a spot at the edge of the field to that of the array."""
        return 0.5 * DETECTOR.columns * DETECTOR.pitch_mm - self.shift_mm - _MARGIN_MM

    @property
    def field(self) -> AngleField:
        """The field of every sensor."""
        return AngleField(self.half_fov_deg, steps=_STEPS, test_samples=_TESTED)

    def require(self, reach_mm: float) -> None:
        """Raise UnfitError where openings so far off the middle throw light off the array."""
        if reach_mm > self.spare_mm:
            raise UnfitError(
                f"light would leave the array: it needs {reach_mm:.3g} mm beside the middle and "
                f"has {self.spare_mm:.3g} mm"
            )


@dataclass(frozen=True)
class Design:
    """A mask over the detector, and the standard data set whose pipelines it is read by."""

    mask: str
    dataset: str
    build: Callable[[str, Place], Preset]


def preset(name: str, place: Place) -> Preset:
    """Return a design as a data set with the conditions ``nominal`` and ``flight``.

    UnfitError where it cannot be built.
    """
    built = DESIGNS[name].build(f"equal-{name}", place)
    nominal = next(iter(built.setups))
    bare = dataclasses.replace(
        built, setups={nominal: built.setups[nominal]}, directions=place.field
    )
    return with_flight(bare)


def _single_aperture(name: str, place: Place) -> Preset:
    mask = pixels.hole(_WIDTH_MM, _FOIL_MM)
    known = {"aperture_width_mm": _WIDTH_MM, "aperture_shape": "round"}
    return _window(name, place, "Single-Ap.", mask, size=(64, 64), known=known)


def _slit(name: str, place: Place) -> Preset:
    length = 0.72
    place.require(length / 2.0)
    mask = slit(_WIDTH_MM, length, thickness_mm=_FOIL_MM)
    return _window(name, place, "Slit", mask, size=(64, 96), known={"aperture_width_mm": _WIDTH_MM})


def _l_slit(name: str, place: Place) -> Preset:
    line, length, gap = 0.3, 0.57, 0.1
    middle = -line + _WIDTH_MM / 2.0 + gap + length / 2.0
    place.require(middle + length / 2.0)
    mask = l_slit(_WIDTH_MM, -line, (middle, length), (middle, length), thickness_mm=_FOIL_MM)
    known = {
        "line_axes": ("x", "y"),
        "slits": ((-line, 0.0, _WIDTH_MM),),
        "mask_thickness_mm": _FOIL_MM,
    }
    return _window(name, place, "L-Slit", mask, size=(96, 96), known=known)


def _multi_aperture(name: str, place: Place) -> Preset:
    apart = 0.7
    rows = 1 + int(2.0 * place.spare_mm / apart)
    if rows < 2:
        raise UnfitError("no second hole fits whose spot stays on the array over the field")
    mask = grid(rows, rows, apart, Aperture("round", _WIDTH_MM, _WIDTH_MM), _FOIL_MM)
    return _many(name, place, "Multi-Ap.", mask)


def _encoded(name: str, place: Place) -> Preset:
    subfields = 3
    pitch = subfield_pitch_mm(subfields, place.half_fov_deg, place.height_mm)
    try:
        mask = spacing_coded(
            subfields,
            pitch_mm=pitch,
            diameter_mm=_WIDTH_MM,
            first_mm=2.0 * _WIDTH_MM,
            step_mm=0.25 * _WIDTH_MM,
            thickness_mm=_FOIL_MM,
        )
    except ValueError as error:
        raise UnfitError(str(error)) from error
    return _many(name, place, "Encoded", mask, subfields=subfields)


def _n_slit(name: str, place: Place) -> Preset:
    apart = place.shift_mm + 2.5 * _WIDTH_MM  # keeps the spots in order
    place.require(apart + place.shift_mm)  # slanted slits move by the sum of both shifts
    return _lines(name, place, "N-Slit", n_slit(apart, 45.0, **_spanning(place)), ("y",))


def _v_slit(name: str, place: Place) -> Preset:
    apart = place.shift_mm + 2.5 * _WIDTH_MM
    first = -(place.shift_mm + apart) / 2.0
    place.require(-first)
    mask = v_slit((first, first + apart), 45.0, **_spanning(place))
    return _lines(name, place, "V-Slit", mask, ("y",))


def _slit_lines(name: str, place: Place) -> Preset:
    mask = slit_row((0.0,), **_spanning(place))
    return _lines(name, place, "Slit", mask, ("x", "y"))


def _multi_slit(name: str, place: Place) -> Preset:
    places = (-1.1, -0.6, 0.0, 0.7, 1.5)
    place.require(max(places))
    return _lines(name, place, "Multi-Slit", slit_row(places, **_spanning(place)), ("x", "y"))


DESIGNS: Mapping[str, Design] = {
    "single-aperture": Design("Single-Ap.", "cmos-single-aperture", _single_aperture),
    "slit": Design("Slit", "cmos-slit", _slit),
    "l-slit": Design("L-Slit", "cmos-l-slit", _l_slit),
    "multi-aperture": Design("Multi-Ap.", "cmos-multi-aperture", _multi_aperture),
    "encoded": Design("Encoded", "cmos-encoded", _encoded),
    "n-slit": Design("N-Slit", "cmos-n-slit", _n_slit),
    "v-slit": Design("V-Slit", "ccd-v-slit", _v_slit),
    "slit-lines": Design("Slit", "ccd-slit", _slit_lines),
    "multi-slit": Design("Multi-Slit", "pda-multi-slit", _multi_slit),
}


def _spanning(place: Place) -> dict[str, float]:
    """Return slits so long that a line of pixels is lit all over the field."""
    length = 2.0 * (place.shift_mm + 4.0 * _MARGIN_MM)
    return {"width_mm": _WIDTH_MM, "length_mm": length, "thickness_mm": _FOIL_MM}


def _window(
    name: str,
    place: Place,
    mask_name: str,
    mask: Mask,
    *,
    size: tuple[int, int],
    known: Mapping[str, Any],
) -> Preset:
    sensor = pixels.window(mask, place.height_mm, DETECTOR, window_px=size)
    return pixels.windows(
        name=name,
        version=_VERSION,
        detector="CMOS",
        mask=mask_name,
        sensor=sensor,
        setups=pixels.pixel_conditions(sensor),
        geometry=pixels.design(sensor, place.half_fov_deg, **known),
        directions=place.field,
        follows=(),
        description="",
    )


def _many(name: str, place: Place, mask_name: str, mask: Mask, **known: Any) -> Preset:
    edge = math.tan(math.radians(place.half_fov_deg))
    corner = math.degrees(math.atan(math.sqrt(2.0) * edge))
    return spots.many_spots(
        name=name,
        version=_VERSION,
        detector="CMOS",
        mask=mask_name,
        sensor=spots.behind(mask, place.height_mm, DETECTOR, widest_deg=corner + 1.0),
        diameter_mm=_WIDTH_MM,
        half_fov_deg=place.half_fov_deg,
        directions=place.field,
        follows=(),
        description="",
        known=known,
    )


def _lines(
    name: str, place: Place, mask_name: str, mask: Mask, axes: tuple[LineAxis, ...]
) -> Preset:
    return lines.line_arrays(
        name=name,
        version=_VERSION,
        detector="CMOS",
        mask=mask_name,
        sensor=lines.behind(
            mask,
            place.height_mm,
            dataclasses.replace(DETECTOR, rows=1),
            axes=axes,
            sun=lines.SUN,
            pixel_height_mm=DETECTOR.pitch_mm,
        ),
        half_fov_deg=place.half_fov_deg,
        follows=(),
        description="",
    )
