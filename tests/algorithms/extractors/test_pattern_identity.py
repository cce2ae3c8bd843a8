"""Which aperture cast which spot, with lines of apertures dark, doubled or reflected.

Every frame is drawn afresh; an answer a quarter of the pitch off has the wrong identity.
"""

import numpy as np
import pytest
from scipy.special import ndtr

from algorithms.extractors.frames.multi_spot.image_correlation import ImageCorrelation
from algorithms.extractors.frames.multi_spot.mean_shift import MeanShift
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.extractors.frames.multi_spot.weighted_spots import WeightedSpots
from algorithms.measurement import QualityFlag

WIDTH = 7.0
FRAMES = 200


def grid(side, pitch):
    steps = (np.arange(side) - (side - 1) / 2) * pitch
    return tuple((float(x), float(y), WIDTH) for y in steps for x in steps)


def draw(rng, shape, spots):
    """Noisy frame of spots (x, y, light), discs of the apertures' width with a soft rim."""
    frame = np.full(shape, 20.0)
    for x, y, light in spots:
        if light and -7 < x < shape[1] + 6 and -7 < y < shape[0] + 6:
            left, top = max(int(x) - 7, 0), max(int(y) - 7, 0)
            v, u = np.mgrid[top : min(int(y) + 9, shape[0]), left : min(int(x) + 9, shape[1])]
            frame[v, u] += 600.0 * light * ndtr((WIDTH / 2 - np.hypot(u - x, v - y)) / 0.7)
    return np.clip(np.rint(frame + rng.normal(0, 8.0, shape)), 0, 4095).astype(np.uint16)


class Scenes:
    """Frames of a grid with one edge dark, doubled or reflected, and where the grid stands."""

    def __init__(self, seed, side, pitch, *, dark=False, doubled=0.0, opposite=0.0, missing=0.0):
        rng = np.random.default_rng([seed, side, round(100 * pitch)])
        self.apertures = grid(side, pitch)
        self.pitch = pitch
        places = np.array(self.apertures)[:, :2]
        edge_px = (side - 1) / 2 * pitch
        shape = (round(side * pitch) + 50, round(side * pitch) + 56)
        frames, self.places, self.whole = [], [], []
        for _ in range(FRAMES):
            # up to more than a pitch of the grid is out of view
            low = edge_px + 6.0 - 1.4 * pitch
            place = rng.uniform(low, (shape[1] - 1 - low, shape[0] - 1 - low))
            axis, sign = rng.integers(2), rng.choice((-1.0, 1.0))
            at = places[:, axis] * sign
            step = np.zeros(2)
            step[axis] = sign * pitch
            light = np.where(rng.random(len(places)) < missing, 0.0, 1.0)
            if dark:
                light[at == at.max()] = 0.0
            spots = [(*(place + p), s) for p, s in zip(places, light, strict=True)]
            spots += [(*(place + p + step), doubled) for p in places[at == at.max()]]
            spots += [(*(place + p - step), opposite) for p in places[at == at.min()]]
            frames.append(draw(rng, shape, spots))
            self.places.append(place)
            room = np.array(shape[::-1]) - 1 - place
            self.whole.append(min(place.min(), room.min()) > edge_px + WIDTH)
        self.frames = np.array(frames)

    def shares(self, found):
        """Share of frames answered with the wrong identity, and of those all in view answered."""
        answered = np.isfinite(found[:, 0])
        away = np.abs(np.where(answered[:, None], found, 0.0) - self.places).max(axis=1)
        wrong = answered & (away > self.pitch / 4)
        return wrong.mean(), answered[np.array(self.whole)].mean()


every_grid = pytest.mark.parametrize(
    ("side", "pitch"), [(2, 16.37), (5, 16.0), pytest.param(5, 16.37, marks=pytest.mark.slow)]
)


@every_grid
def test_a_dark_edge_is_never_taken_for_a_mask_moved_by_a_pitch(side, pitch):
    """The same frame is that of a whole mask of which one line is out of view."""
    for missing in (0.0, 0.1):
        scenes = Scenes(201, side, pitch, dark=True, missing=missing)
        wrong, _ = scenes.shares(
            MultipleCentroids(scenes.apertures, faulty_lines=1).extract(scenes.frames)
        )
        assert wrong == 0.0


@every_grid
def test_a_whole_mask_in_view_is_answered(side, pitch):
    scenes = Scenes(202, side, pitch)
    wrong, answered = scenes.shares(
        MultipleCentroids(scenes.apertures, faulty_lines=1).extract(scenes.frames)
    )
    assert wrong == 0.0
    assert answered == 1.0


@pytest.mark.slow
@every_grid
def test_a_doubled_edge_is_told_unless_the_other_edge_is_out_of_view(side, pitch):
    """Then the frame is that of the mask moved by a pitch: two faulty lines must be allowed for."""
    scenes = Scenes(203, side, pitch, doubled=1.0)
    extractor = MultipleCentroids(scenes.apertures, faulty_lines=1)
    found = extractor.extract(scenes.frames)
    whole = np.array(scenes.whole)
    wrong = np.abs(found - scenes.places).max(axis=1) > pitch / 4  # not where NaN
    assert not wrong[whole].any()
    if side == 2:  # two lines are the whole mask
        return
    cautious = MultipleCentroids(scenes.apertures, faulty_lines=2)
    assert scenes.shares(cautious.extract(scenes.frames))[0] == 0.0


