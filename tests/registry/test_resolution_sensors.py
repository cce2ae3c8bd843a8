"""The sensor that a study is run on: its own cells, else a rule, else its nearest relatives."""

import dataclasses
from collections.abc import Callable, Mapping
from types import MappingProxyType

import pytest
from stand_ins import EXTRACTORS, MODELS, planned, stand_ins, study_of

from benchmark.plan.combinations import scorable_plan
from benchmark.plan.shown import data_sets
from registry.fidelity.particulars import RunFact
from registry.fidelity.runnable import ESSENTIAL
from registry.resolution import Resolution, resolve, resolve_all
from registry.sensors import BASES
from registry.studies import AttributeValue, Default, Facts

Build = Callable[[list[Mapping[str, list[str]]]], Facts]
PLAN = planned([("CMOS", "Slit"), ("CMOS", "Lens"), ("CCD", "Slit"), ("PD", "Maskless")])
RULE = Default("D01", "mask", (("extractor", "BCTM"),), "Lens", "fe:bctm", "one spot, one lens")


def resolved(facts: Facts, key: str = "S0") -> Resolution:
    known = stand_ins(facts, EXTRACTORS, MODELS)
    return resolve(key, PLAN, catalogue=known, facts=facts)


@pytest.mark.parametrize(
    ("basis", "note", "expected", "rule"),
    [
        ("survey-table", "", "stated", None),
        ("abstract", "said there", "stated", None),
        ("inferred", "one spot needs one slit", "inferred", "one spot needs one slit"),
        ("recalled", "", "recalled", "the mapping gives no reason"),
    ],
)
def test_a_cell_of_the_mapping_carries_its_basis(
    facts_of: Build, basis: str, note: str, expected: str, rule: str | None
) -> None:
    facts = facts_of([study_of()])
    study = facts.studies["S0"]
    cell = AttributeValue("Slit", basis, "", note)
    values = MappingProxyType({**study.values, "mask": (cell,)})
    facts = Facts({"S0": dataclasses.replace(study, values=values)}, facts.taxonomy)
    (pipeline,) = resolved(facts).pipelines
    assert pipeline.basis["mask"] == expected
    assert pipeline.assumed.get("mask") == rule


def test_a_sensor_of_its_own_stands_against_what_the_mapping_infers(facts_of: Build) -> None:
    """A mask that the built sensor has is inferred from it, and leaves no gap of the mapping's."""
    facts = facts_of([study_of(), study_of()])
    built = RunFact("S0", "mask", "Lens", "page", "x", "P99")
    facts = dataclasses.replace(facts, run_facts={"S0": (*facts.run_facts["S0"], built)})
    known, own = stand_ins(facts, EXTRACTORS, MODELS), {"S0": planned([("CMOS", "Lens")])}
    found = resolve_all(PLAN, own=own, catalogue=known, facts=facts)
    (pipeline,) = found["S0"].pipelines
    assert (pipeline.mask, pipeline.basis["mask"]) == ("Lens", "inferred")
    assert "P99" in pipeline.assumed["mask"]
    assert (found["S0"].gaps, found["S0"].state) == ((), "complete")
    assert found["S1"] == resolve("S1", PLAN, catalogue=known, facts=facts)
    # what nothing is known of is a choice
    unknown = dataclasses.replace(facts, run_facts={"S0": facts.run_facts["S0"][:1]})
    (pipeline,) = resolve("S0", PLAN, own=own, catalogue=known, facts=unknown).pipelines
    assert pipeline.basis["mask"] == "defaulted"


def test_a_rule_fills_an_empty_cell_of_a_study_that_meets_it(facts_of: Build) -> None:
    rules = (dataclasses.replace(RULE, kind="chosen"),)
    chosen = resolved(dataclasses.replace(facts_of([study_of(mask=[])]), defaults=rules))
    assert {p.basis["mask"] for p in chosen.pipelines} == {"defaulted"}
    facts = dataclasses.replace(facts_of([study_of(mask=[])]), defaults=(RULE,))
    found = resolved(facts)
    (pipeline,) = found.pipelines
    assert (pipeline.detector, pipeline.mask, pipeline.basis["mask"]) == (
        *("CMOS", "Lens"),
        "implied",
    )
    assert pipeline.assumed == {"mask": f"{RULE.id}: {RULE.rule}"}
    assert found.state == "partial"
    gap = found.gaps[0].to_dict()
    assert gap.pop("reason").endswith(pipeline.assumed["mask"])
    assert gap == {"attribute": "mask", "value": ""}


def test_the_first_rule_whose_every_condition_is_met_is_taken(facts_of: Build) -> None:
    narrow = dataclasses.replace(
        RULE, id="D00", conditions=(("extractor", "BCTM"), ("model", "LUT")), value="Slit"
    )
    facts = dataclasses.replace(facts_of([study_of(mask=[])]), defaults=(narrow, RULE))
    assert {p.mask for p in resolved(facts).pipelines} == {"Lens"}
    facts = dataclasses.replace(
        facts_of([study_of(mask=[], model=["LUT"])]), defaults=(narrow, RULE)
    )
    assert {p.mask for p in resolved(facts).pipelines} == {"Slit"}
    # a cell that is not empty is not filled
    facts = dataclasses.replace(facts_of([study_of()]), defaults=(RULE,))
    assert {p.mask for p in resolved(facts).pipelines} == {"Slit"}


