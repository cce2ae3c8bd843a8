"""Frames drawn afresh for `make bench`: what they hold, how answers are judged, and the report."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from benchmark.synthetic_features.frame_sets import FRAME_SETS, Scenes
from benchmark.synthetic_features.frames import REFERENCE_SETS
from benchmark.synthetic_features.shapes import (
    EDGE_PX,
    disc,
    gaussian,
    limb_darkened,
    render,
    square,
    stretch,
)
from tools.bench import robustness
from tools.bench.extractor_peers import scipy_ellipse
from tools.bench.robustness_grids import GRID_SETS, GridSet
from tools.bench.robustness_limits import RobustnessResult, verdicts
from tools.bench.verdicts import any_broken

SETS = {chosen.name: chosen for chosen in FRAME_SETS}
SMALL = [chosen for chosen in FRAME_SETS if chosen.size_px == 64]


@pytest.mark.parametrize(
    ("shape", "light"),
    [
        (disc(8.0), math.pi * (8.0**2 + EDGE_PX**2)),
        (gaussian(3.0), 2.0 * math.pi * 3.0**2),
        (stretch(8.0, 60.0), 2.0 * math.pi * 8.0**2),
        (square(8.0), 16.0**2),
        # a wide one: its law is steep where the rim is
        (limb_darkened(24.0), (1.0 - 0.6 / 3.0) * math.pi * 24.0**2),
    ],
)
def test_shapes_hold_the_light_of_their_area(shape, light):
    found = render(shape, np.array([[31.3, 30.8]]), np.array([0.4]), 64)
    assert found.sum() == pytest.approx(light, rel=0.01)


@pytest.mark.parametrize(
    "chosen", [one for one in SMALL if one.kind == "symmetric"], ids=lambda one: one.name
)
def test_symmetric_spots_have_their_centroid_at_the_centre(chosen):
    centres = np.array([[31.37, 30.82], [32.0, 31.5]])
    frames = render(chosen.shape, centres, np.array([0.3, 1.1]) * chosen.turned, 64)
    total = frames.sum(axis=(1, 2))
    x = (frames.sum(axis=1) @ np.arange(64)) / total
    y = (frames.sum(axis=2) @ np.arange(64)) / total
    # an Airy pattern's rings are cut by the frame
    far = 0.1 if chosen.name == "airy" else 1e-3
    np.testing.assert_allclose(np.column_stack([x, y]), centres, atol=far)


@pytest.mark.parametrize("chosen", [SETS["glare"], SETS["5 dead"], GRID_SETS[0]])
def test_a_seed_settles_the_frames_and_their_number_does_not(chosen):
    first = chosen.draw(7, 3)
    again = chosen.draw(7, 30)
    np.testing.assert_array_equal(first.frames, again.frames[:3])
    np.testing.assert_array_equal(first.centres, again.centres[:3])
    assert first.bound_px == again.bound_px
    assert (chosen.draw(8, 3).frames != first.frames).any()


def test_the_bound_is_that_of_the_reference_set():
    """By other code, with centres at other phases."""
    reference = REFERENCE_SETS["disc"]
    expected = reference.bound_px(reference.centres(24))
    assert SETS["disc"].draw(1, 1).bound_px == pytest.approx(expected, rel=0.02)


def test_broken_pixels_are_as_many_as_the_name_says():
    hot, dead = SETS["5 hot"].draw(3, 6), SETS["5 dead"].draw(3, 6)
    assert ((hot.frames == 4095).sum(axis=(1, 2)) == 5).all()
    y, x = np.indices((64, 64))
    for frame, centre in zip(dead.frames, dead.centres, strict=True):
        assert (frame[np.hypot(x - centre[0], y - centre[1]) < 6.0] == 0).sum() <= 5
        assert (frame[np.hypot(x - centre[0], y - centre[1]) < 8.0] == 0).sum() == 5


def test_without_the_sun_there_is_neither_a_place_nor_a_bound():
    for name, brightest in (("no Sun", 100), ("no Sun, 1 hot", 4095)):
        scenes = SETS[name].draw(4, 5)
        assert np.isnan(scenes.centres).all()
        assert math.isnan(scenes.bound_px)
        assert (scenes.frames.max(axis=(1, 2)) <= brightest).all()
    assert (np.sort(scenes.frames.reshape(5, -1))[:, -2] < 100).all()


@pytest.mark.parametrize(("name", "share"), [("ghost apart", 0.5), ("two apart", 1.0)])
def test_a_second_light_is_where_and_as_bright_as_it_should_be(name, share):
    chosen = SETS[name]
    centres, other = chosen.scenery(np.random.default_rng(5), 20, chosen)
    total = other.sum(axis=(1, 2))
    np.testing.assert_allclose(
        total, share * chosen.peak_e * math.pi * (8.0**2 + EDGE_PX**2), rtol=0.01
    )
    x, y = other.sum(axis=1) @ np.arange(64) / total, other.sum(axis=2) @ np.arange(64) / total
    apart = np.hypot(*(np.column_stack([x, y]) - centres).T)
    assert apart.min() > 17.9
    assert apart.max() < 24.1


def test_spots_over_the_edge_are_cut_there():
    centres = SETS["edge-cut"].draw(6, 50).centres
    inside = np.minimum(centres, 63.0 - centres).min(axis=1)
    assert inside.max() < 8.0
    assert inside.min() > -5.0
    assert (inside < 0).any()


@pytest.mark.slow
def test_spoilt_grids_are_spoilt_as_their_names_say():
    made = {chosen.spoilt: chosen for chosen in GRID_SETS if chosen.side == 5}
    light = {}
    for spoilt, chosen in made.items():
        scenes = chosen.draw(9, 10)
        assert np.isfinite(scenes.centres).all()
        light[spoilt] = (scenes.frames.astype(float) - 20.0).sum(axis=(1, 2)) / (
            2000.0 * math.pi * 4.0**2
        )
    for spoilt, spots in (("", 25), ("missing", 20), ("dark edge", 20)):
        np.testing.assert_allclose(light[spoilt], spots, rtol=0.06)
    # the edge twice may be out of view in part
    assert (light["double edge"] > 26.0).all()
    assert (light["dirty"] < 24.0).all()
    assert (light["extra"] > 25.5).any()


def test_grids_have_a_whole_and_a_fractional_pitch():
    assert {chosen.spacing_px % 1.0 == 0.0 for chosen in GRID_SETS} == {True, False}
    steps = GridSet(3, 16.0).offsets()
    np.testing.assert_allclose(np.diff(steps[:3, 0]), 16.0)
    assert len(GridSet(3, 16.0).geometry().apertures) == 9


def test_answers_are_judged_by_how_far_off_they_are():
    centres = np.array([[10.0, 10.0]] * 4)
    scenes = Scenes(np.zeros((4, 2, 2)), centres, 0.1)
    found = centres + np.array([[0.3, 0.4], [0.9, 0.9], [np.nan, np.nan], [0.0, 0.0]])
    error, wrong, missing = robustness.error_and_shares(found, scenes)
    assert error == pytest.approx(math.sqrt((0.09 + 0.16 + 0.81 + 0.81) / 6))
    assert (wrong, missing) == (0.25, 0.25)
    nothing = replace(scenes, centres=np.full((4, 2), np.nan))
    error, wrong, missing = robustness.error_and_shares(found, nothing)
    assert math.isnan(error)
    assert (wrong, missing) == (0.75, 0.25), "an answer where there is nothing is wrong"
    error, wrong, missing = robustness.error_and_shares(np.full((4, 2), np.nan), scenes)
    assert math.isnan(error)
    assert (wrong, missing) == (0.0, 1.0)


def row(**given):
    plain = {
        "group": "g",
        "set_name": "s",
        "kind": "symmetric",
        "method": "mirror",
        "over_bound": 1.0,
        "wrong": 0.0,
        "missing": 0.0,
        "us": 1.0,
        "over_opencv": 0.5,
        "frames": 300,
    }
    return RobustnessResult(**{**plain, **given})


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ({"over_bound": 1.15}, {"over_bound": 1.16}),
        ({"over_bound": 1.0}, {"over_bound": math.nan}),
        ({"kind": "stray", "over_bound": 2.5}, {"kind": "stray", "over_bound": 2.6}),
        ({"kind": "fault", "wrong": 0.001}, {"kind": "fault", "wrong": 0.0011}),
        ({"timed": True, "over_opencv": 1.0}, {"timed": True, "over_opencv": 1.01}),
    ],
)
def test_the_estimator_is_held_to_its_limits(good, bad):
    assert not any_broken(verdicts([row(**good)], {"mirror"}))
    assert any_broken(verdicts([row(**bad)], {"mirror"}))
    assert verdicts([row(**good)], {"mirror"})


def test_faults_are_judged_of_our_methods_and_their_options_alone():
    rows = [
        row(kind="fault", method=name, wrong=1.0) for name in ("ours", "ours with=it", "bcm", "sep")
    ]
    found = verdicts(rows, {"ours"})
    assert [verdict.what.partition(" on ")[0] for verdict in found] == ["ours", "ours with=it"]
    assert not verdicts([row(method="bcm", over_bound=9.0, timed=True)], {"ours"})


def test_averages_are_judged_against_the_smallest_grid_of_their_pitch():
    grids = [
        row(group=f"grids {pitch}", set_name=name, kind="grid", method="weighted-spots", **figures)
        for pitch, name, figures in (
            ("16", "2x2", {"over_bound": 1.0}),
            ("16", "5x5", {"over_bound": 1.2}),
            ("16.37", "2x2", {"over_bound": 2.0}),
            ("16.37", "5x5", {"over_bound": 2.2}),
        )
    ]
    found = verdicts(grids, ())
    assert [verdict.value for verdict in found] == pytest.approx([1.2, 1.1])
    assert [verdict.breaks for verdict in found] == [True, False]


def test_a_cell_says_what_is_wrong_and_what_is_missing_where_anything_is():
    assert robustness.cell(row(over_bound=1.234)) == "1.23"
    assert robustness.cell(row(over_bound=1582.4, wrong=0.75)) == "1582 !75"
    assert robustness.cell(row(over_bound=math.nan, wrong=0.001, missing=0.999)) == "- !0.1 ?99.9"


@pytest.mark.slow
def test_every_kind_of_frame_and_every_extractor_of_one_spot_is_there():
    kinds = {chosen.kind for chosen in FRAME_SETS}
    assert kinds == {"symmetric", "stray", "fault"}
    assert len(SETS) == len(FRAME_SETS)
    found = robustness.methods(SETS["disc"])
    assert {"mirror", "mirror for_sensor", "hough-circle", "tm"} <= set(found)
    assert {"opencv threshold + moments", "scipy curve_fit ellipse"} <= set(found)
    assert {"mcam", "fmms", "feic", "weighted-spots"} == set(
        robustness.grid_methods(GridSet(5, 16.0))
    )
    assert "mirror" in robustness.ours()
    assert "bcm" not in robustness.ours()


def test_scipys_elliptical_profile_follows_an_ellipse():
    centres, turns = np.array([[31.3, 30.8], [29.9, 32.4]]), np.array([0.4, 2.0])
    frames = 20.0 + 2000.0 * render(stretch(8.0, 60.0), centres, turns, 64)
    np.testing.assert_allclose(scipy_ellipse(frames), centres, atol=0.02)


@pytest.mark.slow
def test_the_same_seed_prints_the_same_errors(capsys):
    given = ["--sets", "disc", "no Sun", "--methods", "pm", "bctm", "--frames", "20"]
    tables = []
    for _ in range(2):
        robustness.main([*given, "--seed", "5", "--format", "json"])
        found = json.loads(capsys.readouterr().out)
        assert found["seed"] == 5
        keys = ("set_name", "method", "over_bound", "wrong", "missing", "frames")
        tables.append(json.dumps([[one[key] for key in keys] for one in found["measured"]]))
    assert tables[0] == tables[1]
    assert [one["set_name"] for one in found["measured"]] == ["disc", "disc", "no Sun", "no Sun"]


@pytest.mark.slow
def test_the_table_names_the_seed_and_a_broken_limit_is_the_status(monkeypatch, capsys):
    monkeypatch.setattr(robustness, "verdicts", lambda rows, ours: [])
    assert robustness.main(["--sets", "disc", "--methods", "pm", "--frames", "8"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("seed ")
    assert "shapes" in out
    bad = verdicts([row(over_bound=2.0)], ())
    monkeypatch.setattr(robustness, "verdicts", lambda rows, ours: bad)
    assert robustness.main(["--sets", "disc", "--methods", "pm", "--frames", "8"]) == 1
    assert "300 frames: 2, limit 1.15: BROKEN" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--sets", "dics"], r"\bdics\b.*\bdisc, gaussian\b"),
        (["--frames", "0"], "1; got 0"),
        (["--sets", "disc", "--methods", "x", "--frames", "1"], "no method named x"),
    ],
)
def test_what_is_not_there_is_refused(capsys, given, said):
    with pytest.raises(SystemExit):
        robustness.main(given)
    assert re.search(said, capsys.readouterr().err)


def test_what_is_held_to_limits_sees_every_frame_however_slow(monkeypatch):
    def middle(frames):
        return np.full((len(frames), 2), 31.5)

    monkeypatch.setattr(robustness, "_SECONDS", 0.0)
    monkeypatch.setattr(robustness, "methods", lambda _: {"mirror": middle, "bcm": middle})
    ours, other = robustness.measure(SETS["no Sun"], 1, 20)
    assert (ours.frames, other.frames) == (40, 8)
    assert (ours.wrong, other.wrong) == (1.0, 1.0)
