"""Signals that compensations do not learn from: dark faces, and light that darkens a face."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from algorithms.compensations.electronics.angular_loss import AngularLoss
from algorithms.compensations.environment.temperature import TemperatureDrift
from algorithms.compensations.interference.maximum_currents import MaximumCurrents
from algorithms.compensations.interference.sun_and_earth import SunAndEarth
from algorithms.contract import Floats, UnusableDataError

CUBE = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


def sphere() -> Floats:
    vectors = np.random.default_rng(7).standard_normal((200, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


#: Warmth of the samples, and the Earth below them.
BESIDE = {
    "temperature_K": 290.0 + np.arange(200) % 40,
    "nadir": np.tile([0.0, 0.0, -1.0], (200, 1)),
}


@pytest.mark.parametrize(
    ("stage", "said"),
    [
        (AngularLoss(CUBE), r"angular-loss: faces .* positive signals; .* gain of -3\."),
        (MaximumCurrents(CUBE), "maximum-currents needs .* faces with positive signals"),
        (SunAndEarth(CUBE), "sun-and-earth needs .* faces with positive signals"),
    ],
)
def test_a_face_that_light_darkens_is_refused(stage: Any, said: str) -> None:
    sun = sphere()
    signals = 3.0 * np.maximum(sun @ np.array(CUBE).T, 0.0)
    context = {name: BESIDE[name] for name in stage.about.context}
    stage.fit(signals, sun, context)
    with pytest.raises(UnusableDataError, match=said):
        stage.fit(signals * (1, 1, -1, 1, 1, 1), sun, context)  # wired the wrong way round


def test_temperature_is_learnt_of_faces_that_enough_samples_light() -> None:
    sun = sphere()
    warm = BESIDE["temperature_K"]
    signals = np.maximum(sun @ np.array(CUBE).T, 0.0)
    TemperatureDrift(CUBE).fit(signals, sun, {"temperature_K": warm})
    front = sun[:, 1] > -0.02
    with pytest.raises(UnusableDataError, match=r"temperature: face 4 is lit by 0 .* at least 12"):
        TemperatureDrift(CUBE).fit(signals[front], sun[front], {"temperature_K": warm[front]})
