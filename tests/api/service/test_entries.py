"""Every entry can be found, by its own name and with a slip in it."""

import pytest

from api.service.index.entries import KINDS
from api.service.knowledge import Knowledge


@pytest.fixture(scope="module")
def known(atlas):
    return atlas.app.state.knowledge


def test_every_thing_is_there_once(known: Knowledge):
    entries = known.index.entries
    assert len({(entry.kind, entry.id) for entry in entries}) == len(entries)
    counted = {kind: sum(entry.kind == kind for entry in entries) for kind in KINDS}
    assert counted["study"] == len(known.of("all").facts.studies)
    assert counted["algorithm"] == len(known.catalogue.extractors) + len(known.catalogue.models)
    assert counted["dataset"] == len(known.measurements.presets)
    assert counted["claim"] == len(known.measurements.claims)
    assert counted["word"] >= sum(len(words) for words in known.taxonomy.to_dict().values())


def test_every_title_finds_its_study(known):
    for study in known.facts.studies.values():
        first = known.index.find(study.title or study.key, kinds=("study",))[0].entry
        # Two studies may share a title.
        assert first.title == (study.title or study.key)
        assert known.index.find(study.key)[0].entry.id == study.key


def test_names_with_two_letters_swapped_are_found(known):
    names = [n for n in known.catalogue.models if n.isalpha() and len(n) >= 5]
    assert len(names) > 5
    for name in names:
        slipped = name[:2] + name[3] + name[2] + name[4:]
        if slipped == name:
            continue
        hits = [hit.entry.id for hit in known.index.find(slipped, kinds=("algorithm",))]
        assert name in hits[:5], (name, slipped, hits[:5])
