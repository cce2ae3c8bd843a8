"""A threshold is a fraction of the peak: at one or above, nothing would be left of a spot."""

import pytest

from algorithms.extractors.frames.centroid import ThresholdedCentroid


@pytest.mark.parametrize("threshold", [-0.1, 1.0, 1.5, float("nan")])
def test_a_threshold_that_no_pixel_passes_or_that_is_none_is_refused(threshold):
    with pytest.raises(ValueError, match=r"in \[0, 1\); got"):
        ThresholdedCentroid(threshold=threshold)


@pytest.mark.parametrize("threshold", [0.0, 0.5, 0.999])
def test_every_fraction_below_one_is_taken(threshold):
    assert ThresholdedCentroid(threshold=threshold).threshold == threshold
