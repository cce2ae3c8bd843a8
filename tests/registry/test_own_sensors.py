"""Studies whose sensor is simulated for them alone, and dimensions that nobody knows."""

import re

import pytest

from benchmark.plan.parts import study_parts
from registry.fidelity.evidence import UNKNOWN_SHARE
from registry.fidelity.particulars import DIMENSIONS
from registry.resolution import Resolution


def test_unknown_dimensions_stand_in_a_sentence_of_their_own(
    everything: dict[str, Resolution],
) -> None:
    said = {
        key: found.fidelity.sentence
        for key, found in everything.items()
        if any(one.value == DIMENSIONS for one in found.fidelity.departures)
    }
    assert len(said) > 50
    own = re.compile(r"[.] (\d+) of (\d+) dimensions of its sensor are not known [(][^.]*[.]$")
    for key, sentence in said.items():
        found = own.search(sentence)
        assert found, (key, sentence)
        assert int(found[1]) >= UNKNOWN_SHARE * int(found[2])
    without = [f.fidelity.sentence for key, f in everything.items() if key not in said]
    assert not any("dimensions of its sensor" in sentence for sentence in without)


@pytest.mark.parametrize(
    ("key", "dataset"),
    [
        ("Lu2017a", "pd-maskless-two-pyramids"),
        ("Rufino2017", "cmos-single-aperture-naples"),
        ("Enright2007a", "ccd-multi-slit-ss-411"),
        ("deBoer2013", "cmos-single-aperture-minidss"),
        ("Xie2012", "cmos-single-aperture-micro-dss"),
    ],
)
def test_a_study_with_a_sensor_of_its_own_runs_there_and_nowhere_else(
    everything: dict[str, Resolution], key: str, dataset: str
) -> None:
    assert {name for one in everything[key].pipelines for name in one.datasets} == {dataset}
    assert everything[key].gaps == ()


def test_standard_studies_stand_on_no_sensor_of_a_single_study(
    everything: dict[str, Resolution],
) -> None:
    follows = {key for preset in study_parts().presets.values() for key in preset.follows}
    own = frozenset(study_parts().presets)
    for key, found in everything.items():
        used = {name for one in found.pipelines for name in one.datasets}
        assert (used <= own and bool(used)) if key in follows else used.isdisjoint(own)
