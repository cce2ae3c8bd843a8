"""The catalogue lists what is declared, by the taxonomy, and refuses what it cannot place."""

import pytest
from stand_ins import (
    BCTM,
    EXTRACTORS,
    MODELS,
    SPM,
    SPOT,
    implementation,
    stand_ins,
)

from algorithms.contract import Observation
from registry.studies import Facts
from registry.taxonomy import InvalidValueError


def test_the_catalogue_lists_what_is_declared_and_what_lacks(survey: Facts) -> None:
    known = stand_ins(survey, EXTRACTORS, MODELS)
    listed = [entry.to_dict() for entry in known.implementations("extractor")]
    assert [entry["taxonomy"] for entry in listed] == ["Direct", "Voltage balance", "BCM", "BCTM"]
    assert listed[-1] == {
        "name": "bctm",
        "title": "Thresholded centroid (our variant)",
        "role": "extractor",
        "taxonomy": "BCTM",
        "category": "Centroid detection",
        "observation": "frames",
        "kind": "spot",
        "accepts": None,
        "labels": ["eq:x"],
        "label_names": ["eq:x"],  # the survey has no such label
        "studies": [],
        "origin": "survey",
        "version": 1,
        "summary": "Says what it is.",
    }
    assert known.implementations("model")[0].accepts == ("balance", "spot")
    lacking = known.gaps()
    assert ("model", "ECM") not in lacking  # its kinds are there
    assert ("model", "ICM") in lacking
    assert ("model", "None") not in lacking
    assert ("extractor", "BCTM") not in lacking
    assert len(lacking) == (20 - 1 - 4) + (33 - 1 - 6)


def test_the_catalogue_refuses_what_it_cannot_place(survey: Facts) -> None:
    stray = implementation("stray", "BCTN", Observation.FRAMES, frozenset({SPOT}))
    with pytest.raises(InvalidValueError, match=r"extractor stray: .*did you mean 'BCT?M'"):
        stand_ins(survey, [stray], [])
    with pytest.raises(ValueError, match=r"extractor.*model.*\bbctm\b"):
        stand_ins(survey, [BCTM], [implementation("bctm", "SPM", None, frozenset({SPOT}))])
    with pytest.raises(InvalidValueError, match="did you mean 'bctm'"):
        stand_ins(survey, [BCTM], []).extractor("bctn")
    with pytest.raises(InvalidValueError, match="did you mean 'spm'"):
        stand_ins(survey, [], [SPM]).model("spn")
