"""What a sensor's temperature does to its readings, as stages ahead of a model.

A stage takes readings f at a temperature T to ``f + (T - T_0) (slope f + shift)``: linear in the
readings and in the temperature, so that flight software does the same in one line a reading. Only
differences of temperatures count: kelvin and degrees Celsius give the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.chain import Chain, Scored
from algorithms.contract import (
    AboutCompensation,
    Compensation,
    FeatureKind,
    Floats,
    SensorGeometry,
    UnusableDataError,
)
from calibrate.robust import degree_for, terms

#: Models that a term of temperature is tried ahead of, by the stage's name: the simplest that fit
#: most sensors, since every one more is fitted a dozen times.
_AHEAD_OF = {
    "temperature-terms": ("spm", "homography", "sigmoid", "lut-polynomial"),
    "temperature-gains": ("basic", "assembled-faces", "trig", "panoramic", "pyramidal"),
}
#: Standard deviation of the temperature, K, that the direction must leave unexplained.
_SMALLEST_SPREAD = 2.0
#: Light on a channel over the most that it gets, from which its reading is a smooth function of
#: the direction, and the degree of that function.
_LIT, _CUBIC = 0.2, 3


@dataclass
class _LinearInTemperature(CalibratedCompensation):
    """Readings at one temperature, by terms linear in the readings and in the temperature."""

    slope_: Floats = field(init=False, repr=False, compare=False)
    shift_: Floats = field(init=False, repr=False, compare=False)
    reference_k_: float = field(init=False, repr=False, compare=False)

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Features (N, F) at the reference temperature."""
        warmer = (context["temperature_K"] - self.reference_k_)[:, None]
        return np.asarray(features + warmer * (features @ self.slope_.T + self.shift_))


@dataclass
class TemperatureTerms(_LinearInTemperature):
    """Spots or balances converted to one temperature.

    The simplest of four forms that explains them is taken (Bayes's criterion): a shift, a shift
    with one scale, with a scale an axis, and with any linear map. A scale with a shift is a scale
    about a centre. `slope_` (2, 2) and `shift_` (2,) are the changes a kelvin that are taken back,
    relative and as they are, from `reference_k_`, the calibration's mean temperature.

    What readings would be at one temperature is a polynomial of the direction, up to the fifth
    degree, of its tangents or of its cosines, whichever leaves less; fitted with the terms by least
    squares. So the terms do not depend on the model behind.

    Failure: fit raises UnusableDataError where the temperature hardly changes apart from the
    direction, and where no term explains anything.
    """

    about: ClassVar = AboutCompensation(
        name="temperature-terms",
        taxonomy="SECM/Temperature",
        accepts=frozenset({FeatureKind.SPOT, FeatureKind.BALANCE}),
        context=("temperature_K",),
    )

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn slope and shift."""
        reference, warmer = _warmth(context)
        tangents = sun[:, :2] / sun[:, 2:]
        degree = degree_for(len(sun), 2)
        span = min(
            (_span(terms(places, degree)) for places in (tangents, sun[:, :2])),
            key=lambda one: float((_left(features, one) ** 2).sum()),
        )
        _require_spread(_left(warmer, span), self.about.name)
        x, y = features.T
        none = np.zeros_like(x)
        forms = {
            "shift": (),
            "scale": ((x, y),),
            "scales": ((x, none), (none, y)),
            "linear": ((x, none), (y, none), (none, x), (none, y)),
        }
        shift = ((np.ones_like(x), none), (none, np.ones_like(x)))
        found = _simplest(
            features,
            {name: [-(warmer * np.array(one)).T for one in (*shift, *form)]
             for name, form in forms.items()},
            span,
        )  # fmt: skip
        if found is None:
            raise UnusableDataError(f"{self.about.name}: readings do not go with the temperature")
        form, numbers = found
        self.shift_ = numbers[:2]
        scales = {"shift": np.zeros(2), "scale": np.repeat(numbers[2:], 2)}.get(form, numbers[2:])
        self.slope_ = numbers[2:].reshape(2, 2) if form == "linear" else np.diag(scales)
        self.reference_k_ = reference


@dataclass
class TemperatureGains(_LinearInTemperature):
    """Signals of photodiodes or solar cells converted to one temperature.

    A gain, an offset, both or none for each of the channels, the simplest that explains it (Bayes's
    criterion). `slope_` (K, K), diagonal, and `shift_` (K,) are as those of `TemperatureTerms`.

    What a lit channel reads at one temperature is a cubic of the direction, fitted with its terms
    by least squares over the samples that give it a fifth of its most light or more. It is told
    apart from `TemperatureDrift` by needing no drawing and by its offsets.

    Failure: fit raises UnusableDataError where the temperature hardly changes apart from the
    direction, and where no term explains anything.
    """

    about: ClassVar = AboutCompensation(
        name="temperature-gains",
        taxonomy="SECM/Temperature",
        accepts=frozenset({FeatureKind.SIGNALS}),
        context=("temperature_K",),
    )
    frontal: ClassVar[bool] = False

    channels: int

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the stage for as many channels as the drawing has faces."""
        cls.about.require_kind(kind)
        geometry.require("face_normals", by=cls.about.name)
        return cls(len(geometry.face_normals or ()))

    def columns(self) -> int:
        """One a channel."""
        return self.channels

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn every channel's gain and offset."""
        reference, warmer = _warmth(context)
        slopes, shift = np.zeros(self.channels), np.zeros(self.channels)
        for at, signal in enumerate(features.T):
            lit = signal > _LIT * np.percentile(signal, 95)
            span = _span(terms(sun[lit], _CUBIC))
            _require_spread(_left(warmer[lit], span), self.about.name)
            level, there = -(warmer * signal)[lit, None], -warmer[lit, None]
            forms = {"gain": [level], "offset": [there], "both": [level, there]}
            found = _simplest(signal[lit, None], forms, span)
            if found is not None:
                form, numbers = found
                slopes[at] = 0.0 if form == "offset" else numbers[0]
                shift[at] = 0.0 if form == "gain" else numbers[-1]
        if not (slopes.any() or shift.any()):
            raise UnusableDataError(f"{self.about.name}: signals do not go with the temperature")
        self.slope_, self.shift_, self.reference_k_ = np.diag(slopes), shift, reference


