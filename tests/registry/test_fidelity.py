"""A run is graded by what departs from its study, and stands where the study's purpose is shown."""

import dataclasses
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import pytest
from stand_ins import (
    BALANCE,
    DIRECT,
    EXTRACTORS,
    GLASS,
    LUT,
    MODELS,
    SIGNALS,
    SPM,
    SPOT,
    chain,
    implementation,
    planned,
    stand_ins,
    study_of,
)

from benchmark.plan.shown import data_sets
from registry.fidelity.grading import Grade
from registry.fidelity.particulars import (
    CompensatedModel,
    MethodVariant,
    PurposeRule,
    RunFact,
)
from registry.fidelity.purposes import DataSet, DatasetCondition
from registry.resolution import Resolution, resolve
from registry.studies import AttributeValue, Default, Facts

Build = Callable[[list[Mapping[str, list[str]]]], Facts]
OPENED = ("", "survey-text", "model:x", "so it says")
ALBEDO = PurposeRule("U01", (("error", "Interference"),), (("task", "Cost"),), "albedo", "s", "r")
FLIGHT = PurposeRule("U02", (("model", "ACM"),), (), "flight", "s", "in operation")


def resolved(
    facts: Facts,
    *sets: DataSet,
    on: tuple[tuple[str, str], ...] = (("CMOS", "Slit"),),
    models: list[Any] = MODELS,
) -> Resolution:
    plan = planned(on, EXTRACTORS, models)
    known = stand_ins(facts, EXTRACTORS, models)
    shown = {one.name: one for one in sets}
    return resolve("S0", plan, data_sets=shown, catalogue=known, facts=facts)


def parts(found: Resolution) -> list[str]:
    return [departure.part for departure in found.fidelity.departures]


def recalled(facts: Facts, attribute: str) -> Facts:
    study = facts.studies["S0"]
    (cell,) = study.values[attribute]
    weak = AttributeValue(cell.value, "recalled", "", "from memory")
    values = MappingProxyType({**study.values, attribute: (weak,)})
    return dataclasses.replace(facts, studies={"S0": dataclasses.replace(study, values=values)})


def test_a_study_that_runs_as_it_states_is_faithful(facts_of: Build) -> None:
    found = resolved(facts_of([study_of(model=["SPM", "LUT"])]))
    assert (found.fidelity.grade, parts(found)) == ("faithful", [])
    for named in ("standard projection model", "look-up table", "bctm + spm", "CMOS-Slit"):
        assert named in found.fidelity.sentence


@pytest.mark.parametrize(
    ("values", "departs", "grade"),
    [
        ({"model": ["LSQ"]}, ["model"], "close"),
        ({"model": ["SPM", "LSQ", "DNN"]}, ["model", "model"], "stand-in"),
        ({"model": ["None"]}, ["model"], "assumed"),
        ({"extractor": ["None"]}, ["extractor"], "assumed"),
        ({"extractor": ["HT"], "model": ["None"]}, ["extractor", "model"], "close"),
        ({"model": ["SPM", "OCM"]}, ["compensation"], "close"),
        ({"detector": ["CMOS", "QPD"]}, ["sensor"], "close"),
    ],
)
def test_each_value_that_does_not_run_or_was_chosen_departs(
    facts_of: Build, values: dict[str, list[str]], departs: list[str], grade: Grade
) -> None:
    found = resolved(facts_of([study_of(**values)]))
    assert sorted(parts(found)) == departs
    assert found.fidelity.grade == grade
    for departure in found.fidelity.departures:
        assert departure.text in found.fidelity.sentence
        assert departure.settled_by


def test_what_is_recalled_departs_and_what_is_inferred_does_not(facts_of: Build) -> None:
    facts = facts_of([study_of()])
    assert parts(resolved(recalled(facts, "detector"))) == ["sensor"]
    both = recalled(recalled(facts, "detector"), "mask")
    assert parts(resolved(both)) == ["sensor"]  # one sensor, one part
    study = facts.studies["S0"]
    cell = (AttributeValue("Slit", "inferred", "", "a slit by its model"),)
    values = MappingProxyType({**study.values, "mask": cell})
    found = resolved(
        dataclasses.replace(facts, studies={"S0": dataclasses.replace(study, values=values)})
    )
    assert found.fidelity.grade == "faithful"
    assert "mask is inferred" in found.fidelity.sentence


