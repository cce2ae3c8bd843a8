"""In what order the registry answers, and its small refusals: tables small enough to be read."""

from collections.abc import Callable, Mapping

import pytest

from registry.flows import allowed_values, chart, flows
from registry.studies import Facts
from survey_data.nearest import nearest_name

Rows = list[Mapping[str, list[str]]]
Build = Callable[[Rows], Facts]

#: Out of the taxonomy's order on purpose; S2 has no mask, S3 no task.
TABLE: Rows = [
    {"task": ["Cost", "Accuracy"], "detector": ["PD"], "mask": ["Slit", "Lens", "Encoded"]},
    {"task": ["Accuracy"], "detector": ["PD", "CMOS"], "mask": ["Encoded"]},
    {"task": ["Cost"], "detector": ["CMOS"], "mask": []},
    {"task": [], "detector": ["CMOS"], "mask": ["Lens"]},
]


def in_order(facts: Facts, level: str, values: set[str]) -> list[str]:
    return [value for value in facts.taxonomy.values(level) if value in values]


def test_nodes_and_links_stand_in_the_order_of_the_chart(facts_of: Build) -> None:
    facts = facts_of(TABLE)
    found = chart("task", facts=facts)
    expected = {
        "task": in_order(facts, "task", {"Cost", "Accuracy"}),
        "detector": in_order(facts, "detector", {"PD", "CMOS"}),
        "mask": in_order(facts, "mask", {"Slit", "Lens", "Encoded"}),
    }
    ids = [f"{level}:{value}" for level, values in expected.items() for value in values]
    assert [node.id for node in found.nodes] == ids
    assert [(node.level, node.value) for node in found.nodes] == [
        (level, value) for level, values in expected.items() for value in values
    ]
    place = {name: at for at, name in enumerate(ids)}
    ends = [(place[link.source], place[link.target]) for link in found.links]
    assert ends == sorted(ends)
    assert len(set(ends)) == len(ends) == 4 + 5
    assert {node.id: node.count for node in found.nodes} == {
        "task:Cost": 2, "task:Accuracy": 2, "detector:PD": 2, "detector:CMOS": 3,
        "mask:Slit": 1, "mask:Lens": 2, "mask:Encoded": 2,
    }  # fmt: skip
    assert found.studies == ("S0", "S1", "S2", "S3")
    assert [(left.level, left.studies) for left in found.left_out] == [
        ("task", ("S3",)),
        ("mask", ("S2",)),
    ]
    assert found.left_out[0].to_dict() == {"level": "task", "count": 1, "studies": ["S3"]}


def test_fractions_of_a_study_add_up_to_one_at_every_level(facts_of: Build) -> None:
    found = chart("task", counting="fractional", facts=facts_of(TABLE))
    assert {node.id: node.count for node in found.nodes} == pytest.approx(
        {
            "task:Cost": 1 / 2, "task:Accuracy": 1 / 2 + 1, "detector:PD": 1 + 1 / 2,
            "detector:CMOS": 1 / 2, "mask:Slit": 1 / 3, "mask:Lens": 1 / 3,
            "mask:Encoded": 1 / 3 + 1,
        }
    )  # fmt: skip
    links = {(link.source, link.target): link for link in found.links}
    assert links["task:Accuracy", "detector:CMOS"].value == pytest.approx(1 / 2)
    assert links["detector:PD", "mask:Encoded"].value == pytest.approx(1 / 3 + 1 / 2)
    assert links["detector:PD", "mask:Encoded"].studies == ("S0", "S1")
    assert {key for link in found.links for key in link.studies} == {"S0", "S1"}
    assert found.counting == "fractional"


def test_a_filter_on_what_a_model_implies_is_one_on_models(facts_of: Build) -> None:
    facts = facts_of([{"model": ["SPM"]}, {"model": ["ACM"]}, {"model": ["ECM/Noise", "LSQ"]}])
    taxonomy = facts.taxonomy
    online = allowed_values({"calibration": "online"}, taxonomy)
    assert online == {"model": {"ACM", "ECM", "ECM/Noise"}}
    both = {"calibration": ["online"], "model": ["ECM", "SPM"]}
    assert allowed_values(both, taxonomy) == {"model": {"ECM", "ECM/Noise"}}
    found = flows(["model", "calibration"], both, facts=facts)
    assert found.studies == ("S2",)
    assert [node.id for node in found.nodes] == ["model:ECM/Noise", "calibration:online"]


@pytest.mark.parametrize(
    ("text", "found"),
    [("ABCD", "abcd"), ("abxy", "abcd"), ("axyz", None), ("", None), ("slt", "Slit")],
)
def test_half_alike_is_near(text: str, found: str | None) -> None:
    assert nearest_name(text, ["abcd", "Slit"]) == found
