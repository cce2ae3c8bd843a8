"""A study resolves to what the plan scores of it, and everything else of it has a reason."""

import re
from collections.abc import Callable, Mapping
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stand_ins import (
    EXTRACTORS,
    GLASS,
    LUT,
    MODELS,
    READOUTS,
    SHADE,
    SPM,
    SPOT,
    chain,
    implementation,
    planned,
    stand_ins,
    study_of,
)

from registry.resolution import Resolution, resolve
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]
Build = Callable[[Rows], Facts]

EVERYWHERE = [(d, m) for d in READOUTS for m in ("Slit", "Lens")]


def resolved(
    facts_of: Build,
    row: Mapping[str, list[str]],
    architectures: list[tuple[str, str]] = EVERYWHERE,
    models: list[Any] = MODELS,
    without: tuple[str, ...] = (),
) -> Resolution:
    facts = facts_of([row])
    known = stand_ins(facts, EXTRACTORS, models)
    plan = planned(architectures, EXTRACTORS, models, without)
    return resolve("S0", plan, catalogue=known, facts=facts)


def names(found: Resolution) -> list[tuple[str, str, str, str]]:
    return [(p.detector, p.mask, p.extractor, p.model) for p in found.pipelines]


def models_of(found: Resolution) -> list[str]:
    return [p.model for p in found.pipelines]


def gaps(found: Resolution) -> list[tuple[str, str]]:
    return [(gap.attribute, gap.value) for gap in found.gaps]


def test_a_study_whose_parts_are_all_planned_is_complete(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(model=["SPM", "LUT"], mask=["Slit", "Lens"]))
    assert found.state == "complete"
    assert names(found) == [
        ("CMOS", mask, "bctm", model) for mask in ("Slit", "Lens") for model in ("spm", "lut")
    ]
    for pipeline in found.pipelines:
        assert not pipeline.assumed
        assert set(pipeline.basis.values()) == {"stated"}
        assert pipeline.datasets == (f"CMOS-{pipeline.mask}",)


def test_what_the_plan_leaves_out_is_not_announced(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(model=["SPM", "LUT"]), without=("lut",))
    assert models_of(found) == ["spm"]
    assert (found.state, gaps(found)) == ("partial", [("model", "LUT")])
    assert resolved(facts_of, study_of(), architectures=[]).state == "none"


def test_a_value_without_implementation_is_a_gap(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(model=["SPM", "LSQ"]))
    assert found.state == "partial"
    assert [gap.to_dict() for gap in found.gaps] == [
        {"attribute": "model", "value": "LSQ", "reason": "no model implements LSQ"}
    ]


def test_the_nearest_stands_in_where_nothing_of_a_study_runs(facts_of: Build) -> None:
    # Of its category the simplest.
    found = resolved(facts_of, study_of(model=["LSQ"]))
    (pipeline,) = found.pipelines
    assert (pipeline.model, pipeline.basis["model"]) == ("spm", "defaulted")
    ((stage, why),) = pipeline.assumed.items()
    assert (stage, re.findall(r"LSQ|spm", why)) == ("model", ["LSQ"])
    (gap,) = found.gaps
    assert re.findall(r"LSQ|spm", gap.reason) == ["LSQ", "spm"]
    # A network learns a curve; where a polynomial is there, it is nearer than the projection.
    cubic = implementation("cubic", "Polynomial", None, frozenset({SPOT}))
    assert models_of(resolved(facts_of, study_of(model=["ANN"]))) == ["spm"]
    assert models_of(resolved(facts_of, study_of(model=["ANN"]), models=[*MODELS, cubic])) == [
        "cubic"
    ]


def test_the_extractor_gives_way_before_the_model_does(facts_of: Build) -> None:
    # Balances are read by no fusion model, signals are: the model stays.
    row = study_of(detector=["PD"], extractor=["Voltage balance"], model=["Basic"])
    found = resolved(facts_of, row)
    assert names(found) == [("PD", "Slit", "direct", "basic")]
    assert found.pipelines[0].basis["extractor"] == "defaulted"
    assert gaps(found) == [("extractor", "Voltage balance")]


@pytest.mark.parametrize("attribute", ["extractor", "model"])
def test_methods_are_not_made_up(facts_of: Build, attribute: str) -> None:
    found = resolved(facts_of, study_of(**{attribute: []}))
    assert found.state == "none"
    assert (attribute, "") in gaps(found)


def test_parts_that_do_not_fit_are_gaps_with_the_reason(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(extractor=["BCTM", "Direct"]))
    assert names(found) == [("CMOS", "Slit", "bctm", "spm")]
    (gap,) = found.gaps
    assert (gap.attribute, gap.value) == ("extractor", "Direct")
    assert "CMOS" in gap.reason

    found = resolved(
        facts_of, study_of(detector=["PD"], extractor=["Direct"], model=["SPM", "Basic"])
    )
    assert names(found) == [("PD", "Slit", "direct", "basic")]
    (gap,) = found.gaps
    assert (gap.attribute, gap.value) == ("model", "SPM")
    assert "reads spot" in gap.reason


def test_a_combination_that_does_not_fit_is_no_gap_if_each_value_is_used(facts_of: Build) -> None:
    # Which extractor went with which model is not in the mapping: only what fits is run.
    found = resolved(
        facts_of,
        study_of(detector=["CMOS", "PD"], extractor=["BCTM", "Direct"], model=["SPM", "Basic"]),
    )
    assert found.state == "complete"
    assert names(found) == [
        ("CMOS", "Slit", "bctm", "spm"),
        ("PD", "Slit", "direct", "basic"),
    ]