def test_an_implied_cell_is_the_studys_and_a_chosen_one_is_not(facts_of: Build) -> None:
    facts = facts_of([study_of(mask=[])])
    rule = Default("D01", "mask", (("extractor", "BCTM"),), "Slit", "fe:bctm", "one line, one slit")
    implied = dataclasses.replace(facts, defaults=(rule,))
    assert resolved(implied).fidelity.grade == "faithful"
    chosen = dataclasses.replace(facts, defaults=(dataclasses.replace(rule, kind="chosen"),))
    assert parts(resolved(chosen)) == ["sensor"]


def test_a_kind_that_is_not_stated_is_chosen_unless_a_model_is_known_to_do_it(
    facts_of: Build,
) -> None:
    facts = facts_of([study_of(detector=["PD"], extractor=["Direct"], model=["Basic", "ECM"])])
    on = (("PD", "Slit"),)
    assert parts(resolved(facts, on=on)) == ["compensation"]
    known = CompensatedModel("S0", "ECM", "Basic", "within", *OPENED[1:])
    found = resolved(dataclasses.replace(facts, compensated_models=(known,)), on=on)
    assert (found.fidelity.grade, [p.model for p in found.pipelines]) == ("faithful", ["basic"])


def test_a_compensation_runs_ahead_of_the_model_of_its_equation(facts_of: Build) -> None:
    models = [*MODELS, chain(GLASS, SPM), chain(GLASS, LUT)]
    facts = facts_of([study_of(model=["OCM"])])
    bare = resolved(facts, models=models)
    assert ([p.model for p in bare.pipelines], parts(bare)) == (["glass + spm"], ["model"])
    known = CompensatedModel("S0", "OCM", "LUT", "ahead", *OPENED[1:])
    found = resolved(dataclasses.replace(facts, compensated_models=(known,)), models=models)
    assert [p.model for p in found.pipelines] == ["glass + lut"]
    assert found.fidelity.grade == "faithful"


def test_another_variant_than_the_studys_departs(facts_of: Build) -> None:
    balanced = implementation("balanced", "DNN", None, frozenset({BALANCE}))
    raw = implementation("raw", "DNN", None, frozenset({SIGNALS}))
    facts = facts_of([study_of(detector=["PD"], extractor=["Voltage balance"], model=["DNN"])])
    variant = MethodVariant("S0", "DNN", "DNN", "Direct", *OPENED)
    facts = dataclasses.replace(facts, variants=(variant,))
    on = (("PD", "Slit"),)
    without = resolved(facts, on=on, models=[balanced])
    assert (without.fidelity.grade, parts(without)) == ("close", ["model"])
    assert "so it says" in without.fidelity.sentence
    found = resolved(facts, on=on, models=[balanced, raw])
    assert found.fidelity.grade == "faithful"
    assert found.best_pipeline is not None
    assert (found.best_pipeline.extractor, found.best_pipeline.model) == (DIRECT.about.name, "raw")


def test_a_study_stands_where_its_purpose_is_shown(facts_of: Build) -> None:
    facts = dataclasses.replace(facts_of([study_of(error=["Interference"])]), purposes=(ALBEDO,))
    lit = DataSet("CMOS-Slit", ("nominal", "albedo"))
    found = resolved(facts, lit)
    assert found.fidelity.grade == "faithful"
    assert found.pipelines[0].settings == (DatasetCondition("CMOS-Slit", "albedo", ("albedo",)),)
    dark = resolved(facts, DataSet("CMOS-Slit"))
    assert parts(dark) == ["condition"]
    assert dark.pipelines[0].settings == (DatasetCondition("CMOS-Slit", "nominal"),)
    # a study that the rule leaves out is shown as any other
    facts = facts_of([study_of(error=["Interference"], task=["Cost"])])
    facts = dataclasses.replace(facts, purposes=(ALBEDO,))
    assert resolved(facts, lit).pipelines[0].settings == (DatasetCondition("CMOS-Slit", "nominal"),)


