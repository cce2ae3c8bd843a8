"""Poses of a data set as models see them, to be chosen from or altered before a fit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Floats, Model
from benchmark.claims.benches import ConditionView, separation

#: Rows that run times are taken over: many enough that a call's own cost is none.
TIMED_ROWS = 20_000


@dataclass(frozen=True)
class Poses:
    """Features (N, F) and the directions (N, 3) of the Suns that made them."""

    features: Floats
    sun: Floats

    @classmethod
    def of(cls, seen: ConditionView, extractor: type[Extractor], split: str) -> Self:
        """Return a split as this extractor reads it."""
        return cls(seen.features(extractor, split), seen.samples(split).sun)

    def select(self, rows: NDArray[Any]) -> Self:
        """Return some of them, by mask or by number."""
        return replace(self, features=self.features[rows], sun=self.sun[rows])

    def shift(self, by: Floats) -> Self:
        """Return them with other features: (N, F) is added."""
        return replace(self, features=self.features + by)


def errors(model: Model, known: Poses, asked: Poses) -> Floats:
    """Separation angles (N,) in degrees at the Suns asked, of a model fitted to those known."""
    model.fit(known.features, known.sun)
    return separation(model.predict(asked.features), asked.sun)


def many(features: Floats) -> Floats:
    """Return `TIMED_ROWS` rows: these, over and over."""
    return np.asarray(np.resize(features, (TIMED_ROWS, features.shape[1])))
