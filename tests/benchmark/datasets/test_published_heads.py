"""Every data set is the one that was published: the same first samples, and the same bound."""

import pytest

from benchmark import datasets
from benchmark.plan.parts import Parts
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import pinning

#: Of which four samples of a split take seconds: tables of holes, light from the Earth, megapixels.
SECONDS = {
    "ccd-multi-aperture", "ccd-multi-slit-orbit", "ccd-orbit", "ccd-single-aperture",
    "cmos-compound-eye", "cmos-encoded", "cmos-encoded-sizes", "cmos-l-slit", "cmos-multi-aperture",
    "cmos-multi-aperture-glass", "cmos-single-aperture", "cmos-single-aperture-thick",
    "cmos-slit", "event-l-slit", "event-single-aperture", "pd-orbit", "pva-orbit", "qpd-orbit",
}  # fmt: skip
#: Of which all conditions take seconds: light from the Earth, motion, diffraction.
LONG = SECONDS | {
    "ccd-lens", "ccd-multi-slit", "ccd-periodic", "ccd-vernier", "cmos-encoded",
    "cmos-encoded-oblique", "cmos-lens", "cmos-single-aperture-pinhole", "event-l-slit",
    "ltf-maskless-cube", "pd-albedo-orbit", "pd-code-dial", "pd-maskless-cube",
    "pd-maskless-pyramid", "pd-orbit", "pda-n-slit", "pva-maskless-panels",
    "pva-maskless-pyramid", "pva-maskless-sphere",
}  # fmt: skip


def by_cost(costly):
    return [
        pytest.param(name, marks=pytest.mark.slow) if name in costly else name
        for name in datasets.names()
    ]


@pytest.fixture(scope="module")
def pins():
    return Store(PUBLISHED).pins()


@pytest.mark.parametrize("name", by_cost(SECONDS))
def test_the_first_samples_are_those_that_were_published(pins, name):
    preset = datasets.get(name)
    place = name, preset.conditions[0], "test"
    assert pins[place].version == preset.version
    assert pinning.changed_heads({place: pins[place]}, [preset]) == {}


@pytest.mark.parametrize("name", by_cost(LONG))
def test_no_data_or_bound_changed_in_silence(pins, name):
    """The first samples of every split: a change of the simulator needs a new version."""
    preset = datasets.get(name)
    assert {place for place in pins if place[0] == name} == pinning.places(
        Parts({name: preset}, {}, {})
    )
    assert {pins[place].version for place in pins if place[0] == name} == {preset.version}
    assert pinning.changed_heads(pins, [preset]) == {}
