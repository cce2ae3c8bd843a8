"""What an implementation says of itself is checked; what the contract gives it for nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from algorithms.contract import (
    AboutExtractor,
    AboutModel,
    Extractor,
    FeatureKind,
    Model,
    Observation,
    SensorGeometry,
    UnsuitableDesignError,
)

ABOUT = AboutExtractor(
    name="middle", taxonomy="BCM", observation=Observation.FRAMES, kind=FeatureKind.SPOT
)


@dataclass(frozen=True)
class Middle(Extractor):
    about: ClassVar = replace(ABOUT, needs=("centre_px",))
    shift: float = 0.5

    def extract(self, observations):
        return np.full((len(observations), 2), self.shift)


@dataclass
class Ahead(Model):
    about: ClassVar = AboutModel(
        name="ahead",
        taxonomy="SPM",
        needs=("half_fov_deg",),
        accepts=frozenset({FeatureKind.SPOT, FeatureKind.BALANCE}),
    )

    def fit(self, features, sun, context=None):
        return self

    def predict(self, features, context=None):
        return np.tile([0.0, 0.0, 1.0], (len(features), 1))


@pytest.mark.parametrize("name", ["", "Bctm", "b_ctm", "b ctm", "-bctm", "bctm-", "b--c"])
def test_a_name_is_a_slug(name):
    with pytest.raises(ValueError, match="name must be words"):
        replace(ABOUT, name=name)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"taxonomy": ""}, "middle: taxonomy must not be empty"),
        ({"origin": "theirs"}, "middle.*'theirs'"),
        ({"version": 0}, "middle.*1.*0"),
        ({"needs": ("centre_px", "center")}, "SensorGeometry.*center"),
    ],
)
def test_what_cannot_be_is_named(wrong, said):
    with pytest.raises(ValueError, match=said):
        replace(ABOUT, **wrong)


@pytest.mark.parametrize("words", ["studies", "labels", "needs"])
def test_one_word_is_not_taken_for_a_list_of_letters(words):
    with pytest.raises(TypeError, match=f"{words} must be a tuple; got 'He2005'"):
        replace(ABOUT, **{words: "He2005"})


def test_a_model_must_read_something():
    with pytest.raises(ValueError, match="ahead: accepts must name a kind"):
        replace(Ahead.about, accepts=frozenset())


def test_a_design_that_says_what_is_needed_is_taken_by_default():
    assert Middle.for_sensor(SensorGeometry(centre_px=(1.0, 2.0))) == Middle(0.5)
    with pytest.raises(UnsuitableDesignError, match=r"middle.*centre_px"):
        Middle.for_sensor(SensorGeometry())
    wide = SensorGeometry(half_fov_deg=60.0)
    assert Ahead.for_sensor(wide, FeatureKind.SPOT) == Ahead()
    with pytest.raises(UnsuitableDesignError, match=r"ahead.*half_fov"):
        Ahead.for_sensor(SensorGeometry(), FeatureKind.SPOT)
    with pytest.raises(UnsuitableDesignError, match=r"ahead.*balance, spot.*signals"):
        Ahead.for_sensor(wide, FeatureKind.SIGNALS)
