"""Pipelines below the availability limit that are far more accurate over what they answer."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

#: A pipeline below the availability limit is shown beside a ranked one if the ranked one's error is
#: more than `FINER` times as large, and if it answers at least this share of the samples.
FINER = 3.0
LEAST_ANSWERED = 0.5

Of = TypeVar("Of")


@dataclass(frozen=True)
class PartialAnswer(Generic[Of]):
    """Error of a pipeline below the availability limit, over the samples it answers.

    RMS error over the answered samples, their share, and the pipeline or its row in a table.
    """

    error_deg: float
    availability: float
    subject: Of

    @property
    def coarse_deg(self) -> float:
        """Threshold: pipelines with a larger error name this one as finer; infinite for none."""
        return FINER * self.error_deg if self.availability >= LEAST_ANSWERED else math.inf

    def is_finer(self, error_deg: float) -> bool:
        """Return whether it is far more accurate than a given error, of at least half the samples.

        False for an infinite error, which means that there is nothing to compare with.
        """
        return self.coarse_deg < error_deg < math.inf


def better_partial_answer(
    error_deg: float, partly: Iterable[PartialAnswer[Of]]
) -> PartialAnswer[Of] | None:
    """Return the most accurate partial answer, if it is far more accurate than a given error.

    None unless `error_deg`, that of the ranked pipeline, is finite and more than `FINER` times its
    error. Candidates that answer less than `LEAST_ANSWERED` of the samples are ignored.
    """
    finer = (one for one in partly if one.is_finer(error_deg))
    return min(finer, key=lambda one: one.error_deg, default=None)
