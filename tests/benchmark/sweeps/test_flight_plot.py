"""The picture of errors along a flight shows what its numbers are."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark.sweeps import flight_plot


@pytest.mark.slow
def test_errors_along_a_flight_end_with_the_light_for_single_samples_alone() -> None:
    found = flight_plot.along(*flight_plot.PANELS[0])
    assert {len(column) for column in found.values()} == {1740}
    eclipse = found["eclipse"] > 0
    assert np.isnan(found["single"][eclipse]).all()
    assert np.isfinite(found["filtered"][eclipse]).any()
    assert np.nanmean(found["filtered"]) < 0.3 * np.nanmean(found["single"])
    # two axes' 1-sigma is of the size of the error
    ratio = np.nanmean(found["filtered"] ** 2) / np.nanmean(found["deviation"] ** 2)
    assert 0.2 < ratio < 5.0


@pytest.mark.slow
def test_the_picture_has_a_panel_for_each_flight() -> None:
    text = flight_plot.picture()
    for dataset, _, single, filtered in flight_plot.PANELS:
        for said in (f"{dataset}, nominal", single, filtered):
            assert said in text
