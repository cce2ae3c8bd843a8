"""A study resolves to every pipeline whose parts fit, and everything else of it has a reason."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.contract import AboutExtractor, AboutModel, FeatureKind, Observation
from registry.catalogue import Catalogue, catalogue
from registry.resolution import (
    READOUTS,
    SIMPLEST_EXTRACTORS,
    SIMPLEST_MODELS,
    Resolution,
    resolve,
    resolve_all,
)
from registry.studies import Facts
from registry.taxonomy import InvalidValueError

Rows = list[Mapping[str, list[str]]]
Build = Callable[[Rows], Facts]


def implementation(
    name: str, taxonomy: str, reads: Observation | None, kinds: frozenset[FeatureKind]
) -> type[Any]:
    """A class that declares what the catalogue reads; nothing here runs it."""

    stated: dict[str, Any] = {
        "name": name,
        "taxonomy": taxonomy,
        "labels": ("eq:x",),
        "origin": "survey",
    }

    @dataclass(frozen=True)
    class Stated:
        """Says what it is.

        Not shown in a list.
        """

        about: ClassVar = (
            AboutModel(accepts=kinds, **stated)
            if reads is None
            else AboutExtractor(observation=reads, kind=next(iter(kinds)), **stated)
        )

    return Stated


def stand_ins(facts: Facts, extractors: list[type[Any]], models: list[type[Any]]) -> Catalogue:
    return Catalogue(
        {e.about.name: e for e in extractors}, {m.about.name: m for m in models}, facts.taxonomy
    )


SPOT, BALANCE, SIGNALS = FeatureKind.SPOT, FeatureKind.BALANCE, FeatureKind.SIGNALS
BCTM = implementation("bctm", "BCTM", Observation.FRAMES, frozenset({SPOT}))
BCM = implementation("bcm", "BCM", Observation.FRAMES, frozenset({SPOT}))
DIRECT = implementation("direct", "Direct", Observation.CURRENTS, frozenset({SIGNALS}))
VB = implementation("vb", "Voltage balance", Observation.CURRENTS, frozenset({BALANCE}))
SPM = implementation("spm", "SPM", None, frozenset({SPOT}))
LUT = implementation("lut", "LUT", None, frozenset({SPOT, BALANCE}))
NOISE = implementation("noise", "ECM/Noise", None, frozenset({SIGNALS}))
ANGULAR = implementation("kelly", "ECM/Angular loss", None, frozenset({SIGNALS}))
BASIC = implementation("basic", "Basic", None, frozenset({SIGNALS}))
EXTRACTORS = [BCTM, BCM, DIRECT, VB]
MODELS = [SPM, LUT, NOISE, ANGULAR, BASIC]


def study(**values: list[str]) -> Mapping[str, list[str]]:
    return {
        "detector": ["CMOS"],
        "mask": ["Slit"],
        "extractor": ["BCTM"],
        "model": ["SPM"],
    } | values


def resolved(facts_of: Build, row: Mapping[str, list[str]], **kw: Any) -> Resolution:
    facts = facts_of([row])
    return resolve("S0", catalogue=stand_ins(facts, EXTRACTORS, MODELS), facts=facts, **kw)


def names(found: Resolution) -> list[tuple[str, str, str, str]]:
    return [(p.detector, p.mask, p.extractor, p.model) for p in found.pipelines]


def gaps(found: Resolution) -> list[tuple[str, str]]:
    return [(gap.attribute, gap.value) for gap in found.gaps]


def test_a_study_whose_parts_are_all_implemented_is_complete(facts_of: Build) -> None:
    found = resolved(facts_of, study(model=["SPM", "LUT"], mask=["Slit", "Lens"]))
    assert found.state == "complete"
    assert names(found) == [
        ("CMOS", mask, "bctm", model) for mask in ("Slit", "Lens") for model in ("spm", "lut")
    ]
    assert all(not pipeline.assumed for pipeline in found.pipelines)


def test_a_value_without_implementation_is_a_gap(facts_of: Build) -> None:
    found = resolved(facts_of, study(model=["SPM", "LSQ"]))
    assert found.state == "partial"
    assert [gap.to_dict() for gap in found.gaps] == [
        {"attribute": "model", "value": "LSQ", "reason": "no model implements LSQ"}
    ]
    found = resolved(facts_of, study(model=["LSQ"]))
    assert (found.state, gaps(found)) == ("none", [("model", "LSQ")])


@pytest.mark.parametrize("attribute", ["detector", "mask", "extractor", "model"])
def test_an_empty_cell_is_a_gap_and_nothing_is_assumed_for_it(
    facts_of: Build, attribute: str
) -> None:
    found = resolved(facts_of, study(**{attribute: []}))
    assert (found.state, gaps(found)) == ("none", [(attribute, "")])


def test_parts_that_do_not_fit_are_gaps_with_the_reason(facts_of: Build) -> None:
    found = resolved(facts_of, study(extractor=["BCTM", "Direct"]))
    assert names(found) == [("CMOS", "Slit", "bctm", "spm")]
    (gap,) = found.gaps
    assert (gap.attribute, gap.value) == ("extractor", "Direct")
    assert "reads currents; CMOS gives frames or profiles" in gap.reason

    found = resolved(facts_of, study(detector=["PD"], extractor=["Direct"], model=["SPM", "Basic"]))
    assert names(found) == [("PD", "Slit", "direct", "basic")]
    (gap,) = found.gaps
    assert (gap.attribute, gap.value) == ("model", "SPM")
    assert "reads spot features" in gap.reason


def test_a_combination_that_does_not_fit_is_no_gap_if_each_value_is_used(facts_of: Build) -> None:
    # Which extractor went with which model is not in the mapping: only what fits is run.
    found = resolved(
        facts_of,
        study(detector=["CMOS", "PD"], extractor=["BCTM", "Direct"], model=["SPM", "Basic"]),
    )
    assert found.state == "complete"
    assert names(found) == [
        ("CMOS", "Slit", "bctm", "spm"),
        ("PD", "Slit", "direct", "basic"),
    ]


def test_a_parent_runs_as_each_kind_and_says_so(facts_of: Build) -> None:
    found = resolved(facts_of, study(detector=["PD"], extractor=["Direct"], model=["ECM"]))
    assert [(p.model, p.model_taxonomy, dict(p.assumed)) for p in found.pipelines] == [
        ("noise", "ECM/Noise", {"model": "ECM"}),
        ("kelly", "ECM/Angular loss", {"model": "ECM"}),
    ]
    assert found.state == "complete"
    found = resolved(facts_of, study(model=["ICM"]))
    assert found.gaps[0].reason == "no model implements any of ICM, ICM/Albedo, ICM/Shadow"


def test_no_model_runs_with_the_simplest_that_fits_and_says_so(facts_of: Build) -> None:
    found = resolved(facts_of, study(model=["None"]))
    (pipeline,) = found.pipelines
    assert (pipeline.model, dict(pipeline.assumed)) == ("spm", {"model": "None"})
    assert found.state == "complete"
    found = resolved(facts_of, study(detector=["PD"], extractor=["Direct"], model=["None"]))
    assert [p.model for p in found.pipelines] == ["basic"]
    # A balance is read by none of the simplest implemented here.
    found = resolved(
        facts_of, study(detector=["QPD"], extractor=["Voltage balance"], model=["None"])
    )
    assert found.state == "none"
    assert ("model", "None") in gaps(found)


def test_no_extractor_runs_with_the_simplest_that_fits_and_says_so(facts_of: Build) -> None:
    found = resolved(facts_of, study(extractor=["None"], model=["SPM", "LUT"]))
    assert [(p.extractor, p.model, dict(p.assumed)) for p in found.pipelines] == [
        ("bcm", "spm", {"extractor": "None"}),
        ("bcm", "lut", {"extractor": "None"}),
    ]
    found = resolved(facts_of, study(extractor=["None"], model=["None"]))
    assert names(found) == [("CMOS", "Slit", "bcm", "spm")]


def test_architectures_not_simulated_are_gaps(facts_of: Build) -> None:
    row = study(mask=["Slit", "Lens"])
    found = resolved(facts_of, row, architectures=[("CMOS", "Slit")])
    assert names(found) == [("CMOS", "Slit", "bctm", "spm")]
    assert (found.state, gaps(found)) == ("partial", [("architecture", "CMOS + Lens")])
    found = resolved(facts_of, row, architectures=[])
    assert found.state == "none"
    assert gaps(found) == [("architecture", "CMOS + Slit"), ("architecture", "CMOS + Lens")]


def test_none_beside_a_stated_value_does_not_run_that_value_twice(facts_of: Build) -> None:
    both = study(detector=["PD"], extractor=["None", "Direct"], model=["ECM"])
    found = resolved(facts_of, both)
    assert [(p.extractor, p.model) for p in found.pipelines] == [
        ("direct", "noise"),
        ("direct", "kelly"),
    ]
    assert all("extractor" not in p.assumed for p in found.pipelines)
    assert ("extractor", "None") in gaps(found)


def test_an_unknown_study_names_the_nearest(facts_of: Build) -> None:
    with pytest.raises(InvalidValueError, match="did you mean 'Chang2008'"):
        resolve("Chang208")


VALUES = {
    "detector": ["CMOS", "PD", "Event"],
    "mask": ["Slit", "Lens"],
    "extractor": ["BCTM", "Direct", "Voltage balance", "HT", "None"],
    "model": ["SPM", "LUT", "ECM", "Basic", "DNN", "None"],
}


@settings(deadline=None, derandomize=True, max_examples=200)
@given(
    row=st.fixed_dictionaries(
        {a: st.lists(st.sampled_from(v), max_size=3, unique=True) for a, v in VALUES.items()}
    ),
    simulated=st.none()
    | st.lists(st.tuples(st.sampled_from(VALUES["detector"]), st.sampled_from(VALUES["mask"]))),
)
def test_nothing_of_a_study_is_passed_over_in_silence(
    facts_of: Build, row: Mapping[str, list[str]], simulated: list[tuple[str, str]] | None
) -> None:
    facts = facts_of([row])
    known = stand_ins(facts, EXTRACTORS, MODELS)
    found = resolve("S0", simulated, catalogue=known, facts=facts)
    explained = set(gaps(found))
    assert found.state == (
        "none" if not found.pipelines else "partial" if found.gaps else "complete"
    )
    if not found.pipelines:
        assert found.gaps
    assert len(set(names(found))) == len(found.pipelines)
    for p in found.pipelines:
        extractor, model = known.extractor(p.extractor), known.model(p.model)
        assert p.detector in row["detector"]
        assert p.mask in row["mask"]
        assert simulated is None or (p.detector, p.mask) in simulated
        assert extractor.about.observation in READOUTS[p.detector]
        assert extractor.about.kind in model.about.accepts
        assert p.assumed.get("extractor", p.extractor_taxonomy) in row["extractor"]
        assert p.assumed.get("model", p.model_taxonomy) in row["model"]
    for attribute, values in row.items():
        assert values or (attribute, "") in explained
    if not found.pipelines:
        return
    not_simulated = {v for a, v in explained if a == "architecture"}
    for detector in row["detector"]:
        shown = any(p.detector == detector for p in found.pipelines)
        assert (
            shown
            or ("detector", detector) in explained
            or any(v.startswith(f"{detector} + ") for v in not_simulated)
        )
    if not not_simulated and ("detector", "") not in explained:
        for attribute in ("extractor", "model"):
            for value in row[attribute]:
                used = any(
                    p.assumed.get(attribute, getattr(p, f"{attribute}_taxonomy")) == value
                    for p in found.pipelines
                )
                assert used != ((attribute, value) in explained)


def test_all_129_studies_resolve_or_say_why_not(survey: Facts) -> None:
    found = resolve_all()
    assert list(found) == list(survey.studies)
    known = catalogue()
    for key, resolution in found.items():
        study_ = survey.studies[key]
        assert resolution.pipelines or resolution.gaps
        assert resolution == resolve(key)
        for attribute, lookup in (
            ("extractor", known.extractors_for),
            ("model", known.models_for),
        ):
            for value in study_.of(attribute):
                kinds = survey.taxonomy.kinds(attribute, value)
                if value != "None" and not any(lookup(kind) for kind in kinds):
                    assert (attribute, value) in gaps(resolution)


def test_an_answer_is_plain_data(facts_of: Build) -> None:
    answer = resolved(facts_of, study(model=["None", "LSQ"])).to_dict()
    assert answer == {
        "key": "S0",
        "state": "partial",
        "pipelines": [
            {
                "detector": "CMOS",
                "mask": "Slit",
                "extractor": "bctm",
                "model": "spm",
                "extractor_taxonomy": "BCTM",
                "model_taxonomy": "SPM",
                "assumed": {"model": "None"},
            }
        ],
        "gaps": [{"attribute": "model", "value": "LSQ", "reason": "no model implements LSQ"}],
    }


def test_readouts_and_simplest_parts_speak_the_taxonomys_language(survey: Facts) -> None:
    assert set(READOUTS) == set(survey.taxonomy.values("detector"))
    assert frozenset().union(*READOUTS.values()) == {str(o) for o in Observation}
    assert set(SIMPLEST_EXTRACTORS) <= set(survey.taxonomy.values("extractor"))
    assert set(SIMPLEST_MODELS) <= set(survey.taxonomy.values("model"))


def test_the_catalogue_lists_what_is_declared_and_what_lacks(survey: Facts) -> None:
    known = stand_ins(survey, EXTRACTORS, MODELS)
    listed = [entry.to_dict() for entry in known.listing("extractor")]
    assert [entry["taxonomy"] for entry in listed] == ["Direct", "Voltage balance", "BCM", "BCTM"]
    assert listed[-1] == {
        "name": "bctm",
        "role": "extractor",
        "taxonomy": "BCTM",
        "category": "Centroid detection",
        "observation": "frames",
        "kind": "spot",
        "accepts": None,
        "labels": ["eq:x"],
        "studies": [],
        "origin": "survey",
        "version": 1,
        "summary": "Says what it is.",
    }
    assert known.listing("model")[0].accepts == ("balance", "spot")
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
    with pytest.raises(ValueError, match="both an extractor and a model are named bctm"):
        stand_ins(survey, [BCTM], [implementation("bctm", "SPM", None, frozenset({SPOT}))])
    with pytest.raises(InvalidValueError, match="did you mean 'bctm'"):
        stand_ins(survey, [BCTM], []).extractor("bctn")
    with pytest.raises(InvalidValueError, match="did you mean 'spm'"):
        stand_ins(survey, [], [SPM]).model("spn")


def test_the_catalogue_holds_what_discovery_finds() -> None:
    known = catalogue()
    assert known.extractors
    for name, extractor in known.extractors.items():
        assert extractor.about.name == name
        assert extractor in known.extractors_for(extractor.about.taxonomy)
    for name, model in known.models.items():
        assert model.about.name == name
        assert model in known.models_for(model.about.taxonomy)
    assert all(entry.summary for entry in known.listing())
