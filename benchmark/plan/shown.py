"""What data sets show, as the registry needs it."""

from __future__ import annotations

import math
from collections.abc import Mapping

from algorithms.design import SensorGeometry
from benchmark.plan.parts import Parts, every_part
from registry.fidelity.purposes import DataSet


def data_sets(*, parts: Parts | None = None) -> Mapping[str, DataSet]:
    """Return conditions, columns, studies and design of every data set, by its name.

    Sensors of single studies among them, unless others are handed in.
    """
    return {
        name: DataSet(
            name,
            tuple(preset.conditions),
            frozenset(preset.context_columns),
            tuple(getattr(preset, "follows", ())),  # a card's field, and no part of the protocol
            {**design(preset.geometry), **getattr(preset, "drawn", {})}
            if hasattr(preset, "geometry")
            else {},
        )
        for name, preset in (parts or every_part()).presets.items()
    }


def design(drawn: SensorGeometry) -> dict[str, float | str]:
    """Return what a drawing says of a sensor, by the names of `registry.fidelity.evidence`."""
    found: dict[str, float | str | None] = {}
    if drawn.face_normals is not None:
        heights = sorted(normal[2] for normal in drawn.face_normals)
        found["faces"] = float(len(heights))
        if heights[0] == heights[-1] or math.isclose(heights[0], heights[-1]):
            found["layout"] = "pyramid"
            found["tilt_deg"] = math.degrees(math.acos(heights[0]))
        else:
            along = all(math.isclose(max(map(abs, n)), 1.0) for n in drawn.face_normals)
            found["layout"] = "cube" if along else "sphere"
    elif drawn.lens_distortion is None:
        many, slits = drawn.apertures or (), drawn.slits or ()
        widths = [width for *_, width in many or slits]
        width = drawn.aperture_width_mm or (sorted(widths)[len(widths) // 2] if widths else None)
        found["openings"] = float(len(many) or len(slits) or 1)
        found["opening_um"] = width and width * 1000.0
        found["height_mm"] = drawn.focal_length_mm
    found["subfields"] = drawn.subfields and float(drawn.subfields)
    found["pitch_um"] = drawn.pixel_pitch_mm and drawn.pixel_pitch_mm * 1000.0
    found["array_px"] = drawn.line_pixels and float(drawn.line_pixels)
    if drawn.centre_px is not None and not drawn.line_pixels:
        found["array_px"] = 2.0 * drawn.centre_px[0] + 1.0
    found["fov_deg"] = drawn.half_fov_deg and 2.0 * drawn.half_fov_deg
    return {name: value for name, value in found.items() if value is not None}