def test_a_parent_runs_as_each_kind(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(detector=["PD"], extractor=["Direct"], model=["ECM"]))
    assert models_of(found) == ["noise", "kelly"]
    assert found.state == "complete"
    found = resolved(facts_of, study_of(model=["SPM", "ICM"]))
    assert found.gaps[0].reason.endswith(" ICM, ICM/Albedo, ICM/Shadow")


def test_no_method_runs_with_the_simplest_that_fits_and_says_so(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(model=["None"]))
    (pipeline,) = found.pipelines
    assert (pipeline.model, found.state) == ("spm", "complete")
    assert set(pipeline.assumed) == {"model"}
    found = resolved(facts_of, study_of(detector=["PD"], extractor=["Direct"], model=["None"]))
    assert models_of(found) == ["basic"]
    found = resolved(facts_of, study_of(extractor=["None"], model=["SPM", "LUT"]))
    assert names(found) == [("CMOS", "Slit", "bcm", "spm"), ("CMOS", "Slit", "bcm", "lut")]
    assert {p.basis["extractor"] for p in found.pipelines} == {"defaulted"}
    found = resolved(facts_of, study_of(extractor=["None"], model=["None"]))
    assert names(found) == [("CMOS", "Slit", "bcm", "spm")]


GLASSED = [*MODELS, chain(GLASS, SPM), chain(GLASS, LUT), chain(SHADE, GLASS, SPM)]


def test_a_compensation_is_a_stage_and_the_bare_model_is_left_out(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(model=["LUT", "OCM"]), models=GLASSED)
    assert (models_of(found), found.state) == (["glass + lut"], "complete")
    assert found.pipelines[0].stages == ("OCM", "LUT")
    # Both compensations that are stated, where a chain has both; none that is not stated.
    both = resolved(facts_of, study_of(model=["ICM/Shadow", "SPM", "OCM"]), models=GLASSED)
    assert models_of(both) == ["shade + glass + spm"]
    assert models_of(resolved(facts_of, study_of(model=["SPM"]), models=GLASSED)) == ["spm"]


def test_a_compensation_alone_runs_ahead_of_the_simplest_model(facts_of: Build) -> None:
    found = resolved(facts_of, study_of(model=["OCM"]), models=GLASSED)
    (pipeline,) = found.pipelines
    assert (pipeline.model, found.state) == ("glass + spm", "complete")
    ((stage, why),) = pipeline.assumed.items()
    assert (stage, why.split()[0]) == ("model", "OCM")


def test_where_a_compensation_is_not_planned_its_model_runs_bare(facts_of: Build) -> None:
    bare = ("glass + spm", "glass + lut", "shade + glass + spm")
    found = resolved(facts_of, study_of(model=["LUT", "OCM"]), models=GLASSED, without=bare)
    assert (models_of(found), gaps(found)) == (["lut"], [("model", "OCM")])
    found = resolved(facts_of, study_of(model=["OCM"]), models=GLASSED, without=bare)
    assert (models_of(found), gaps(found)) == (["spm"], [("model", "OCM")])
    assert "spm" in found.gaps[0].reason


def test_architectures_not_simulated_are_gaps(facts_of: Build) -> None:
    row = study_of(mask=["Slit", "Lens"])
    found = resolved(facts_of, row, architectures=[("CMOS", "Slit")])
    assert names(found) == [("CMOS", "Slit", "bctm", "spm")]
    assert (found.state, gaps(found)) == ("partial", [("architecture", "CMOS + Lens")])
    found = resolved(facts_of, row, architectures=[])
    assert [gap for gap in gaps(found) if gap[0] == "architecture"] == [
        ("architecture", "CMOS + Slit"),
        ("architecture", "CMOS + Lens"),
    ]


VALUES = {
    "detector": ["CMOS", "PD", "Event"],
    "mask": ["Slit", "Lens"],
    "extractor": ["BCTM", "Direct", "Voltage balance", "HT", "None"],
    "model": ["SPM", "LUT", "ECM", "Basic", "DNN", "OCM", "ICM/Shadow", "None"],
}


@settings(deadline=None, derandomize=True, max_examples=200)
@given(
    row=st.fixed_dictionaries(
        {a: st.lists(st.sampled_from(v), max_size=3, unique=True) for a, v in VALUES.items()}
    ),
    simulated=st.lists(st.sampled_from(EVERYWHERE), unique=True),
)
def test_nothing_of_a_study_is_passed_over_in_silence(
    facts_of: Build, row: Mapping[str, list[str]], simulated: list[tuple[str, str]]
) -> None:
    found = resolved(facts_of, row, simulated, GLASSED)
    plan = planned(simulated, EXTRACTORS, GLASSED)
    explained = set(gaps(found))
    assert found.state == (
        "none" if not found.pipelines else "partial" if found.gaps else "complete"
    )
    assert len(set(names(found))) == len(found.pipelines)
    run: dict[str, set[str]] = {"extractor": set(), "model": set()}
    for p in found.pipelines:
        assert p.detector in row["detector"]
        assert p.mask in row["mask"]
        assert p.datasets == plan[p.detector, p.mask][p.extractor, p.model]
        assert set(p.assumed) == {a for a, basis in p.basis.items() if basis != "stated"}
        run["extractor"].add(p.extractor_taxonomy)
        run["model"].update(p.stages)
    for attribute, values in row.items():
        assert bool(values) != ((attribute, "") in explained)
    if not found.pipelines:
        return
    for attribute, ran in run.items():
        for value in row[attribute]:
            if value != "None":
                kinds = {value, "ECM/Noise", "ECM/Angular loss"} if value == "ECM" else {value}
                assert ((attribute, value) in explained) == kinds.isdisjoint(ran)
