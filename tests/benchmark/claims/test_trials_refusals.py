"""Trials refuse sensors that their claim is not about; silence is no error of its own."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import pytest

from algorithms.contract import AboutModel, FeatureKind, SensorGeometry
from benchmark.claims.experiments.coarse import c18_interference as c18
from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.standard import pd_maskless_pyramid


@dataclass
class Silenced:
    """Answers straight ahead, and nothing once signals add up to more than ever in calibration."""

    about: ClassVar = AboutModel(
        name="fake-silenced", taxonomy="LSQ", accepts=frozenset({FeatureKind.SIGNALS})
    )
    most_: float = field(default=math.inf, init=False)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Silenced:
        return cls()

    def fit(self, features: Any, sun: Any, context: Any = None) -> Silenced:
        self.most_ = 1.05 * float(np.sum(features, axis=1).max())
        return self

    def predict(self, features: Any, context: Any = None) -> Any:
        silent = np.sum(features, axis=1).max() > self.most_
        return np.full((len(features), 3), np.nan) if silent else np.eye(3)[[2] * len(features)]


def test_a_method_that_interference_silences_has_no_ratio_of_errors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    preset = dataclasses.replace(pd_maskless_pyramid.PRESET, directions=ConeField(55.0, 40, 40))
    monkeypatch.setattr(pd_maskless_pyramid, "PRESET", preset)
    monkeypatch.setattr(c18, "METHODS", dict.fromkeys(c18.METHODS, Silenced))
    found = c18.trial(1000)
    assert math.isnan(found.values["constant"])
    _, errors = found.lines["pyramidal, constant"]
    assert np.isfinite(errors).tolist() == [share < c18.JUDGED for share in c18.SHARES]
    assert errors[0] == errors[1] == 0.0  # an answer that never moves
