"""What previews say and plot, recorded by a sheet that draws nothing."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest

from algorithms.contract import Observation
from benchmark.datasets import preview
from benchmark.datasets.fields import AngleField, SphereField
from benchmark.simulator.light.sun_disc import from_angles

SUN = np.vstack([from_angles(np.array([0.0, 20.0, -5.0]), np.array([30.0, 0.0, 5.0]))])


@pytest.fixture
def sheet(monkeypatch: pytest.MonkeyPatch) -> MagicMock:
    """The sheet that is drawn on: it records what is drawn."""
    stub = MagicMock()
    made = MagicMock(return_value=stub)
    monkeypatch.setattr(preview, "Sheet", made)
    stub.size = made
    stub.plots = []
    stub.plot.side_effect = lambda *area, **more: stub.plots.append(MagicMock()) or stub.plots[-1]
    return stub


def texts(sheet: MagicMock) -> list[str]:
    return [call.args[2] for call in sheet.text.call_args_list]


def preset_of(observations: Any, sun: Any = SUN, **more: Any) -> Any:
    context = more.pop("context", None)
    samples = SimpleNamespace(observations=observations, sun=sun, truth=sun, context=context)
    asked: list[Any] = []
    given: dict[str, Any] = {
        "name": "fake",
        "units": "microamperes (N, 4), float64",
        "observation": Observation.CURRENTS,
        "directions": SphereField(),
        "card": lambda: {"context": {}} if context else {},
        "generate": lambda *what: asked.append(what) or samples,
        "geometry_for": lambda condition: SimpleNamespace(line_pixels=None, centre_px=None),
        "asked": asked,
    }
    return SimpleNamespace(**{**given, **more})


@pytest.mark.parametrize(
    ("sun", "said"),
    [
        ((0.6, 0.0, 0.8), "alpha 0.0, beta 36.9 deg"),
        ((0.0, -0.6, 0.8), "alpha -36.9, beta 0.0 deg"),
        ((0.6, 0.799, 0.0501), "alpha 86.4, beta 85.2 deg"),
        ((0.6, 0.8, 0.05), "Sun at (0.60, 0.80, 0.05)"),
        ((0.6, 0.0, -0.8), "Sun at (0.60, 0.00, -0.80)"),
    ],
)
def test_directions_are_told_as_angles_while_the_sun_is_well_in_front(sun: Any, said: str) -> None:
    assert preview._direction(np.array(sun)) == said


def test_the_incidence_is_the_angle_off_the_boresight() -> None:
    found = preview.incidence_deg(np.array([[0.0, 0, 1], [0.6, 0, 0.8], [0, -1, 0], [0, 0, -1]]))
    np.testing.assert_allclose(found, [0.0, math.degrees(math.asin(0.6)), 90.0, 180.0])


def test_samples_are_shown_from_small_incidence_to_large_evenly() -> None:
    beta = np.array([50.0, 1.0, 2.0, 26.0, 3.0, 49.0, 24.0])
    preset = preset_of(np.zeros((7, 2)), from_angles(np.zeros(7), beta))
    _, shown = preview._some(preset, "quiet", 3)
    assert [beta[row] for row in shown] == [1.0, 26.0, 50.0]
    assert preset.asked == [("quiet", "test", preview.FIRST_SAMPLES)]
    assert len(preview._some(preset, "quiet", 99)[1]) == 7
    dark = np.array([False, True, False, False, False, False, False])
    flight = preset_of(np.zeros((7, 2)), from_angles(np.zeros(7), beta), context={"eclipse": dark})
    _, shown = preview._some(flight, "quiet", 2)
    assert [beta[row] for row in shown] == [2.0, 50.0]
    assert flight.asked == [("quiet", "test", None)]


@pytest.mark.parametrize(
    ("field", "signals", "context", "drawn"),
    [
        (AngleField(10.0), 4, None, "sweep"),
        (AngleField(10.0), len(preview.LINES), None, "sweep"),
        (AngleField(10.0), len(preview.LINES) + 1, None, "bars"),
        (SphereField(), 4, None, "bars"),
        (AngleField(10.0), 4, {"time_s": np.zeros(3)}, "flight"),
    ],
)
def test_currents_are_a_sweep_where_there_is_a_grid_and_few_signals(
    field: Any, signals: int, context: Any, drawn: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("sweep", "bars", "flight"):
        monkeypatch.setattr(preview, f"_{name}", lambda *_given, name=name: name)
    preset = preset_of(np.zeros((3, signals)), directions=field, context=context)
    assert preview._currents(preset, "quiet") == drawn


@pytest.mark.parametrize(
    ("each", "said", "borders"),
    [(None, "read-out of 12 px;", []), (12, "read-out of 12 px;", []),
     (4, "read-out of 12 px, 3 arrays of 4 px end to end;", [3.5, 7.5])],
)  # fmt: skip
def test_a_read_out_is_plotted_sample_by_sample_with_its_arrays_apart(
    sheet: MagicMock, each: int | None, said: str, borders: list[float]
) -> None:
    profiles = np.arange(36.0).reshape(3, 12) + 5.0
    geometry = SimpleNamespace(line_pixels=each)
    preset = preset_of(profiles, geometry_for=lambda condition: geometry)
    preview._profiles(preset, "quiet")
    assert texts(sheet)[0] == "fake, quiet"
    assert texts(sheet)[1] == f"{said} digital numbers over pixels"
    assert texts(sheet)[2:] == [
        "alpha -5.0, beta 5.0 deg", "alpha 20.0, beta 0.0 deg", "alpha 0.0, beta 30.0 deg",
    ]  # fmt: skip
    assert len(sheet.plots) == 3
    for place, (plot, row) in enumerate(zip(sheet.plots, [2, 1, 0], strict=True)):
        np.testing.assert_array_equal(plot.plot.call_args.args[0], profiles[row])
        plot.set.assert_called_once_with(xlim=(0, 11), ylim=(0.0, pytest.approx(1.05 * 40)))
        assert [call.args[0] for call in plot.axvline.call_args_list] == borders
        plot.tick_params.assert_called_once_with(labelbottom=place == 2)
    tops = [call.args[1] for call in sheet.plot.call_args_list]
    assert np.diff(tops).tolist() == [128, 128]


def test_spikes_are_coloured_where_they_were(sheet: MagicMock) -> None:
    events = np.full((3, 4, 3), np.nan)
    events[:, :2] = [(5.0, 2.0, 60.0), (1.0, 6.0, 90.0)]
    geometry = SimpleNamespace(centre_px=(3.5, 5.0))
    preset = preset_of(events, geometry_for=lambda condition: geometry)
    preview._events(preset, "quiet")
    assert texts(sheet)[1].startswith("spikes on 8 x 11 px,")
    assert texts(sheet)[2:] == ["7.1 deg, 2 spikes", "20.0 deg, 2 spikes", "30.0 deg, 2 spikes"]
    picture = sheet.picture.call_args_list[0].args[2]
    size = picture.shape[0] // 11
    assert picture.shape == (11 * size, 8 * size)
    found = picture[::size, ::size]
    assert {(int(i), int(j)): found[i, j] for i, j in np.argwhere(np.isfinite(found))} == {
        (2, 5): 60.0,
        (6, 1): 90.0,
    }


def test_tiles_stand_in_rows_and_pictures_in_their_middle(sheet: MagicMock) -> None:
    for place in range(preview._ACROSS + 1):
        preview._tile(sheet, place, np.zeros((100, 60)), None, f"label {place}")  # type: ignore[arg-type]
    boxes = [call.args[:2] for call in sheet.box.call_args_list]
    assert boxes[0][0] == boxes[-1][0] == preview._LEFT
    assert boxes[1] == (preview._LEFT + preview._TILE + 12, boxes[0][1])
    assert boxes[-1][1] - boxes[0][1] == preview._TILE + 34
    x, y, *_ = sheet.picture.call_args_list[0].args
    assert x - boxes[0][0] == (preview._TILE - 60) // 2
    assert y - boxes[0][1] == (preview._TILE - 100) // 2


@pytest.mark.parametrize(
    ("shape", "fitted"),
    [
        ((10, 20), (preview._TILE // 20 * 10, preview._TILE // 20 * 20)),
        ((preview._TILE, 7), (preview._TILE, 7)),
        ((2 * preview._TILE, preview._TILE), (preview._TILE, preview._TILE // 2)),
    ],
)
def test_frames_are_repeated_or_the_brightest_of_blocks_to_fit_a_tile(
    shape: tuple[int, int], fitted: tuple[int, int]
) -> None:
    frame = np.random.default_rng(1).random(shape)
    found = preview._fit(frame)
    assert found.shape == fitted
    assert found.max() == frame.max()
    if shape[0] > preview._TILE:
        blocks = frame.reshape(fitted[0], 2, fitted[1], 2).max(axis=(1, 3))
        np.testing.assert_array_equal(found, blocks)


@pytest.mark.parametrize(
    ("values", "limits"),
    [
        ([0.0, 10.0], (0.0, 10.4)),
        ([4.9, 10.0], (0.0, 10.4)),  # below half of the largest the axis starts at 0
        ([5.0, 10.0], (4.8, 10.2)),
        ([-1.0, 9.0], (-1.4, 9.4)),
        ([3.0, 3.0, np.nan], (2.96, 3.04)),
    ],
)
def test_an_axis_leaves_a_margin_and_starts_at_zero_where_that_is_near(
    values: list[float], limits: tuple[float, float]
) -> None:
    assert preview._range(np.array(values)) == pytest.approx(limits)


def test_a_sweep_is_of_the_row_a_third_up_in_order_of_beta(sheet: MagicMock) -> None:
    axis = np.linspace(-30.0, 30.0, 7)
    alpha, beta = np.repeat(axis, 7), np.tile(axis[::-1], 7)
    signals = np.column_stack([beta, alpha])
    preset = preset_of(signals, from_angles(alpha, beta))
    preview._sweep(preset, "quiet", preset.generate("quiet", "calibration"))
    assert "at alpha = 10 deg" in texts(sheet)[1]
    (plot,) = sheet.plots
    first, second = plot.plot.call_args_list
    np.testing.assert_allclose(first.args[0], axis, atol=1e-9)
    np.testing.assert_allclose(first.args[1], axis, atol=1e-9)
    np.testing.assert_allclose(second.args[1], 10.0)
    assert texts(sheet)[-2:] == ["signal 1", "signal 2"]