#: Stages by name, as a saved calibration finds them.
TERMS: dict[str, type[Compensation]] = {
    one.about.name: one for one in (TemperatureTerms, TemperatureGains)
}


def with_temperature(models: Mapping[str, Scored], kind: FeatureKind) -> dict[str, Scored]:
    """Return chains of a term of temperature and each simple model there is, by name.

    Of the models, by name, that apply to readings of this kind.
    """
    found: dict[str, Scored] = {}
    for name, stage in TERMS.items():
        if kind in stage.about.accepts:
            for model in _AHEAD_OF[name]:
                last = models.get(model)
                if last is not None and not isinstance(last, Chain):
                    found[f"{name} + {model}"] = Chain((stage,), last)
    return found


def _warmth(context: Columns) -> tuple[float, Floats]:
    temperature = context["temperature_K"]
    reference = float(np.mean(temperature))
    return reference, temperature - reference


def _span(design: Floats) -> Floats:
    """Orthonormal columns (n, rank) of the same span."""
    u, size, _ = np.linalg.svd(design / np.linalg.norm(design, axis=0), full_matrices=False)
    return np.asarray(u[:, size > 1e-9 * size[0]])


def _left(columns: Floats, span: Floats) -> Floats:
    """Return what a span leaves of columns (n, ...)."""
    return np.asarray(columns - span @ (span.T @ columns))


def _require_spread(left: Floats, by: str) -> None:
    spread = float(np.std(left))
    if not spread >= _SMALLEST_SPREAD:
        raise UnusableDataError(
            f"{by} needs poses at other temperatures, whose spread apart from the direction is "
            f"{_SMALLEST_SPREAD:g} K or more; theirs is {spread:.3g} K"
        )


def _simplest(
    readings: Floats, forms: Mapping[str, list[Floats]], span: Floats
) -> tuple[str, Floats] | None:
    """Return the form with the smallest Bayes's criterion and its numbers; None for no form."""
    count = readings.size
    aim = _left(readings, span).reshape(-1)
    best = count * np.log(max(float(aim @ aim), 1e-300))
    found = None
    for name, columns in forms.items():
        design = np.column_stack([_left(one, span).reshape(-1) for one in columns])
        numbers: Floats = np.asarray(np.linalg.lstsq(design, aim, rcond=1e-12)[0], dtype=np.float64)
        rest = aim - design @ numbers
        criterion = count * np.log(max(float(rest @ rest), 1e-300)) + len(numbers) * np.log(count)
        if criterion < best:
            best, found = criterion, (name, numbers)
    return found
