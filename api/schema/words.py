"""Closed lists of words that parameters take, each loaded when it is first needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Annotated

from api.schema.parameters import OneOf
from registry.flows import CHARTS
from registry.requirements import HAZARDS, NEEDS
from registry.studies import facts


def _values_of(attribute: str) -> Callable[[], Sequence[str]]:
    return lambda: facts().taxonomy.values(attribute)


@cache
def datasets() -> tuple[str, ...]:
    """Names of the standard data sets. The first use loads the simulator."""
    from benchmark.datasets import names  # noqa: PLC0415 - slow, and not needed to make the service

    return names()


@cache
def conditions() -> tuple[str, ...]:
    """Conditions that any standard data set has, the nominal one first."""
    from benchmark.datasets import get  # noqa: PLC0415 - as above

    found = (condition for name in datasets() for condition in get(name).conditions)
    return tuple(dict.fromkeys(("nominal", *found)))


@cache
def sweeps() -> tuple[str, ...]:
    """Names of the quantities that sweeps vary."""
    from benchmark.synthetic_features.series import SWEEPS  # noqa: PLC0415 - slow, as above

    return tuple(SWEEPS)


@cache
def series() -> tuple[str, ...]:
    """Names of the synthetic features of sweeps."""
    from benchmark.sweeps.plan import SERIES  # noqa: PLC0415 - slow, as above

    return tuple(SERIES)


@cache
def extractors() -> tuple[str, ...]:
    """Names of the implementations of extractors."""
    from registry.catalogue import catalogue  # noqa: PLC0415 - slow, as above

    return tuple(catalogue().extractors)


@cache
def models() -> tuple[str, ...]:
    """Names of the implementations of models."""
    from registry.catalogue import catalogue  # noqa: PLC0415 - slow, as above

    return tuple(catalogue().models)


@cache
def assessed_methods() -> tuple[str, ...]:
    """Methods of the survey's assessment, in the order of its table."""
    from survey_data import load  # noqa: PLC0415 - slow, as above

    return tuple(dict.fromkeys(load().feature_assessment["extractor"]))


@cache
def claim_verdicts() -> tuple[str, ...]:
    """Verdicts of claims, and the word for none."""
    from benchmark.claims.rules import VERDICTS  # noqa: PLC0415 - slow, as above

    return (*VERDICTS, "not measured")


@cache
def claim_ids() -> tuple[str, ...]:
    """Ids of the survey's claims."""
    from survey_data import load  # noqa: PLC0415 - slow, as above

    return tuple(load().claims["id"])


Task = Annotated[str, OneOf(_values_of("task"))]
Error = Annotated[str, OneOf(_values_of("error"))]
Accuracy = Annotated[str, OneOf(_values_of("accuracy"))]
Detector = Annotated[str, OneOf(_values_of("detector"))]
Mask = Annotated[str, OneOf(_values_of("mask"))]
Model = Annotated[str, OneOf(_values_of("model"))]
Extractor = Annotated[str, OneOf(_values_of("extractor"))]

Hazard = Annotated[str, OneOf(lambda: tuple(HAZARDS))]
Need = Annotated[str, OneOf(lambda: tuple(NEEDS))]
Property = Annotated[str, OneOf(lambda: tuple(facts().properties))]

StudyKey = Annotated[str, OneOf(lambda: facts("all").keys)]
Chart = Annotated[str, OneOf(lambda: tuple(CHARTS))]
DatasetName = Annotated[str, OneOf(datasets)]
Condition = Annotated[str, OneOf(conditions)]
ExtractorName = Annotated[str, OneOf(extractors)]
ModelName = Annotated[str, OneOf(models)]
MethodName = Annotated[str, OneOf(assessed_methods)]
Series = Annotated[str, OneOf(series)]
SweepName = Annotated[str, OneOf(sweeps)]
ClaimId = Annotated[str, OneOf(claim_ids)]
ClaimVerdict = Annotated[str, OneOf(claim_verdicts)]