def test_where_its_own_sensor_does_not_fly_the_nearest_that_does_stands_in(facts_of: Build) -> None:
    drift = implementation("drift", "ACM", None, frozenset({SIGNALS}))
    values = study_of(detector=["PD"], mask=["Slit"], extractor=["Direct"], model=["ACM"])
    facts = dataclasses.replace(facts_of([values]), purposes=(FLIGHT,))
    aloft = DataSet("PD-Lens", ("nominal", "hot"), frozenset({"time_s"}))
    on = (("PD", "Slit"), ("PD", "Lens"), ("CMOS", "Slit"))
    found = resolved(facts, aloft, on=on, models=[drift])
    # a condition for a sensor is no gain: as many parts depart, and the sensor is its own
    assert parts(found) == ["condition"]
    assert found.pipelines[0].settings == (DatasetCondition("PD-Slit", "nominal"),)
    # where the sensor is not known at all it is
    facts = facts_of([study_of(detector=[], mask=[], extractor=["Direct"], model=["ACM"])])
    facts = dataclasses.replace(facts, purposes=(FLIGHT,))
    found = resolved(facts, aloft, on=on, models=[drift])
    assert parts(found) == ["sensor"]
    assert found.pipelines[0].settings == (DatasetCondition("PD-Lens", "nominal", ("flight",)),)


def test_grades_of_the_survey_follow_from_their_departures(
    survey: Facts, everything: dict[str, Resolution]
) -> None:
    for key, found in everything.items():
        departures, study = found.fidelity.departures, survey.studies[key]
        differ = sum(not one.unknown for one in departures)
        expected = ("assumed", "close", "stand-in")[min(differ, 2)] if departures else "faithful"
        assert found.fidelity.grade == expected, key
        assert all(one.settled_by for one in departures), key
        if not study.title or study.identity == "ambiguous":
            assert any(one.part == "identity" for one in departures), key
        if found.fidelity.grade == "faithful":
            assert found.best_pipeline is not None
            assert "None" not in (*study.of("model"), *study.of("extractor"))
            assert not {"recalled", "defaulted"} & set(found.best_pipeline.basis.values()), key
            assert set(study.of("extractor")) <= {p.extractor_taxonomy for p in found.pipelines}
            ran = {stage for p in found.pipelines for stage in p.stages}
            for value in study.of("model"):
                carried = survey.within(key, value) or survey.variant(key, value)
                assert carried or value in ran, (key, value)


@pytest.mark.parametrize(
    ("key", "dataset", "condition"),
    [
        ("Soken2023", "pd-albedo-orbit", "nominal"),  # a network against albedo, trained in orbit
        ("Sozen2021", "pd-albedo-orbit", "nominal"),
        ("Frezza2022", "pd-orbit", "nominal"),
        ("Nurgizat2021", "pva-maskless-panels", "albedo"),
        ("Hermoso2022b", "pva-maskless-panels", "hot"),  # the temperature of its panels
        ("Zhang2022b", "pva-orbit", "nominal"),  # albedo and its cells' temperature, both given
        ("Pita2014", "pva-maskless-pyramid", "nominal"),
        ("Chang2008", "cmos-single-aperture", "nominal"),  # a bench, the data set made after it
    ],
)
def test_studies_stand_where_what_they_are_about_is_shown(
    everything: dict[str, Resolution], key: str, dataset: str, condition: str
) -> None:
    best = everything[key].best_pipeline
    assert best is not None
    assert (best.settings[0].dataset, best.settings[0].condition) == (dataset, condition)


@pytest.mark.parametrize(
    ("key", "detector", "extractor", "model"),
    [
        ("Abhilash2014", "PD", "voltage-balance", "slit-pairs"),
        ("Chang2006", "PD", "voltage-balance", "slit-shadow + slit-pairs"),
        ("Enright2007a", "CCD", "ppe", "optical + multi-slit"),
        ("Pita2014", "PVA", "direct", "pyramidal"),
        ("Wang2019", "PVA", "direct", "pyramidal"),
        ("Zhang2022b", "PVA", "direct", "panoramic-temperature"),
    ],
)
def test_a_study_runs_by_the_methods_that_it_is_mapped_to(
    everything: dict[str, Resolution], key: str, detector: str, extractor: str, model: str
) -> None:
    found = everything[key]
    ran = {(p.detector, p.extractor, p.model) for p in found.pipelines}
    assert (detector, extractor, model) in ran


