import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import pytest

from api.service.measurements import Measurements as Measured
from benchmark.plan.combinations import scorable_plan, study_plans
from benchmark.plan.shown import data_sets
from benchmark.results.pipelines import pipelines, standard_benches
from benchmark.results.store import PUBLISHED, Store
from benchmark.results.times import read_times
from registry import studies
from registry.fidelity.particulars import RunFact
from registry.measured_pipelines import Measurements
from registry.resolution import Resolution, resolve_all
from registry.studies import AttributeValue, Facts, Study

sys.path.append(str(Path(__file__).parent / "fakes"))

Row = Mapping[str, Sequence[str]]


@pytest.fixture(scope="session")
def survey() -> Facts:
    return studies.facts()


@pytest.fixture(scope="session")
def facts_of(survey: Facts) -> Callable[[Sequence[Row]], Facts]:
    """Facts of invented studies S0, S1, ... with the survey's vocabulary."""

    def build(rows: Sequence[Row]) -> Facts:
        found = {}
        for at, row in enumerate(rows):
            values = {a: tuple(AttributeValue(v, "title", "", "") for v in row[a]) for a in row}
            found[f"S{at}"] = Study(
                key=f"S{at}",
                title=f"Study {at}",
                authors="",
                year=2020,
                venue="",
                doi="",
                url="",
                identity="confirmed",
                note="",
                values=MappingProxyType({a: cells for a, cells in values.items() if cells}),
                unknown=MappingProxyType({a: "" for a, cells in values.items() if not cells}),
            )
        how = {
            key: (RunFact(key, "calibration", "fitted", "abstract", key, "it says so"),)
            for key in found
        }
        return Facts(found, survey.taxonomy, run_facts=how)

    return build


@pytest.fixture(scope="session")
def published() -> Measurements:
    """The published measurements, with their times."""
    store = Store(PUBLISHED)
    times = read_times(store.directory).latency_us
    rows = pipelines(store.rows(unit=None), times, standard_benches(store.pins()))
    return Measurements(rows)


@pytest.fixture(scope="session")
def everything() -> Mapping[str, Resolution]:
    """Every study of the survey, resolved and graded by the published scores."""
    plans = {"own": study_plans(), "data_sets": data_sets()}
    return resolve_all(scorable_plan(), **plans, scores=Measured().own_errors)