def test_without_a_rule_a_study_runs_where_its_nearest_relatives_do(facts_of: Build) -> None:
    facts = facts_of(
        [
            study_of(detector=[], mask=[], error=["Alignment"]),
            study_of(mask=["Lens"]),  # the same methods: 2 of 3 in common
            study_of(detector=["CCD"], error=["Alignment"]),  # 3 of 3
            study_of(detector=["PD"], mask=["Maskless"], extractor=["Direct"], model=["Basic"]),
        ]
    )
    (pipeline,) = resolved(facts).pipelines
    assert (pipeline.detector, pipeline.mask) == ("CCD", "Slit")
    assert {pipeline.basis[a] for a in ("detector", "mask")} == {"defaulted"}
    assert "nearest relative S2 " in pipeline.assumed["mask"]


def test_relatives_lend_only_what_is_empty_and_what_runs(facts_of: Build) -> None:
    facts = facts_of(
        [
            study_of(mask=[], detector=["CMOS"]),
            study_of(detector=["CCD"]),  # nearest, but of another detector
            study_of(mask=["Lens"], model=["SPM", "LUT"]),
            study_of(
                detector=["PD"], mask=["Maskless"], model=["SPM"]
            ),  # as near: nothing runs there
        ]
    )
    (pipeline,) = resolved(facts).pipelines
    assert (pipeline.detector, pipeline.mask) == ("CMOS", "Lens")
    assert pipeline.basis["detector"] == "stated"


def test_a_stranger_without_relatives_runs_nowhere(facts_of: Build) -> None:
    found = resolved(facts_of([study_of(mask=[]), study_of(extractor=["Direct"], model=["Basic"])]))
    assert (found.state, found.gaps[0].reason) == ("none", "the mapping states no value")


def test_detectors_and_masks_go_together_only_as_the_study_combined_them(facts_of: Build) -> None:
    facts = facts_of([study_of(detector=["CMOS", "CCD"], mask=["Lens", "Slit"])])
    assert len(facts.studies["S0"].architectures) == 4
    study = dataclasses.replace(
        facts.studies["S0"], combinations=(("CMOS", "Lens"), ("CCD", "Slit"))
    )
    found = resolved(Facts({"S0": study}, facts.taxonomy))
    assert [(p.detector, p.mask) for p in found.pipelines] == list(study.architectures)
    assert found.state == "complete"


@pytest.fixture(scope="module")
def everything() -> dict[str, Resolution]:
    return resolve_all(scorable_plan(), data_sets=data_sets())


def test_all_129_studies_resolve_each_with_a_cell(
    survey: Facts, everything: dict[str, Resolution]
) -> None:
    assert list(everything) == list(survey.studies)
    assert len(everything) == 129
    plan = scorable_plan()
    for key, resolution in everything.items():
        study = survey.studies[key]
        assert resolution.pipelines, key
        for p in resolution.pipelines:
            assert p.datasets == plan[p.detector, p.mask][p.extractor, p.model]
            assert set(p.basis) == set(ESSENTIAL)
            assert set(p.basis.values()) <= set(BASES)
            assert set(p.assumed) == {a for a, basis in p.basis.items() if basis != "stated"}
            assert all(p.assumed.values())
            for attribute in ("detector", "mask"):
                stated = study.of(attribute)
                rests_on_it = p.basis[attribute] not in ("implied", "defaulted")
                assert (getattr(p, attribute) in stated) == rests_on_it
    assert everything["Chang2008"] == resolve("Chang2008", plan, data_sets=data_sets())


@pytest.mark.parametrize(
    ("key", "detector", "mask"),
    [
        ("Massari2004", "CMOS", "Single-Ap."),  # the pinhole of the assessment table
        ("Kohli2019", "CCD", "N-Slit"),  # a linear slit array
        ("Fan2016", "CCD", "V-Slit"),
        ("KeQiang2020", "CCD", "Slit"),
        ("Miao2017", "QPD", "Single-Ap."),  # voltage balance
        ("Farian2015", "Event", "L-Slit"),  # where the survey says ESCM runs
    ],
)
def test_empty_cells_are_filled_by_the_rules_of_the_data(
    everything: dict[str, Resolution], key: str, detector: str, mask: str
) -> None:
    found = everything[key]
    assert {(p.detector, p.mask) for p in found.pipelines} == {(detector, mask)}
    (empty,) = {gap.attribute for gap in found.gaps if not gap.value}
    assert {p.basis[empty] for p in found.pipelines} <= {"implied", "defaulted"}
    assert {p.assumed[empty][:2] for p in found.pipelines} == {"D0"}


@pytest.mark.parametrize(("key", "relative"), [("Duan2006", "Radan2019")])
def test_a_study_runs_where_a_relative_with_the_same_compensation_does(
    survey: Facts, everything: dict[str, Resolution], key: str, relative: str
) -> None:
    found = everything[key]
    near = survey.studies[relative]
    assert "ACM" in near.of("model")
    assert {(p.detector, p.mask) for p in found.pipelines} <= set(near.architectures)
    for p in found.pipelines:
        assert relative in p.assumed["detector"]
        assert relative in p.assumed["mask"]
