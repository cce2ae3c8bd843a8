"""What overlays show of each frame, recorded by a sheet that draws nothing; where letters stand."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import cv2
import numpy as np
import pytest

from algorithms.contract import FeatureKind, Observation
from benchmark.datasets import preview_overlay as overlay
from benchmark.datasets.preview_sheet import LINES, Sheet

NAN = (math.nan, math.nan)


@pytest.mark.parametrize(
    ("found", "true", "said"),
    [
        ((10.0, 20.0), (7.0, 16.0), "(10.0, 20.0), 5.00 px off"),
        ((10.04, 20.06), NAN, "(10.0, 20.1)"),
        (NAN, (7.0, 16.0), "not found"),
        ((3.0, math.nan), NAN, "not found"),
    ],
)
def test_how_far_apart_is_told_where_both_are_known(found: Any, true: Any, said: str) -> None:
    assert overlay._apart(np.array(found), np.array(true)) == said


@pytest.mark.parametrize(
    ("middle", "left", "first"),
    [
        ((100.0, 150.0), 42, 92),
        ((3.0, 5.0), 0, 0),
        ((298.0, 399.0), 184, 284),  # 300 wide, 400 high, less 116
        (NAN, 92, 142),
    ],
)
def test_a_tile_shows_the_surroundings_of_the_sun_and_no_more_than_the_frame(
    middle: Any, left: int, first: int
) -> None:
    frame = np.random.default_rng(1).uniform(10, 50, (400, 300))
    sheet, found, true = MagicMock(), np.array([120.0, 160.0]), np.array([118.0, 158.0])
    overlay._tile(sheet, (24, 84), frame, np.array(middle), (found, true))
    sheet.axes.assert_called_once_with(24, 84, overlay._TILE, overlay._TILE)
    axes = sheet.axes.return_value
    (shown,) = axes.imshow.call_args.args
    part = frame[first : first + 116, left : left + 116]
    np.testing.assert_allclose(shown, np.sqrt((part - part.min()) / np.ptp(part)))
    edges = (left - 0.5, left + 115.5, first + 115.5, first - 0.5)
    assert axes.imshow.call_args.kwargs["extent"] == edges
    axes.set.assert_called_once_with(xlim=edges[:2], ylim=edges[2:])
    ring, cross = axes.plot.call_args_list
    assert (ring.args, ring.kwargs["marker"]) == ((118.0, 158.0), "o")
    assert ring.kwargs["markeredgecolor"] == LINES[2]
    assert (cross.args, cross.kwargs["marker"]) == ((120.0, 160.0), "+")
    assert cross.kwargs["markeredgecolor"] == LINES[1]


def test_what_is_not_known_is_not_drawn() -> None:
    sheet = MagicMock()
    nowhere = np.array(NAN)
    overlay._tile(sheet, (0, 0), np.full((30, 50), 7.0), nowhere, (nowhere, nowhere))
    axes = sheet.axes.return_value
    axes.plot.assert_not_called()
    assert axes.imshow.call_args.args[0].shape == (30, 30)
    assert axes.imshow.call_args.kwargs["extent"] == (9.5, 39.5, 29.5, -0.5)
    assert not axes.imshow.call_args.args[0].any()


def test_a_row_a_condition_of_the_first_frames_each_with_its_words(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frames = np.arange(4 * 5 * 6.0).reshape(4, 5, 6)
    samples = SimpleNamespace(observations=frames, sun=np.zeros((4, 3)), origin_px=None)
    asked: list[Any] = []
    known: list[str] = []
    preset = SimpleNamespace(
        name="fake",
        observation=Observation.FRAMES,
        conditions=("quiet", "noisy"),
        condition=lambda name: known.append(name) or SimpleNamespace(sensor=None),
        generate=lambda *what: asked.append(what) or samples,
        geometry_for=lambda condition: condition,
    )
    about = SimpleNamespace(name="finder", kind=FeatureKind.SPOT, observation=Observation.FRAMES)
    places = np.array([[1.0, 2.0], [3.0, 1.0], NAN, [0.0, 0.0]])
    finder = SimpleNamespace(
        about=about, for_sensor=lambda geometry: SimpleNamespace(extract=lambda some: places)
    )
    sheet, tiles = MagicMock(), MagicMock()
    size = MagicMock(return_value=sheet)
    monkeypatch.setattr(overlay, "Sheet", size)
    monkeypatch.setattr(overlay, "_tile", tiles)
    assert overlay.overlay_png(preset, finder) is sheet.png.return_value  # type: ignore[arg-type]
    wide = 2 * overlay._LEFT + 4 * overlay._TILE + 3 * overlay._GAP
    size.assert_called_once_with(wide, overlay._TOP + 2 * (overlay._TILE + 52))
    assert asked == [("quiet", "test", 4), ("noisy", "test", 4)]
    texts = [(call.args[2], call.kwargs.get("bold", False)) for call in sheet.text.call_args_list]
    row = [
        ("(1.0, 2.0)", False),
        ("(3.0, 1.0)", False),
        ("not found", False),
        ("(0.0, 0.0)", False),
    ]
    assert texts == [
        ("fake: finder", True), (overlay._SAID, False),
        ("quiet", True), *row, ("noisy", True), *row,
    ]  # fmt: skip
    corners = [call.args[1] for call in tiles.call_args_list]
    step = overlay._TILE + overlay._GAP
    assert [x for x, _ in corners[:4]] == [overlay._LEFT + n * step for n in range(4)]
    assert corners[4][1] - corners[0][1] == overlay._TILE + 52
    np.testing.assert_array_equal(tiles.call_args_list[1].args[3], places[1])
    size.reset_mock()
    overlay.overlay_png(preset, finder, ["noisy"])  # type: ignore[arg-type]
    assert asked[2:] == [("noisy", "test", 4)]

    def known_only(name: str) -> Any:
        if name == "warm":
            raise ValueError("no condition 'warm'")
        return SimpleNamespace(sensor=SimpleNamespace())

    preset.condition = known_only
    # a camera first: what is said of cameras would be known without a look at the second
    monkeypatch.setattr(overlay, "_CAMERAS", (SimpleNamespace,))
    with pytest.raises(ValueError, match="no condition 'warm'"):
        overlay.overlay_png(preset, finder, ["quiet", "warm"])  # type: ignore[arg-type]
    assert len(asked) == 3, "nothing is drawn before all conditions are known"
    about.observation = Observation.PROFILES
    with pytest.raises(ValueError, match="finder reads profiles, not frames"):
        overlay.overlay_png(preset, finder)  # type: ignore[arg-type]
    about.kind = FeatureKind.SIGNALS
    with pytest.raises(ValueError, match="overlays show spots on frames"):
        overlay.overlay_png(preset, finder)  # type: ignore[arg-type]


def test_windows_start_at_their_origin_or_at_zero() -> None:
    sun = np.zeros((2, 3))
    found = overlay._origins(SimpleNamespace(sun=sun, origin_px=np.array([[3, 4], [5, 6]])))  # type: ignore[arg-type]
    np.testing.assert_array_equal(found, [[3.0, 4.0], [5.0, 6.0]])
    none = overlay._origins(SimpleNamespace(sun=sun, origin_px=None))  # type: ignore[arg-type]
    np.testing.assert_array_equal(none, np.zeros((2, 2)))


def inked(sheet: Sheet) -> Any:
    image = cv2.imdecode(np.frombuffer(sheet.png(), dtype=np.uint8), cv2.IMREAD_COLOR)
    rows, columns = np.nonzero((image < 200).any(axis=2))
    return rows.min(), rows.max(), columns.min(), columns.max()


def test_letters_stand_on_their_line_and_boxes_from_their_corner() -> None:
    sheet = Sheet(300, 120)
    sheet.text(50, 80, "HHH", 20)
    top, bottom, left, right = inked(sheet)
    assert 48 <= left <= 54
    assert 75 <= right <= 120
    assert 77 <= bottom <= 81
    assert 62 <= top <= 68
    sheet = Sheet(300, 120)
    sheet.box(30, 20, 40, 10, "black")
    assert inked(sheet) == pytest.approx((20, 29, 30, 69), abs=1)
