"""Patterns found once for several methods: the same numbers, and never another array's."""

import numpy as np
import pytest

from algorithms.extractors.frames.multi_spot import aperture_pattern
from algorithms.extractors.frames.multi_spot.image_correlation import ImageCorrelation
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.extractors.frames.multi_spot.pattern_memory import found_once, shared_patterns

APERTURES = tuple((12.0 * column, 12.0 * row, 4.0) for row in (-1, 0, 1) for column in (-1, 0, 1))


def frames(seed):
    """Four frames of nine Gaussian spots, moved at random."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:64, :64]
    drawn = np.full((4, 64, 64), 20.0)
    for n, (dx, dy) in enumerate(rng.uniform(-5, 5, (4, 2))):
        for ax, ay, _ in APERTURES:
            drawn[n] += 900 * np.exp(-((x - 31.5 - ax - dx) ** 2 + (y - 31.5 - ay - dy) ** 2) / 4.5)
    return drawn.astype(np.uint16)


@pytest.fixture
def searched(monkeypatch):
    """Count the searches that are really made."""
    calls = []
    find = aperture_pattern._find_pattern
    monkeypatch.setattr(
        aperture_pattern, "_find_pattern", lambda *given: calls.append(1) or find(*given)
    )
    return calls


def methods():
    design = {"apertures_px": APERTURES, "blur_px": 2.0}
    return MultipleCentroids(**design), ImageCorrelation(**design)


def test_methods_that_share_find_the_same_with_one_search(searched):
    seen = frames(1)
    alone = [method.extract(seen) for method in methods()]
    assert np.isfinite(alone).all()
    assert len(searched) == 2
    seen.flags.writeable = False
    with shared_patterns():
        together = [method.extract(seen) for method in methods()]
    assert len(searched) == 3
    assert np.array_equal(alone, together)
    for method in methods():
        method.extract(seen)
    assert len(searched) == 5, "nothing is kept when nobody shares"


def test_what_can_be_written_to_is_searched_again(searched):
    seen = frames(1)
    first, _ = methods()
    with shared_patterns():
        before = first.extract(seen)
        seen[:] = frames(2)
        after = first.extract(seen)
    assert len(searched) == 2
    assert not np.array_equal(before, after)
    assert np.array_equal(after, first.extract(frames(2)))


def test_a_view_that_is_locked_of_an_array_that_is_not_is_searched_again(searched):
    seen = frames(1)
    view = seen[:]
    view.flags.writeable = False
    with shared_patterns():
        for _ in range(2):
            methods()[0].extract(view)
    assert len(searched) == 2


def test_another_array_at_the_same_address_is_another():
    found = []
    with shared_patterns():
        for number in range(50):
            array = np.full((4, 1000), number)  # numpy hands the freed memory out again
            array.flags.writeable = False
            found.append(found_once(array, "settings", lambda value=number: value))
            del array
    assert found == list(range(50))


def test_the_batch_that_nobody_asked_for_longest_is_forgotten_first():
    batches = [np.full((4, 10), number) for number in range(5)]
    for batch in batches:
        batch.flags.writeable = False
    searches = []

    def asked(number):
        return found_once(batches[number], "settings", lambda: searches.append(number) or number)

    with shared_patterns():
        for number in (0, 1, 2, 3, 0, 4):  # one more than are kept
            asked(number)
        assert searches == [0, 1, 2, 3, 4]
        for number in (4, 0, 3, 2):
            asked(number)
        assert searches == [0, 1, 2, 3, 4]
        asked(1)
    assert searches == [0, 1, 2, 3, 4, 1]
