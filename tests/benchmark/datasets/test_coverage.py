"""The coverage table is what mapping and datasets say."""

from __future__ import annotations

import csv
from pathlib import Path

import survey_data
from benchmark import datasets
from benchmark.datasets.coverage import coverage
from benchmark.plan.combinations import scorable_plan
from registry.resolution import resolve_all
from registry.studies import facts

OURS = Path(survey_data.__file__).parent


def mapped():
    """(detector, mask) -> studies, from the table itself."""
    values = {}
    with (OURS / "attributes.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["attribute"] in {"detector", "mask"} and row["value"]:
                values.setdefault(row["study"], {}).setdefault(row["attribute"], []).append(
                    row["value"]
                )
    pairs = {}
    with (OURS / "architectures.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            pairs.setdefault((row["detector"], row["mask"]), set()).add(row["study"])
            values.pop(row["study"], None)
    for study, found in values.items():
        for detector in found.get("detector", ()):
            for mask in found.get("mask", ()):
                pairs.setdefault((detector, mask), set()).add(study)
    return pairs


def values_of(attribute):
    with (OURS / "taxonomy.csv").open(encoding="utf-8", newline="") as file:
        return [row["value"] for row in csv.DictReader(file) if row["attribute"] == attribute]


def test_every_pair_of_a_mapped_study_is_there_with_its_studies():
    found = {(pair.detector, pair.mask): set(pair.studies) for pair in coverage().used}
    assert found == mapped()


def test_every_pair_is_simulated():
    for pair in coverage().pairs:
        assert pair.datasets, pair
        for name in pair.datasets:
            preset = datasets.get(name)
            assert (preset.detector, preset.mask) == (pair.detector, pair.mask)


def test_all_detectors_and_all_masks_are_simulated():
    found = coverage()
    assert list(found.detectors) == values_of("detector")
    assert list(found.masks) == values_of("mask")
    assert len(found.detectors) == len(found.masks) == 10
    assert all(found.detectors.values())
    assert all(found.masks.values())
    assert "10 of 10 detectors and 10" in found.sentence()


def test_pairs_that_no_sensor_of_a_study_has_are_not_mapped():
    assert ("PDA", "Maskless") not in mapped()  # Post2013's sensors do not cross
    assert ("PVA", "N-Slit") not in mapped()


def test_a_data_set_follows_studies_of_its_own_architecture():
    resolved = resolve_all(scorable_plan())
    for preset in map(datasets.get, datasets.names()):
        for key in preset.follows:
            pairs = {(p.detector, p.mask) for p in resolved[key].pipelines}
            pairs.update(facts().studies[key].architectures)
            assert (preset.detector, preset.mask) in pairs, (preset.name, key)
