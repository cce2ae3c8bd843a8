"""The record of the sensors of single studies is of the code as it is, and of their pipelines."""

from __future__ import annotations

import pytest

from benchmark.contract import ON_BENCH
from benchmark.leaderboard import scope, study_record
from benchmark.plan.parts import every_part, installed_parts, split_parts, study_parts
from benchmark.results.store import PUBLISHED, PUBLISHED_STUDIES, Store
from benchmark.running import pinning
from benchmark.suites.selection import suite


def test_the_record_is_as_its_commands_wrote_it_and_of_the_code_as_it_is() -> None:
    assert study_record.check(stored_only=True) == []


@pytest.mark.parametrize("name", study_parts().presets)
def test_the_first_samples_of_a_study_s_sensor_are_those_that_were_published(name: str) -> None:
    pins = {at: pin for at, pin in Store(PUBLISHED_STUDIES).pins().items() if at[0] == name}
    preset = study_parts().presets[name]
    assert {condition for _, condition, _ in pins} == set(preset.conditions)
    assert pinning.changed_heads(pins, [preset]) == {}


def test_only_pipelines_of_the_studies_are_scored() -> None:
    used = study_record.runs(study_parts())
    scored = {(c.dataset, c.extractor, c.model) for c in Store(PUBLISHED_STUDIES).scores()}
    assert scored == used
    assert {dataset for dataset, *_ in used} == set(study_parts().presets)
    assert ("ccd-multi-slit-ss-411", "ppe", "optical + multi-slit") in used


def test_they_are_measured_by_the_rules_of_the_leaderboard() -> None:
    cells = set(Store(PUBLISHED_STUDIES).scores())
    for name, preset in study_parts().presets.items():
        own = {cell for cell in cells if cell.dataset == name}
        assert {cell.condition for cell in own} == {*preset.conditions, ON_BENCH}
        units = {cell.unit for cell in own if cell.condition == preset.conditions[0]}
        assert units == set(range(scope.UNITS))


def test_neither_record_holds_cells_of_the_other() -> None:
    names = {cell.dataset for cell in Store(PUBLISHED_STUDIES).scores()}
    assert names.isdisjoint(cell.dataset for cell in Store(PUBLISHED).scores())
    standard, studies = split_parts(every_part())
    assert standard.presets == installed_parts().presets
    assert studies.presets == study_parts().presets


@pytest.mark.slow
def test_all_that_is_published_is_the_standard_suite_and_quick_does_without() -> None:
    scores = {**Store(PUBLISHED).scores(), **Store(PUBLISHED_STUDIES).scores()}
    assert set(suite("standard").select(scores, every_part())) == set(scores)
    quick = {cell.dataset for cell in suite("quick").select({}, every_part())}
    assert quick.isdisjoint(study_parts().presets)