@pytest.mark.parametrize(
    ("key", "grade", "part", "says"),
    [
        ("Xie2011", "assumed", "sensor", "of its sensor are not known"),
        ("Xie2012", "close", "score", "4.2 times the reported"),
        ("deBoer2013", "assumed", "sensor", "of its sensor are not known"),
        ("ONeill2020", "assumed", "calibration", "is not known"),
        ("Lu2017a", "assumed", "calibration", "is not known"),
        ("Springmann2014", "stand-in", "score", "no score"),
        ("Miao2017", "assumed", "identity", "title is not known"),
        ("Rufino2017", "close", "sensor", "5 of 5 dimensions of its sensor are not known"),
        ("Pita2014", "close", "calibration", "in flight"),
        ("Enright2007a", "close", "score", "times the reported"),
        ("Fan2013", "stand-in", "sensor", "semi-cylindrical lens"),
        ("You2011", "close", "sensor", "polynomial of the sixth degree an axis"),
    ],
)
def test_studies_are_graded_for_what_their_evidence_says(
    everything: dict[str, Resolution], key: str, grade: Grade, part: str, says: str
) -> None:
    found = everything[key].fidelity
    assert found.grade == grade
    assert any(one.part == part and says in one.text for one in found.departures), found.sentence


def test_projections_run_with_fitted_constants(everything: dict[str, Resolution]) -> None:
    for key in ("deBoer2013", "Xie2012", "ONeill2020", "Rhee2012", "Coutinho2022"):
        best = everything[key].best_pipeline
        assert best is not None
        assert (best.model, best.model_taxonomy) == ("pinhole", "SPM")
        assert "constants fitted" in everything[key].fidelity.sentence
    bare = {one.model for found in everything.values() for one in found.pipelines}
    assert "spm" not in bare


def test_a_study_that_takes_constants_from_its_drawing_is_not_fitted(facts_of: Build) -> None:
    fitted = implementation("pinhole", "LSQ", None, frozenset({SPOT}))
    spm = implementation("spm", "SPM", None, frozenset({SPOT}))
    facts = facts_of([study_of()])
    assert [p.model for p in resolved(facts, models=[spm, fitted]).pipelines] == ["pinhole"]
    drawn = RunFact("S0", "calibration", "drawn", "abstract", "S0", "it says so")
    facts = dataclasses.replace(facts, run_facts={"S0": (drawn,)})
    assert [p.model for p in resolved(facts, models=[spm, fitted]).pipelines] == ["spm"]


def test_compensations_of_a_study_stand_ahead_of_what_it_proposes(
    everything: dict[str, Resolution],
) -> None:
    found = everything["Chang2006"]  # the polynomial is what its physical model is compared with
    ahead = {p.model for p in found.pipelines if len(p.stages) > 1}
    assert ahead == {"slit-shadow + slit-pairs"}
    assert {p.model for p in found.strongest_pipelines} == {"slit-shadow + slit-pairs"}


@pytest.mark.parametrize("key", ["Radan2019", "Fan2017"])
def test_assembly_that_drifts_is_compensated_on_a_flight(
    everything: dict[str, Resolution], key: str
) -> None:
    best = everything[key].best_pipeline
    assert best is not None
    assert data_sets()[best.settings[0].dataset].flies
    assert best.settings[0].purposes == ("flight",)
    assert best.stages == ("ACM",)


def test_a_network_against_albedo_reads_voltages_as_the_survey_describes_it(
    everything: dict[str, Resolution],
) -> None:
    for key in ("Soken2023", "Sozen2021"):
        best = everything[key].best_pipeline
        assert best is not None
        assert (best.extractor, best.model) == ("direct", "dnn")
        # its mask is not known, and its score is far from the reported one
        assert everything[key].fidelity.grade == "close"
        assert {"sensor", "score"} <= set(parts(everything[key]))
