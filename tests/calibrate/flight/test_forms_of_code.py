"""Two features become a closed form or a spline that follows the chain, or a reason why not."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from raw_sensors import SENSORS, apart_deg

from algorithms.calibration.hull import Hull
from algorithms.chain import ChainModel
from calibrate.flight.code import flight_code
from calibrate.flight.plane import AIM, plane_steps
from calibrate.flight.program import NoCodeError, run

Array = NDArray[np.float64]


class Formula:
    """A fitted model that is a formula of two features, inside the hull of a disc."""

    def __init__(self, sun: Callable[..., Array], *context: str) -> None:
        self.sun = sun
        self.about = SimpleNamespace(context=context)
        self.hull_ = Hull.around(disc(0.7), "test")

    def predict(self, features: Array, context: Mapping[str, Array] | None = None) -> Array:
        known = {name: (context or {})[name] for name in self.about.context}
        return self.sun(features, **known)


class Warped:
    """A compensation that is a formula, of two features or of signals, and of the temperature."""

    def __init__(self, moved: Callable[[Array, Array], Array]) -> None:
        self.moved = moved
        self.about = SimpleNamespace(name="warped", context=("temperature_K",))

    def transform(self, features: Array, context: Mapping[str, Array]) -> Array:
        return self.moved(features, context["temperature_K"][:, None] - 290.0)


def cosines(features: Array, temperature_K: Array | None = None) -> Array:
    """The features are s_x and s_y, to a scale that falls with the temperature if there is one."""
    if temperature_K is not None:
        features = features / (1.0 + 4e-4 * (temperature_K - 290.0))[:, None]
    square = (features**2).sum(axis=1)
    up = np.sqrt(np.where(square < 1.0, 1.0 - square, np.nan))
    return np.column_stack([np.where(square[:, None] < 1.0, features, np.nan), up])


def homography(features: Array) -> Array:
    """A camera that looks askew."""
    sun = np.column_stack([features, np.ones(len(features))]) @ [
        [1.0, 0.02, -0.1], [-0.03, 0.98, 0.05], [0.01, 0.02, 1.0],
    ]  # fmt: skip
    return np.asarray(sun / np.linalg.norm(sun, axis=1)[:, None])


def bent(features: Array) -> Array:
    """A direction with a kink, which polynomials do not follow."""
    x, y = features.T
    return cosines(np.column_stack([x + 0.02 * np.abs(x - 0.1), y]))


def rippled(features: Array) -> Array:
    """Cosines with a ripple finer than any nodes."""
    return cosines(features + 1e-2 * np.sin(400.0 * features))


def disc(radius: float, count: int = 400) -> Array:
    """Features over a disc."""
    drawn = np.random.default_rng(1).uniform(-radius, radius, (count, 2))
    return np.asarray(drawn[np.linalg.norm(drawn, axis=1) < radius])


def kelvin_of(features: Array, seed: int = 3) -> Array:
    return np.random.default_rng(seed).uniform(250.0, 330.0, len(features))


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (Formula(homography), "a ratio of polynomials of degree 1"),
        (Formula(cosines), "degree"),
        (Formula(bent), "a cubic spline of"),
    ],
    ids=["homography", "cosines", "kink"],
)
def test_the_form_follows_the_chain_on_places_between_the_samples(
    model: Formula, words: str
) -> None:
    steps, said = plane_steps(model, disc(0.7), {}, 0.1 if words.startswith("a cubic") else 0.01)
    assert words in said
    fresh = np.random.default_rng(5).uniform(-0.45, 0.45, (300, 2))
    _, sun, status = run(tuple(steps), fresh)
    assert not status.any()
    largest = np.max(apart_deg(sun, model.predict(fresh)))
    assert largest <= (0.1 * 0.1 if words.startswith("a cubic") else AIM * 0.01)


def test_what_lies_outside_the_chains_hull_is_refused_and_nothing_else() -> None:
    model = Formula(cosines)
    steps, _ = plane_steps(model, disc(0.7), {}, 0.1)
    fresh = np.random.default_rng(5).uniform(-0.9, 0.9, (500, 2))
    _, _, status = run(tuple(steps), fresh)
    assert np.array_equal(status == 0, model.hull_.holds(fresh))
    assert set(status) == {0, 6}


def test_a_chain_that_nothing_follows_is_refused_with_what_it_would_add(camera: Any) -> None:
    found = SENSORS["spots"].calibrated(camera)
    model = Formula(lambda features: rippled((features - 512.0) / 700.0))
    model.hull_ = found.model.hull_
    vars(found)["model"] = model  # the rest of the calibration stays
    with pytest.raises(NoCodeError, match=r"would add .* deg to a model that errs .* deg"):
        flight_code(found)


@pytest.mark.parametrize(
    "model",
    [
        Formula(cosines, "temperature_K"),
        ChainModel(
            SimpleNamespace(context=("temperature_K",)),  # type: ignore[arg-type]
            (Warped(lambda f, warmer: f + warmer * (f * [4e-4, -3e-4] + [1e-5, 2e-5])),),  # type: ignore[arg-type]
            Formula(homography),  # type: ignore[arg-type]
        ),
    ],
    ids=["of the model", "of a stage"],
)
def test_two_features_follow_the_temperature(model: Any) -> None:
    features = disc(0.7)
    context = {"temperature_K": kelvin_of(features)}
    steps, _ = plane_steps(model, features, context, 0.05)
    fresh = np.random.default_rng(5).uniform(-0.4, 0.4, (300, 2))
    warm = kelvin_of(fresh, 4)
    _, sun, status = run(tuple(steps), fresh, warm)
    assert not status.any()
    exact = model.predict(fresh, {"temperature_K": warm})
    assert np.max(apart_deg(sun, exact)) <= 2.0 * AIM * 0.05
    # a stage that is left out would be seen
    assert np.max(apart_deg(model.predict(fresh, {"temperature_K": warm + 20.0}), exact)) > 0.05
