"""Overlays of frames in which nobody knows where the Sun is, or nothing was found."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets import preview_overlay
from benchmark.datasets.preview_overlay import true_places
from benchmark.datasets.preview_sheet import Sheet
from benchmark.datasets.samples import Samples
from benchmark.simulator.light.sun_disc import from_angles

SUN = from_angles(np.array([0.0, 3.0]), np.array([0.0, -2.0]))
NOWHERE = np.full(2, math.nan)


def samples(origin: np.ndarray | None) -> Samples:
    return Samples(np.zeros((2, 8, 8), dtype=np.uint16), SUN, origin)


def test_the_true_place_counts_from_the_windows_first_pixel() -> None:
    preset = datasets.get("cmos-lens")
    whole = true_places(preset, "nominal", samples(None))
    origin = np.array([[10, 20], [30, 40]])
    part = true_places(preset, "nominal", samples(origin))
    assert np.isfinite(whole).all()
    np.testing.assert_allclose(part, whole - origin)


def test_behind_a_mask_nobody_says_where_the_sun_is() -> None:
    places = true_places(datasets.get("cmos-single-aperture"), "nominal", samples(None))
    assert places.shape == (2, 2)
    assert np.isnan(places).all()


@pytest.mark.parametrize(
    ("found", "true", "markers"),
    [
        (np.array([20.0, 30.0]), NOWHERE, ["+"]),
        (NOWHERE, np.array([20.0, 30.0]), ["o"]),
        (NOWHERE, NOWHERE, []),
    ],
)
def test_only_known_places_are_marked(
    found: np.ndarray, true: np.ndarray, markers: list[str]
) -> None:
    sheet, frame = Sheet(240, 240), np.arange(60_000.0).reshape(200, 300)
    middle = true if np.isfinite(true).all() else found
    preview_overlay._tile(sheet, (0, 0), frame, middle, (found, true))
    (axes,) = sheet.figure.axes
    assert [line.get_marker() for line in axes.lines] == markers
    if not markers:  # then the middle of the frame is shown
        assert axes.get_xlim() == (150 - 58.5, 150 + 57.5)


@pytest.mark.parametrize(
    ("found", "true", "said"),
    [
        (NOWHERE, np.array([1.0, 2.0]), "not found"),
        (np.array([4.0, 6.0]), NOWHERE, "(4.0, 6.0)"),
        (np.array([4.0, 6.0]), np.array([1.0, 2.0]), "(4.0, 6.0), 5.00 px off"),
    ],
)
def test_the_line_below_says_what_is_known(found: np.ndarray, true: np.ndarray, said: str) -> None:
    assert preview_overlay._apart(found, true) == said
