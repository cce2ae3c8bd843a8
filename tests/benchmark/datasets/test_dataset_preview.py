"""Previews show what was simulated: every data set has one, and it is drawn from its samples."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from api.previews import published_preview
from benchmark import datasets
from benchmark.datasets import preview, preview_overlay
from benchmark.datasets.preview import FIRST_SAMPLES, incidence_deg, preview_png
from benchmark.datasets.preview_sheet import Sheet, heat, number, span

ROOT = Path(datasets.__file__).parents[2]
PAPER = (255, 255, 255)


def read(png):
    return cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]


@pytest.mark.slow
@pytest.mark.parametrize("name", datasets.names())
def test_every_data_set_has_a_picture_with_much_on_it(name):
    png = preview_png(datasets.get(name))
    assert png.startswith(b"\x89PNG")
    assert len(png) < 600_000
    image = read(png)
    assert image.shape[1] == 1000
    assert 250 < image.shape[0] < 700
    drawn = (image != PAPER).any(axis=2)
    assert drawn.mean() > 0.005
    assert drawn[:60].any(), "a title"
    assert not drawn[:, -8:].any(), "nothing runs off the edge"
    assert not drawn[-3:].any()
    kept = read(published_preview(name).read_bytes())
    assert kept.shape == image.shape
    # other processors round a few samples another way; text is smoothed as libraries have it
    apart = np.abs(kept.astype(int) - image).max(axis=2)
    assert (apart > 8).mean() < 0.01, "the published picture is not what is drawn"


@pytest.mark.slow
def test_a_picture_is_the_same_each_time_and_another_one_for_another_condition():
    preset = datasets.get("qpd-single-aperture")
    assert preview_png(preset, "high-noise") == preview_png(preset, "high-noise")
    assert preview_png(preset, "high-noise") != preview_png(preset, "nominal")
    with pytest.raises(ValueError, match="no condition 'warm'"):
        preview_png(preset, "warm")


@pytest.mark.slow
def test_frames_are_drawn_from_the_first_samples_only(monkeypatch):
    preset = datasets.get("cmos-single-aperture")
    asked = []
    generate = type(preset).generate

    def watched(self, condition, split, n=None):
        asked.append(n)
        return generate(self, condition, split, n)

    monkeypatch.setattr(type(preset), "generate", watched)
    preview_png(preset)
    assert asked == [FIRST_SAMPLES]


def test_a_spot_is_drawn_where_it_is():
    """The brightest part of a tile is the spot of the sample with the smallest incidence."""
    preset = datasets.get("cmos-single-aperture")
    samples = preset.generate("nominal", "test", FIRST_SAMPLES)
    nearest = int(np.argmax(samples.sun[:, 2]))
    frame = samples.observations[nearest].astype(float)
    rows, columns = np.mgrid[:64, :64]
    frame -= np.median(frame)
    y, x = (np.sum(frame * grid) / frame.sum() for grid in (rows, columns))
    tile = read(preview_png(preset))[78 : 78 + 208, 24 : 24 + 208].astype(float).sum(axis=2)
    tile = tile[8:200, 8:200]  # the grey border
    bright = tile > 0.8 * tile.max()
    at_y, at_x = (float(np.mean(k)) for k in np.nonzero(bright))
    assert (at_x / 3, at_y / 3) == pytest.approx((x + 1 / 3, y + 1 / 3), abs=0.7)


def colours(values):
    """(H, W, 3) of a sheet that shows (H, W) values and nothing else."""
    high, wide = values.shape
    sheet = Sheet(wide, high)
    sheet.picture(0, 0, values, span([0.0, 1.0]))
    return read(sheet.png())


def test_colours_rise_with_the_value():
    light = colours(np.linspace(0, 1, 256)[None]).astype(float)[0] @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(light) >= -0.6).all()
    assert light[0] < 5
    assert light[-1] > 240
    assert tuple(colours(np.array([[math.nan]]))[0, 0]) == PAPER


def test_every_value_is_a_pixel_where_it_belongs():
    values = np.linspace(0, 1, 12).reshape(3, 4)
    expected = np.round(255 * heat()(values)[:, :, :3])
    assert np.abs(colours(values) - expected).max() <= 1


@pytest.mark.parametrize(
    ("low", "high", "most", "expected"),
    [
        (0.0, 10.0, 5, [0, 2, 4, 6, 8, 10]),
        (-40.0, 40.0, 8, [-40, -30, -20, -10, 0, 10, 20, 30, 40]),
        (0.03, 0.09, 3, [0.04, 0.06, 0.08]),
    ],
)
def test_ticks_are_round_and_inside(low, high, most, expected):
    plot = Sheet(200, 200).plot(50, 10, 100, 100, most_y=most)
    plot.set_ylim(low, high)
    shown = [tick for tick in plot.get_yticks() if low <= tick <= high]
    assert shown == pytest.approx(expected)


def test_decades_are_ones_twos_and_fives():
    from matplotlib.colors import LogNorm

    sheet = Sheet(200, 200)
    sheet.scale(50, 20, 150, LogNorm(80.0, 2500.0), "us")
    (axes,) = sheet.figure.axes
    shown = [tick for tick in axes.get_yticks() if 80.0 <= tick <= 2500.0]
    assert shown == pytest.approx([100, 200, 500, 1000, 2000])


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0"), (12.5, "12.5"), (4e5, "4e5"), (2e-4, "2e-4"), (1000.0, "1000")]
)
def test_numbers_are_short(value, text):
    assert number(value) == text


def test_a_curve_breaks_where_there_is_nothing():
    sheet = Sheet(100, 50)
    plot = sheet.plot(0, 0, 100, 40)
    plot.set(xlim=(0, 10), ylim=(0, 1))
    plot.set_axis_off()
    plot.plot(np.where(np.arange(11) == 5, np.nan, 0.5), color="black", solid_capstyle="butt")
    dark = np.nonzero((read(sheet.png()) < 128).all(axis=2).any(axis=0))[0]
    assert dark.min() == 0
    assert not set(range(43, 57)) & set(dark.tolist())
    assert {20, 70} <= set(dark.tolist())


def test_a_user_s_settings_change_no_picture():
    import matplotlib as mpl

    preset = datasets.get("qpd-single-aperture")
    plain = preview_png(preset)
    with mpl.rc_context({"lines.linestyle": ":", "font.size": 30, "figure.facecolor": "black"}):
        assert preview_png(preset) == plain
        assert mpl.rcParams["font.size"] == 30, "and are as they were"


@pytest.mark.slow
def test_matplotlib_is_loaded_by_pictures_alone():
    code = (
        "import sys\n"
        "import api.server.app, benchmark.datasets.export, benchmark.datasets.preview_overlay\n"
        "import benchmark.running.task, benchmark.sweeps.plots, benchmark.experiments.sweeps\n"
        "assert 'matplotlib' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT, timeout=600)


@pytest.fixture
def sheets(monkeypatch):
    """Sheets of the previews that are drawn."""
    made = []

    class Kept(Sheet):
        def __init__(self, width, height):
            super().__init__(width, height)
            made.append(self)

    monkeypatch.setattr(preview, "Sheet", Kept)
    return made


@pytest.mark.parametrize(
    ("name", "said", "plots", "lines"),
    [
        ("pda-slit", "512 px, 2 arrays of 256 px end to end;", 4, 2),  # a border, and the read-out
        ("ccd-multi-slit", "2048 px; digital", 4, 1),
        ("qpd-single-aperture", "sweep of the calibration split", 1, 4),  # a line each element
        ("pd-maskless-cube", "single samples", 6, 0),
    ],
)
def test_a_picture_shows_what_its_words_say(name, said, plots, lines, sheets):
    preview_png(datasets.get(name))
    (sheet,) = sheets
    assert said in " ".join(text.get_text() for text in sheet.figure.texts)
    assert [len(axes.lines) for axes in sheet.figure.axes] == [lines] * plots


def test_incidence_is_the_angle_off_the_boresight():
    sun = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [0.0, -0.6, -0.8]])
    expected = [0.0, math.degrees(math.atan(0.75)), 90.0, 180.0 - math.degrees(math.atan(0.75))]
    np.testing.assert_allclose(incidence_deg(sun), expected, rtol=1e-12)


def test_a_line_of_text_stands_on_its_baseline():
    sheet = Sheet(60, 50)
    sheet.text(20, 40, "I", 20)
    rows, columns = np.nonzero((read(sheet.png()) < 128).all(axis=2))
    assert rows.max() == pytest.approx(39, abs=1)
    assert 20 <= columns.min() < columns.max() < 32


def test_a_picture_s_corner_is_where_it_is_put():
    sheet = Sheet(12, 10)
    sheet.picture(3, 2, np.zeros((4, 5)), span([0.0, 1.0]))
    rows, columns = np.nonzero((read(sheet.png()) != PAPER).any(axis=2))
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (2, 5, 3, 7)


@pytest.mark.parametrize(
    ("true", "corner"), [((150, 90), (92, 32)), ((298, 198), (184, 84)), ((1, 1), (0, 0))]
)
def test_an_overlay_is_cut_about_the_sun_with_an_orange_cross_and_a_green_ring(true, corner):
    """116 pixels each way of a frame of 300 by 200, and none beyond it."""
    from matplotlib.colors import to_rgb

    sheet, frame = Sheet(240, 240), np.arange(60000.0).reshape(200, 300)
    true, (left, first) = np.array(true, dtype=float), corner
    found = true + 1.0
    preview_overlay._tile(sheet, (0, 0), frame, true, (found, true))
    (axes,) = sheet.figure.axes
    assert axes.get_xlim() == (left - 0.5, left + 115.5)
    assert axes.get_ylim() == (first + 115.5, first - 0.5)
    marks = {line.get_marker(): line for line in axes.lines}
    for marker, place in (("+", found), ("o", true)):
        np.testing.assert_array_equal(marks[marker].get_xydata(), [place])
    red, green, blue = to_rgb(marks["+"].get_markeredgecolor())
    assert red > green > blue
    red, green, blue = to_rgb(marks["o"].get_markeredgecolor())
    assert green > max(red, blue)
