"""A pipeline that stands for a study, and what of the study does not run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from registry.fidelity.purposes import DatasetCondition
from registry.sensors import BASES, SENSOR, Basis
from survey_data.json_data import JsonData

ESSENTIAL = (*SENSOR, "extractor", "model")
"""Parts of a pipeline, each of which rests on something."""


@dataclass(frozen=True)
class RunnablePipeline(JsonData):
    """An extractor and a model, by name, on a sensor of the study, with what each rests on.

    ``stages`` are the model's by their taxonomy values: compensations, and the model itself last.
    ``basis`` says of detector, mask, extractor and model what they rest on, ``assumed`` of
    those that are not stated by what rule they stand there. ``datasets`` are all that it can be
    scored on; ``settings`` those of them that stand for the study, each under a condition, the one
    that tells most first.
    """

    detector: str
    mask: str
    extractor: str
    model: str
    extractor_taxonomy: str
    model_taxonomy: str
    stages: tuple[str, ...]
    basis: Mapping[str, Basis] = field(hash=False)
    assumed: Mapping[str, str] = field(hash=False)
    datasets: tuple[str, ...]
    settings: tuple[DatasetCondition, ...]

    @property
    def strength(self) -> list[int]:
        """What its parts rest on as ranks, the weakest first: smaller is better."""
        return sorted((BASES.index(basis) for basis in self.basis.values()), reverse=True)


Part = Literal[
    "identity", "sensor", "condition", "extractor", "model", "compensation", "calibration", "score"
]


@dataclass(frozen=True)
class Departure(JsonData):
    """A part of a study's run that is not the study's own, or that cannot be judged.

    ``text`` says what departs, as a clause; ``settled_by`` what would make the part the study's;
    ``unknown`` whether a fact is missing, rather than that the run differs.
    """

    part: Part
    value: str
    text: str
    settled_by: str
    unknown: bool = False


@dataclass(frozen=True)
class Gap(JsonData):
    """Something of a study that does not run as it is, and why.

    ``attribute`` is one of the study's (value "" if its cell is empty), or "architecture" with
    the value "detector + mask".
    """

    attribute: str
    value: str
    reason: str


def strongest(pipelines: Sequence[RunnablePipeline]) -> list[RunnablePipeline]:
    """Return the pipelines that rest on most: those whose weakest part is strongest, and so on."""
    best = min((pipeline.strength for pipeline in pipelines), default=[])
    return [pipeline for pipeline in pipelines if pipeline.strength == best]
