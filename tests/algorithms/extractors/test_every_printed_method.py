"""Each of the survey's printed extractors is transcribed among the tests of its method."""

from __future__ import annotations

from pathlib import Path

import pytest

from algorithms.discovery import discover_extractors

HERE = Path(__file__).parent
#: Where the pseudocode of each of the survey's 19 assessed methods is written out.
TRANSCRIBED = {
    "Voltage balance": "test_photodiode.py",
    "PD": "test_profile_lines.py",
    "PPE": "test_peak_position.py",
    "BCM": "test_centroids.py",
    "BCTM": "test_centroids.py",
    "MCAM": "test_multi_spot_oracles.py",
    "DBCM": "test_single_spots.py",
    "MT-ACM": "test_single_spots.py",
    "PM": "test_centroids.py",
    "ESCM": "test_event_centroid.py",
    "BSCM": "test_camera_black_sun.py",
    "BHT": "test_camera_hough.py",
    "CHT": "test_camera_hough.py",
    "FMMS": "test_multi_spot_oracles.py",
    "IFM": "test_centroids.py",
    "TM": "test_single_spots.py",
    "FEIC": "test_multi_spot_oracles.py",
    "Linear-phase": "test_printed_spectra.py",
    "Eigen-analysis": "test_printed_spectra.py",
}
LABELS = {
    "Voltage balance": "alg:VB",
    "PD": "alg:PDsp",
    "DBCM": "alg:DBCM",
    "MT-ACM": "alg:MTACM1",
    "ESCM": "alg:ECM",
    "BSCM": "alg:BCSM",
    "FMMS": "alg:FMMS2",
    "Linear-phase": "alg:linearphase",
    "Eigen-analysis": "alg:eigen",
}


def test_they_are_nineteen():
    assert len(TRANSCRIBED) == 19


@pytest.mark.parametrize("name", TRANSCRIBED)
def test_the_pseudocode_is_named_where_it_is_transcribed(name):
    label = LABELS.get(name, f"alg:{name}")
    assert label in (HERE / TRANSCRIBED[name]).read_text(encoding="utf-8")
    assert any(
        label in extractor.about.labels or f"{label[:-1]}1" in extractor.about.labels
        for extractor in discover_extractors().values()
    )
