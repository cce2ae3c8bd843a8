"""Sweeps: what is measured, stored, renewed and compared."""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from algorithms.contract import AboutExtractor, FeatureKind, Observation
from algorithms.discovery import discover_extractors
from benchmark.experiments.sweeps import Sweeps
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.running.experiment import update
from benchmark.sweeps import plan as sweep_plan
from benchmark.sweeps.record import RECORD, swept
from benchmark.synthetic_features.series import SWEEPS


@dataclass(frozen=True)
class Plain:
    """Balances by the closed form."""

    about: ClassVar = AboutExtractor(
        name="plain",
        taxonomy="Voltage balance",
        origin="survey",
        observation=Observation.CURRENTS,
        kind=FeatureKind.BALANCE,
    )
    features: ClassVar[tuple[str, ...]] = ("s_a", "s_b")

    @classmethod
    def for_sensor(cls, geometry):
        return cls()

    def extract(self, observations):
        q1, q2, q3, q4 = observations.T
        both = np.column_stack([q2 + q3 - q1 - q4, q1 + q2 - q3 - q4])
        return both / observations.sum(axis=1, keepdims=True)


class Broken(Plain):
    about = dataclasses.replace(Plain.about, name="broken")

    def extract(self, observations):
        raise RuntimeError("no light")


class Spots(Plain):
    about = dataclasses.replace(Plain.about, name="spots-of-readings", kind=FeatureKind.SPOT)


POINTS = len(sweep_plan.SERIES["quadrants"].settings())
FEW = {c.about.name: c for c in (Plain, Broken, Spots)}


def of(directory, extractors=FEW):
    return Sweeps(directory, Parts({}, extractors, {}))


def computed(directory, extractors=FEW, workers=1):
    return update(of(directory, extractors), workers, silent).computed


def table(directory):
    return (directory / RECORD.name).read_bytes()


@pytest.fixture
def made(tmp_path):
    computed(tmp_path)
    return tmp_path


def test_points_are_measured_failures_named_and_misfits_listed(made):
    rows = swept(made)
    states = {name: {r["status"] for r in rows if r["extractor"] == name} for name in FEW}
    assert states == {"plain": {"ok"}, "broken": {"failed"}, "spots-of-readings": {"refused"}}
    assert len(rows) == 1 + 2 * POINTS
    reasons = {row["reason"] for row in rows if row["status"] == "failed"}
    assert reasons == {"RuntimeError: no light"}
    (unmeasured,) = (row for row in rows if not row["sweep"])
    assert (unmeasured["series"], unmeasured["extractor"]) == ("", "spots-of-readings")
    assert re.search(r"\bcurrents\b.*\bspot\b", unmeasured["reason"])


def test_the_closed_form_of_balances_is_at_the_bound(made):
    found = [
        row["over_bound"]
        for row in swept(made)
        if row["extractor"] == "plain" and row["sweep"] == "noise"
    ]
    assert len(found) == 7
    assert found == pytest.approx([1.0] * 7, abs=0.08)


def test_every_method_of_the_survey_has_a_noise_sweep():
    """Accept point: all 19 values of the taxonomy, error and bound from SNR 5 upwards."""
    known = discover_extractors()
    plan = sweep_plan.plan_points(known)
    swept = {known[p.extractor].about.taxonomy for p in plan.settings if p.sweep == "noise"}
    implemented = {extractor.about.taxonomy for extractor in known.values()}
    assert implemented <= swept
    for point, reason in plan.refused.items():
        assert reason, point
    assert {point.sweep for point in plan.settings} == set(SWEEPS)
