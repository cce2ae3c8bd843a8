"""The picture of the learning curves: every leader in its panel, the poses it needs marked."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from benchmark.learning_curves import plots, record

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def rows():
    return record.published_curves()


@pytest.mark.slow
def test_every_leader_has_its_line_and_its_mark(rows):
    drawn = plots.figure(rows)
    panels = {axes.texts[0].get_text(): axes for axes in drawn.axes}
    assert list(panels) == list(dict.fromkeys(row["dataset"] for row in rows))
    for row in rows:
        axes = panels[row["dataset"]]
        said = [text.get_text() for text in axes.texts]
        assert any(text.startswith(f"{row['extractor']} + {row['model']}") for text in said)
        places = [line.get_xydata().tolist() for line in axes.lines]
        dots = [p for line, p in zip(axes.lines, places, strict=True) if line.get_marker() == "o"]
        end = [row["poses"], row["points"][-1]["middle_deg"]]
        low, high = axes.get_ylim()
        if end[1] > high:  # far behind the first leader: in words, and as far as the line goes
            (text,) = [
                text for text in said if text.startswith(f"{row['extractor']} + {row['model']}")
            ]
            assert text.endswith(f"({end[1]:.2g} deg, above)")
            continue
        assert any(np.allclose(point, end) for line in places for point in line)
        if row["needed_poses"] is not None:
            (height,) = [
                p["middle_deg"] for p in row["points"] if p["poses"] == row["needed_poses"]
            ]
            assert [[row["needed_poses"], height]] in dots
        if row["place"] == 1:
            assert low < end[1] < high


@pytest.mark.slow
def test_the_file_is_the_same_every_time_small_and_says_what_it_is(rows):
    text = plots.picture(rows)
    assert text == plots.picture(rows)
    assert len(text.encode()) < 300_000
    root = ET.fromstring(text)
    assert "against the poses" in root.findtext(f"{SVG}title")
    words = {element.text for element in root.iter(f"{SVG}text")}
    assert {"less than 95 % answered", "Cramer-Rao bound", "error a bench adds"} <= words


def test_a_leader_that_nothing_answered_leaves_an_empty_panel(rows):
    empty = [
        {"poses": p["poses"], "refused": 6, **dict.fromkeys(p.keys() - {"poses", "refused"})}
        for p in rows[0]["points"]
    ]
    drawn = plots.figure([{**rows[0], "points": empty, "needed_poses": None}])
    assert len(drawn.axes) == 1
    assert plots.figure([]).texts[-1].get_text() == "nothing is stored"
