"""What results are of: one line a component, and the key that tells what is out of date."""

from itertools import pairwise

import fake_plan
import pytest
from fake_atlas import Diodes
from fake_results import cell, components

from benchmark.metrics.score import METRIC_VERSION
from benchmark.results.components import (
    KEYED,
    SCHEMA_VERSION,
    Components,
    ComponentsError,
    current,
)
from benchmark.results.modules import STAGES


def test_components_are_read_back_as_they_were_written(tmp_path):
    path = tmp_path / "components.json"
    path.write_text(components().text())
    assert Components.read(path) == components()
    path.write_text(Components().text())
    assert Components.read(path) == Components()
    assert Components.read(tmp_path / "nothing.json") == Components()


@pytest.mark.parametrize("changed", [*STAGES, "d", "e", "m"])
def test_a_score_s_key_depends_on_all_it_was_measured_with(changed):
    before = components().cell_key(cell())
    assert components(**{changed: "other"}).cell_key(cell()) != before
    assert components(other="other", a="other", s="other").cell_key(cell()) == before


@pytest.mark.parametrize(
    ("changed", "kind"),
    [
        *((stage, f"code of {stage}") for stage in STAGES),
        ("d", "dataset"),
        ("e", "extractor"),
        ("m", "model"),
    ],
)
def test_what_has_changed_since_a_key_was_made_is_named(changed, kind):
    known = components(d="1", e="2", m="3")
    key = known.cell_key(cell())
    assert known.changed_parts(key, cell()) == ()
    since = components(**{"d": "1", "e": "2", "m": "3", changed: "0f"})
    assert since.changed_parts(key, cell()) == (kind,)
    assert components(data="x", d="1", e="4", m="3").changed_parts(key, cell()) == (
        "code of data",
        "extractor",
    )
    assert known.changed_parts("a key of another layout", cell()) == tuple(KEYED)


def test_the_key_of_a_stage_begins_that_of_the_next_and_knows_nothing_of_what_follows():
    keys = [components().stage_key(stage, cell()) for stage in STAGES]
    assert keys[-1] == components().cell_key(cell())
    assert all(later.startswith(f"{one}-") for one, later in pairwise(keys))
    assert [KEYED[name] for name in KEYED] == sorted(KEYED.values(), key=list(STAGES).index)
    for name, moved in (("d", 0), ("data", 0), ("e", 1), ("features", 1), ("m", 2), ("scores", 3)):
        other = components(**{name: "x"})
        now = [other.stage_key(stage, cell()) for stage in STAGES]
        assert [one != two for one, two in zip(keys, now, strict=True)] == [
            number >= moved for number in range(len(STAGES))
        ], name


def test_current_components_are_of_the_code_as_it_is():
    parts = fake_plan.parts()
    now = current(parts)
    assert now == current(parts)
    assert set(now.extractors) == set(parts.extractors)
    assert now.datasets["fake-diodes"].items() >= {
        "version": 1, "detector": "PD", "mask": "Maskless", "half_fov_deg": 25.0,
    }.items()  # fmt: skip
    newer = current(fake_plan.parts(presets=(Diodes(seed=8),)))
    assert [name for name, *_ in now.differences(newer)] == [
        f"datasets/fake-diodes/{name}" for name in Diodes().conditions
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("{", "[", "not JSON"),
        (
            f'"schema": {SCHEMA_VERSION}',
            '"schema": 1',
            f"schema {SCHEMA_VERSION} .*{METRIC_VERSION}",
        ),
        ('"metric": ', '"metric": 9', "expected schema"),
        ('"digest": "of e"', '"digest": 5', "extractors/e/digest: .*valid string, got 5"),
        ('"c": "of dc"', '"c": 5', "datasets/d/conditions/c: .*valid string, got 5"),
        ('"digest": "of e"', '"digest": "of e", "sum": 1', "extractors/e/sum: Extra inputs"),
    ],
)
def test_a_file_of_something_else_is_an_error_that_names_it(tmp_path, old, new, message):
    path = tmp_path / "components.json"
    text = components().text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ComponentsError, match=message) as caught:
        Components.read(path)
    assert str(path) in str(caught.value)