def test_a_doubled_edge_makes_the_very_frame_of_a_mask_moved_by_a_pitch():
    """Where the other edge is out of view no method can tell them."""
    apertures = np.array(grid(5, 16.0))[:, :2]
    place, step = np.array([34.5, 60.2]), np.array([16.0, 0.0])  # the first column is out of view
    first = [(*(place - step + a), 1.0) for a in apertures]
    extra = [(*(place + a), 1.0) for a in apertures if a[0] == apertures[:, 0].max()]
    whole = [(*(place + a), 1.0) for a in apertures]
    doubled = draw(np.random.default_rng(208), (120, 130), first + extra)
    moved = draw(np.random.default_rng(208), (120, 130), whole)
    np.testing.assert_array_equal(doubled, moved)


@pytest.mark.slow
@every_grid
def test_an_identity_without_a_flag_is_right(side, pitch):
    for seed, faults in ((210, {"doubled": 1.0}), (211, {"dark": True}), (212, {})):
        scenes = Scenes(seed, side, pitch, **faults)
        extractor = MultipleCentroids(scenes.apertures, faulty_lines=1)
        found = extractor.measure(scenes.frames)
        unsure = found.flags == int(QualityFlag.AMBIGUOUS_PATTERN)
        wrong = np.abs(found.features - scenes.places).max(axis=1) > pitch / 4
        assert not (wrong & ~unsure).any()
        np.testing.assert_array_equal(found.features, extractor.extract(scenes.frames))


@pytest.mark.parametrize("method", [MultipleCentroids, MeanShift, ImageCorrelation, WeightedSpots])
def test_an_ambiguous_pattern_and_a_dark_frame_are_different_flags(method):
    apertures = grid(4, 16.0)
    own = {MeanShift: {"bandwidth_px": 8.0}, ImageCorrelation: {"correlations": 4}}
    rng = np.random.default_rng(213)
    frames = [
        draw(rng, (120, 120), [(*(np.array(place) + a[:2]), 1.0) for a in apertures])
        for place in ((60.3, 59.8), (18.3, 59.8), (30.3, 59.8))  # amid, cut by a line, at the edge
    ]
    frames.append(draw(rng, (120, 120), []))
    found = method(apertures, faulty_lines=1, **own.get(method, {})).measure(np.array(frames))
    unsure = int(QualityFlag.AMBIGUOUS_PATTERN)
    assert found.flags.tolist() == [0, unsure, unsure, int(QualityFlag.NO_SPOT)]
    assert np.isfinite(found.features[:, 0]).tolist() == [True, False, True, False]


@pytest.mark.slow
@pytest.mark.parametrize("pitch", [16.0, 16.37])
def test_reflections_dimmer_than_the_spots_mislead_nobody(pitch):
    for faults in ({"doubled": 0.6}, {"dark": True, "opposite": 0.5}):
        scenes = Scenes(204, 5, pitch, **faults)
        wrong, _ = scenes.shares(
            MultipleCentroids(scenes.apertures, faulty_lines=1).extract(scenes.frames)
        )
        assert wrong == 0.0


@pytest.mark.parametrize("method", [MultipleCentroids, MeanShift, ImageCorrelation, WeightedSpots])
def test_missing_dirty_and_stray_spots_do_not_move_the_pattern(method):
    apertures = grid(5, 16.0)
    own = {MeanShift: {"bandwidth_px": 8.0}, ImageCorrelation: {"correlations": 4}}
    rng = np.random.default_rng(205)
    frames, places = [], rng.uniform(56.0, 60.0, (40, 2))
    for place in places:
        light = np.ones(25)
        light[rng.choice(25, 6, replace=False)] = 0.0, 0.0, 0.0, 0.5, 0.6, 0.7
        spots = [(*(place + a[:2]), s) for a, s in zip(apertures, light, strict=True)]
        stray = place - np.array([48.0, 0.0]) + rng.uniform(-3.0, 3.0, 2)
        frames.append(draw(rng, (116, 118), [*spots, (*stray, 1.0)]))
    found = method(apertures, faulty_lines=1, **own.get(method, {})).extract(np.array(frames))
    seen = np.isfinite(found[:, 0])
    assert seen.mean() > 0.9
    assert np.abs(found - places)[seen].max() < 0.5


# Tracking

trackers = pytest.mark.parametrize(
    "make",
    [
        lambda a: MeanShift(a, bandwidth_px=8.0, faulty_lines=1),
        lambda a: ImageCorrelation(a, correlations=4, faulty_lines=1),
    ],
    ids=["fmms", "feic"],
)


@trackers
def test_steps_of_more_than_half_a_pitch_are_followed_to_the_right_spot(make):
    rng = np.random.default_rng(206)
    apertures = grid(4, 16.0)
    places = rng.uniform(46.0, 84.0, (40, 2))  # steps of up to two pitches, all in view
    steps = np.abs(np.diff(places, axis=0)).max(axis=1)
    assert (steps > 8.0).sum() > 20
    frames = [draw(rng, (130, 130), [(*(p + a[:2]), 1.0) for a in apertures]) for p in places]
    found = make(apertures).track(np.array(frames))
    assert np.abs(found - places).max() < 0.5  # every frame is answered


@trackers
def test_a_frame_that_leaves_several_open_has_the_one_next_to_the_last(make):
    """An edge leaves the field slowly: it is known; after a jump or a dark frame it is not."""
    rng = np.random.default_rng(207)
    apertures = grid(4, 16.0)
    across = np.append(np.arange(40.0, 17.0, -1.5), [30.0, 18.0])
    places = np.column_stack([across + 0.3, np.full(len(across), 52.2)])
    frames = [draw(rng, (100, 104), [(*(p + a[:2]), 1.0) for a in apertures]) for p in places]
    frames[-2][:] = 20
    extractor = make(apertures)
    found = extractor.track(np.array(frames))
    assert np.isnan(extractor.extract(frames[-3:-2])).all()  # alone, it leaves two open
    assert np.abs(found[:-2] - places[:-2]).max() < 0.5
    assert np.isnan(found[-2:]).all()
