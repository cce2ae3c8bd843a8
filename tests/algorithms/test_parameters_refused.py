"""A parameter out of its range is refused by name and value; the ends of a range are taken."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, nan
from typing import Any

import pytest

from algorithms.discovery import discover_compensations, discover_extractors, discover_models

METHODS = {**discover_extractors(), **discover_models(), **discover_compensations()}
CUBE = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
#: A face missing, one twice, one askew, no vectors, none.
OTHER_BODIES = (CUBE[:5], (*CUBE[:5], CUBE[4]), (*CUBE[:5], (0.0, 0.6, -0.8)), ((1, 0),) * 6, ())
PYRAMID = ((0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (-0.6, 0.0, 0.8), (0.0, -0.6, 0.8))
FACES: dict[str, Any] = {"face_normals": CUBE}
HOLES: dict[str, Any] = {
    "apertures_px": ((0.0, 0.0, 5.0), (20.0, 0.0, 5.0), (0.0, 20.0, 5.0), (20.0, 24.0, 5.0))
}
LINES: dict[str, Any] = {"line_axes": ("x", "y"), "line_pixels": 64}
SLITS = {**LINES, "slits": ((0.0, 0.0, 6.0),), "reach_px": 20.0, "margin_px": 3.0}
PLANAR: dict[str, Any] = {"focal_length_mm": 2.0, "unit_mm": 0.5}
DIAL: dict[str, Any] = {"bits": 5, "cell_mm": 0.3, "period_mm": 0.6, "focal_length_mm": 2.5}
CODED = {
    **HOLES, "spots": 12, "focal_length_mm": 2.0, "pixel_pitch_mm": 0.01,
    "centre_px": (59.5, 59.5), "size_px": (120.0, 120.0),
}  # fmt: skip
SLANTED = {
    "focal_length_mm": 1.8, "pixel_pitch_mm": 0.01, "centre_px": (50.0, 50.0),
    "line_axes": ("y",), "slits": ((-3.3, 0.0, 0.1), (0.5, 45.0, 0.1)),
}  # fmt: skip
AXES = ((), ("x", "x"), ("u",))

#: Methods, what is given beside, and of each parameter what is refused.
REFUSED: tuple[tuple[str, dict[str, Any], dict[str, tuple[Any, ...]]], ...] = (
    ("bcm", {}, {"background": ("mode",), "window_px": (1,)}),
    ("bctm", {}, {"threshold": (-0.1, 1.0, 1.5, nan)}),
    ("ifm", {}, {"window_px": (4,)}),
    ("mt-acm", {}, {"accuracy_px": (0.0, nan), "lowest": (0.95,), "crossing": ("cubic",)}),
    ("tm", {"width_px": 3.0}, {"width_px": (0.0,), "shape": ("oval",), "threshold": (1.0,)}),
    ("gaussian-fit", {}, {"tolerance_px": (-1.0,), "iterations": (0,)}),
    ("gaussian-fit", {}, {"light": ("all",), "longest_px": (-1.0,)}),
    ("energy-filter", {}, {"significance": (0.0,), "fraction": (1.0,), "memory": (0,)}),
    ("bscm", {}, {"lowest": (0.95,), "highest": (1.0,), "loops": (0,), "survival": (0.0,)}),
    ("bscm", {}, {"moved_px": (0.0,), "radius_px": (-1.0,), "blur_px": (nan,)}),
    ("hough-lines", {}, {"saturated": (1.0,), "tilt_deg": (91.0,), "least_votes": (1,)}),
    ("hough-lines", {}, {"reach_px": (0.0,)}),
    ("hough-circle", {}, {"edge": (0.0,), "threshold": (1.5,), "smallest_px": (0.5,)}),
    ("hough-circle", {}, {"largest_px": (1.0,)}),
    ("escm", {"width_px": 3.0}, {"width_px": (0.0,), "layout": ("cross",), "hot": (1.0,)}),
    ("escm", {"width_px": 3.0}, {"margin_px": (-1.0,)}),
    ("escm-wta", {}, {"winners": (0,), "offset_px": (inf,)}),
    ("bcm-profile", SLITS, {"line_axes": ((), ("x", "z")), "slits": ((),)}),
    ("direct-profile", LINES, {"line_axes": ((), ("u",))}),
    ("threshold-profile", LINES, {"line_axes": (("x", ""),)}),
    ("linear-phase", SLITS, {"frequencies": (0,)}),
    ("eigen-analysis", SLITS, {"frequencies": (-1,)}),
    ("linear-phase-frame", {"width_px": 8.0}, {"frequencies": (0,)}),
    ("spot-list", {**HOLES, "spots": 3}, {"apertures_px": ((), ((0.0, 0.0),), ((0.0, 0.0, nan),))}),
    ("spot-list", {**HOLES, "spots": 3}, {"blur_px": (-0.1, inf)}),
    ("mcam", HOLES, {"field_px": ((9.0, 8.0, 0.0), (nan, 8.0, 1.0), (9.0, 8.0))}),
    ("mcam", HOLES, {"apertures_px": ((), ((0.0, 0.0, 0.0),), ((0.0, nan, 3.0),))}),
    ("mcam", HOLES, {"blur_px": (-1.0,), "threshold": (1.0,), "tolerance_px": (10.0,)}),
    ("fmms", {**HOLES, "bandwidth_px": 9.0}, {"bins": (2,), "similarity": (1.0,)}),
    ("fmms", {**HOLES, "bandwidth_px": 9.0}, {"bandwidth_px": (0.0,), "convergence_px": (0.0,)}),
    ("feic", HOLES, {"shape": ("oval",), "correlations": (5,), "presence": (0.0,)}),
    ("weighted-spots", HOLES, {"faulty_lines": (-1,)}),
    *(
        (name, given, {
            "image": ("moffat",), "tolerance": (0.0,), "iterations": (0,),
            "coefficients": (
                *((0.0, 1.0), (0.0, 0.0, 1.0, 1.0, -3.0, 1.0), (0.0, 0.0, 1.0, 1.0, 0.0, 0.0)),
            ),
        })
        for name, given in (("ppe", SLITS), ("ppe-frame", {}))
    ),
    ("ppe", SLITS, {"overlap": (-1.0,)}),
    ("ppe-frame", {}, {"width_px": (0.0,)}),
    ("slit-image", {**SLITS, "height_px": 50.0, "pixel_mm": 0.05}, {
        "height_px": (0.0,), "pixel_mm": (-1.0,), "mask_px": (-0.1,),
        "glass": (((90.0, 1.5),), ((1.0, 0.9),)),
    }),
    ("voltage-balance", {}, {"order": ((0, 1, 2, 2),), "dark": ((0.0, 1.0),), "gain": (0.0,)}),
    ("direct", {}, {"elements": (0,), "gain": ((1.0, nan, 1, 1, 1, 1),)}),
    ("direct", {}, {"normalisation": ("median",)}),
    ("dial-tracks", {}, {"bits": (0,), "axes": AXES, "gain": ((1.0, 2.0),)}),
    ("assembled-faces", FACES, {"level_spread": (0.0,), "response": ("none",)}),
    ("basic", FACES, {"face_normals": OTHER_BODIES}),
    ("solar-panel", FACES, {"face_normals": (*OTHER_BODIES, PYRAMID)}),
    *((name, FACES, {"face_normals": (CUBE[:5],)}) for name in ("trig", "trig-averaged")),
    ("pyramidal", {"face_normals": PYRAMID}, {"coefficient": ("some",), "dark_fraction": (1.0,)}),
    ("pyramidal-constant", {"face_normals": PYRAMID}, {"largest_misfit": (0.0,)}),
    ("panoramic", FACES, {"weighting": ("none",), "largest_incidence_deg": (0, 90)}),
    ("panoramic-temperature", FACES, {"reference_temperature_K": (0.0,)}),
    ("camera", PLANAR, {"distortion": ((0.1,), (0.1, nan))}),
    *(
        (name, PLANAR, {"focal_length_mm": (0.0,), "centre": ((0.0, nan),)})
        for name in ("spm", "lsq")
    ),
    *(
        (name, PLANAR, {"unit_mm": (0.0, -1.0, inf)})
        for name in ("spm", "lsq", "lut", "lut-polynomial")
    ),
    *((name, PLANAR, {"interval_deg": (0.0, -1.0)}) for name in ("lut", "lut-polynomial")),
    ("lut", PLANAR, {"smoothing": (nan,)}),
    ("lut-polynomial", PLANAR, {"degree": (0, 16)}),
    ("linear", {}, {"target": ("sine",)}),
    *(
        (name, {}, {"degree": (0, 16), "extrapolation": (-1e-9, nan)})
        for name in ("polynomial-1d", "polynomial-2d")
    ),
    ("polynomial-signals", {"signals": 6}, {"degree": (7,)}),
    ("fourier-balance", {}, {"harmonics": (9,)}),
    *(
        (name, DIAL, {
            "bits": (0, 17), "cell_mm": (0.0, 0.6, 0.7), "period_mm": (nan,),
            "focal_length_mm": (0.0,), "axes": (("x",), ("x", "x")),
            "smallest_contrast": (-0.001, 1.0),
        })
        for name in ("periodic", "fourier-phase")
    ),
    ("fourier-phase", DIAL, {"harmonics": (0, 17)}),
    ("coded-spacing", CODED, {
        "spots": (2,), "agreeing": (2,), "share": (0.0,), "odds": (0.5,), "tolerance_px": (-1.0,),
        "size_tolerance": (0.0,), "layers": (((0.1, 0.9),),),
        "apertures_px": (((0.0, 0.0, 5.0),),), "half_fov_deg": (0.0, 90.0, -5.0, nan),
    }),
    *(
        (name, given, {"hidden": (0, 41), "restarts": (0,), "seed": (-1,)})
        for name, given in (("ann", {}), ("dnn-surface", {}), ("dnn", {"signals": 4}))
    ),
    ("dnn", {}, {"signals": (9,)}),
    ("qpd", {"focal_length_mm": 1.0, "aperture_width_mm": 1.2}, {
        "gap_mm": (2.0, -0.1), "aperture_shape": ("oval",),
    }),
    ("v-slit", SLANTED, {"cover_glass": (((0.5, 0.9),), ((0.0, 1.5),), ((1.0, 1.5), (0.9, 1.5)))}),
    ("extended-kalman", {}, {"worst_deg": (0.0,), "bias_deg_h": (-1.0,)}),
    ("extended-kalman", {}, {"face_normals": (((1.0, 0.0, 0.0),) * 3,)}),
    ("unscented-kalman", {}, {"kappa": (-0.5,)}),
    ("adaptive-kalman", {}, {"window": (1.0,)}),
    ("robust-kalman", {}, {"limit": (0.0,)}),
    ("multiple-models", {}, {"noise_scales": ((), (1.0, -1.0))}),
    ("assembly-drift", {}, {"gain_deviation": (0.0,)}),
    ("consider-kalman", {}, {"albedo_deviation": (0.0,)}),
    ("optical", PLANAR, {"focal_length_mm": (0.0,)}),
    ("optical", PLANAR, {"layers": (((0.0, 1.5),), ((0.1, 0.9),), ((3.0, 1.5),))}),
    ("shadow", {**PLANAR, "thickness_mm": 0.1, "aperture_mm": 0.3}, {"drawn_mm": (-1.0,)}),
)  # fmt: skip
#: The same of the ends of a range, which are taken.
TAKEN: tuple[tuple[str, dict[str, Any], dict[str, tuple[Any, ...]]], ...] = (
    ("bctm", {}, {"threshold": (0.0, 0.5, 0.999)}),
    ("lut-polynomial", PLANAR, {"degree": (1, 15)}),
    *(
        (name, {}, {"degree": (1, 15), "extrapolation": (0.0, inf)})
        for name in ("polynomial-1d", "polynomial-2d")
    ),
    ("fourier-phase", DIAL, {"harmonics": (1, 16), "bits": (1, 16)}),
    ("periodic", DIAL, {"bits": (1, 16), "smallest_contrast": (0.0, 0.999)}),
    ("periodic", DIAL, {"cell_mm": (1e-9, 0.599)}),
    ("panoramic", FACES, {"largest_incidence_deg": (1e-9, 89.9)}),
    *((name, PLANAR, {"interval_deg": (1e-9, 90.0)}) for name in ("lut", "lut-polynomial")),
    *((name, PLANAR, {"unit_mm": (1e-9, 1e9)}) for name in ("spm", "lsq", "lut", "lut-polynomial")),
)


def each(listed: tuple[Any, ...]) -> Iterator[Any]:
    for method, given, values in listed:
        for name, several in values.items():
            for value in several:
                yield pytest.param(method, given, name, value, id=f"{method}-{name}-{value}")


@pytest.mark.parametrize(("method", "given", "name", "value"), [*each(REFUSED)])
def test_what_is_out_of_range_is_refused(
    method: str, given: dict[str, Any], name: str, value: Any
) -> None:
    if method != "dnn" or given:
        assert METHODS[method](**given), "what is given beside is taken"
    said = name.removeprefix("face_")
    with pytest.raises(ValueError, match=rf"{said}\b.*(; got |empty)"):
        METHODS[method](**{**given, name: value})


@pytest.mark.parametrize(("method", "given", "name", "value"), [*each(TAKEN)])
def test_the_ends_of_a_range_are_taken(
    method: str, given: dict[str, Any], name: str, value: Any
) -> None:
    assert getattr(METHODS[method](**{**given, name: value}), name) == value
