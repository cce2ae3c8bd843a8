"""Pictures of sweeps: the published rows as curves, small, and legible to everybody."""

import xml.etree.ElementTree as ET

import pytest

from benchmark.sweeps import plots
from benchmark.sweeps.record import swept

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def rows():
    return swept()


@pytest.mark.slow
@pytest.mark.parametrize("sweep", plots.DRAWN)
def test_every_panel_holds_the_stored_numbers_of_its_method(rows, sweep):
    drawn = plots.figure(rows, sweep)
    kept = [row for row in rows if row["sweep"] == sweep and row["value"] is not None]
    named = {(axes.texts[0].get_text(), axes.texts[1].get_text()) for axes in drawn.axes}
    assert len(drawn.axes) == len({(row["series"], row["extractor"]) for row in kept})
    for row in kept:
        about = [text for name, text in named if name == row["extractor"]]
        assert any(f"{row['series']} ({row['unit']})" in text for text in about), row
    expected = sorted((row["value"], row["rms"]) for row in kept if row["rms"])
    dots = [
        point
        for axes in drawn.axes
        for line in axes.lines
        if line.get_marker() == "o"
        for point in line.get_xydata().tolist()
    ]
    assert sorted(map(tuple, dots)) == expected
    assert all(axes.get_yscale() == "log" for axes in drawn.axes)
    assert {axes.get_xscale() for axes in drawn.axes} == {"linear" if sweep == "phase" else "log"}


@pytest.mark.slow
def test_the_file_is_small_says_what_it_is_and_holds_no_time(rows):
    text = plots.picture(rows, "noise")
    assert len(text.encode()) < 150_000
    assert text.startswith("<svg")
    root = ET.fromstring(text)
    assert "peak SNR" in root.findtext(f"{SVG}title")
    words = {element.text for element in root.iter(f"{SVG}text")}
    assert {"rms error of one coordinate", "less than 90 % found", "Cramer-Rao bound"} <= words
    assert "date" not in text.casefold()
    assert "matplotlib v" not in text.casefold()
