"""Previews show what was simulated: every data set has one, and it is drawn from its samples."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from algorithms.discovery import discover_extractors
from api.previews import published_preview
from benchmark import datasets
from benchmark.datasets import preview_overlay
from benchmark.datasets.preview import FIRST_SAMPLES, preview_png
from benchmark.datasets.preview_overlay import overlay_png
from benchmark.datasets.preview_sheet import LINES

PAPER = (255, 255, 255)


def read(png):
    return cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]


#: Of which a picture takes a moment: profiles, a sweep, bars.
QUICK = {"ccd-v-slit", "psd-single-aperture", "pva-maskless-pyramid", "qpd-single-aperture"}


@pytest.mark.parametrize(
    "name",
    [
        name if name in QUICK else pytest.param(name, marks=pytest.mark.slow)
        for name in datasets.names()
    ],
)
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
    # of whatever code: `tests/api/test_pictures.py` holds its name to the code as it is
    (published,) = published_preview(name).parent.glob(f"{name}.*.png")
    kept = read(published.read_bytes())
    assert kept.shape == image.shape
    # other processors round a few samples another way; text is smoothed as libraries have it
    apart = np.abs(kept.astype(int) - image).max(axis=2)
    assert (apart > 8).mean() < 0.01, "the published picture is not what is drawn"


@pytest.mark.slow
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


def test_an_overlay_has_its_cross_where_the_spot_is_found():
    """Four frames cut to 116 px: a tile of 232 px shows each pixel as four."""
    preset = datasets.get("cmos-single-aperture-pinhole")
    samples = preset.generate("nominal", "test", 4)
    reader = discover_extractors()["bctm"]
    found = reader.for_sensor(preset.geometry).extract(samples.observations)
    image = read(overlay_png(preset, reader, ["nominal"])).astype(int)
    assert image.shape[:2] == (84 + 232 + 52, 2 * 24 + 4 * 232 + 3 * 14)
    high, wide = samples.observations.shape[1:]
    assert high == wide
    orange = np.abs(image - np.array(to_rgb(LINES[1])) * 255).max(axis=2) < 40
    for n, (x, y) in enumerate(found):
        corner = 24 + n * (232 + 14)
        rows, columns = np.nonzero(orange[84 : 84 + 232, corner : corner + 232])
        left, first = (np.clip(round(at) - 58, 0, max(wide - 116, 0)) for at in (x, y))
        scale = 232 / min(116, wide)
        middle = scale * (np.array([x - left, y - first]) + 0.5)
        assert np.mean([columns, rows], axis=1) == pytest.approx(middle, abs=3.0)


def test_an_overlay_says_where_and_how_far_off():
    there, off, nowhere = np.array([12.0, 7.0]), np.array([15.0, 3.0]), np.full(2, np.nan)
    assert preview_overlay._apart(off, there) == "(15.0, 3.0), 5.00 px off"
    assert preview_overlay._apart(off, nowhere) == "(15.0, 3.0)"
    assert preview_overlay._apart(nowhere, there) == "not found"
    with pytest.raises(preview_overlay.OverlayError, match="ccd-slit has profiles"):
        overlay_png(datasets.get("ccd-slit"), discover_extractors()["bctm"])
