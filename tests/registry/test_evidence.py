"""What a run is judged by beyond labels: dimensions, shares of unknown facts, scores."""

import dataclasses
import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from types import MappingProxyType

import pytest

from algorithms.design import SensorGeometry
from api.cli.asking import knowledge
from api.service import studies as service
from benchmark.plan.shown import data_sets, design
from registry.fidelity import evidence
from registry.fidelity.particulars import RunFact
from registry.fidelity.purposes import DataSet, DatasetCondition
from registry.fidelity.runnable import RunnablePipeline
from registry.studies import AttributeValue, Facts, Study

Build = Callable[[list[Mapping[str, list[str]]]], Facts]
PLACE = ("CMOS", "Single-Ap.")
PINHOLE = {
    "openings": 1.0,
    "opening_um": 100.0,
    "height_mm": 1.0,
    "pitch_um": 10.0,
    "array_px": 512.0,
    "fov_deg": 120.0,
}


def told(facts: Facts, **said: str) -> tuple[Study, Facts]:
    rows = tuple(RunFact("S0", fact, value, "abstract", "S0", "so") for fact, value in said.items())
    return facts.studies["S0"], dataclasses.replace(facts, run_facts={"S0": rows})


def pipeline(model: str = "pinhole") -> RunnablePipeline:
    at = DatasetCondition("d", "nominal")
    empty: Mapping[str, str] = MappingProxyType({})
    stated = MappingProxyType(dict.fromkeys(("detector", "mask", "extractor", "model"), "stated"))
    return RunnablePipeline(
        *PLACE, "bctm", model, "BCTM", "SPM", ("SPM",), stated, empty, ("d",), (at,)
    )


@pytest.mark.parametrize(
    ("height", "alike"), [("1.5", True), ("0.6667", True), ("1.51", False), ("0.66", False)]
)
def test_a_dimension_may_be_off_by_half(facts_of: Build, height: str, alike: bool) -> None:
    study, facts = told(facts_of([{}]), height_mm=height)
    found = evidence.differing(study, facts, DataSet("d", design=PINHOLE), PLACE)
    assert (found == []) is alike


def test_four_of_ten_unknown_facts_are_too_many(facts_of: Build) -> None:
    at = {"d": DataSet("d", design=PINHOLE)}
    three = {"pitch_um": "10", "array_px": "512", "fov_deg": "120"}
    study, facts = told(facts_of([{}]), **three)  # two of five are not known
    (one,) = evidence.sensor(study, facts, [pipeline()], at)
    assert (one.part, one.unknown) == ("sensor", True)
    assert "2 of 5" in one.text
    study, facts = told(facts_of([{}]), **three, height_mm="1")
    assert list(evidence.sensor(study, facts, [pipeline()], at)) == []


@pytest.mark.parametrize(
    ("own", "kind", "near"),
    [
        (0.29, "rms", True),
        (0.31, "rms", False),
        (0.034, "rms", True),
        (0.033, "rms", False),
        (0.09, "3sigma", True),  # 0.1 deg of three sigma are 0.033 deg RMS
        (0.11, "3sigma", False),
    ],
)
def test_a_score_is_within_a_factor_of_three(
    facts_of: Build, own: float, kind: str, near: bool
) -> None:
    study, facts = told(facts_of([{}]))
    cell = {"accuracy_deg": "0.1", "accuracy_kind": kind}
    values = {name: (AttributeValue(v, "abstract", "", ""),) for name, v in cell.items()}
    study = dataclasses.replace(study, values=MappingProxyType(values))
    scores = {("d", "nominal", "bctm", "pinhole"): own}
    found = list(evidence.score(study, facts, [pipeline()], scores))
    assert (found == []) is near
    _, excused = told(facts, reason="another bench")
    assert list(evidence.score(study, excused, [pipeline()], scores)) == []
    (none,) = evidence.score(study, excused, [pipeline()], {})
    assert (none.part, none.unknown) == ("score", False)


def test_a_drawing_says_how_faces_are_arranged() -> None:
    cube = tuple(
        tuple(float(s * (i == axis)) for i in range(3)) for axis in range(3) for s in (1, -1)
    )
    assert design(SensorGeometry(face_normals=cube)) == {"faces": 6.0, "layout": "cube"}  # type: ignore[arg-type]
    tilt = math.radians(30.0)
    around = tuple(
        (math.sin(tilt) * math.cos(a), math.sin(tilt) * math.sin(a), math.cos(tilt))
        for a in (0.0, 2.0, 4.0)
    )
    drawn = design(SensorGeometry(face_normals=around))
    assert (drawn["faces"], drawn["layout"]) == (3.0, "pyramid")
    assert drawn["tilt_deg"] == pytest.approx(30.0)
    sets = data_sets()
    assert sets["cmos-multi-aperture"].design["openings"] == 100.0
    assert sets["cmos-single-aperture"].design["pitch_um"] == pytest.approx(6.5)
    assert sets["pva-maskless-sphere"].design["layout"] == "sphere"


def test_reported_and_own_errors_are_compared_worst_first() -> None:
    rows = service.compare_accuracy(knowledge())
    off = [max(row["times"], 1.0 / row["times"]) for row in rows]
    assert all(a >= b for a, b in pairwise(off))
    assert {row["key"] for row in rows} >= {"Soken2023", "Lin2016", "Enright2007a"}
    # Spearman's coefficient by its definition: Pearson's of the ranks, ties at their mean
    ranks = [_ranks([row[name] for row in rows]) for name in ("rms_deg", "own_error_deg")]
    means = [sum(each) / len(each) for each in ranks]
    x, y = ([value - mean for value in each] for each, mean in zip(ranks, means, strict=True))
    expected = sum(a * b for a, b in zip(x, y, strict=True)) / math.sqrt(
        sum(a * a for a in x) * sum(b * b for b in y)
    )
    assert f"own error is {expected:.2f} " in service.say_comparison(rows)


def _ranks(values: list[float]) -> list[float]:
    return [
        sum(other < value for other in values) + (values.count(value) + 1) / 2 for value in values
    ]
