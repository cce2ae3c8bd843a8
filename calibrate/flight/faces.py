"""Steps from signals of faces to a direction: each fitted model and compensation itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from algorithms.contract import Floats
from algorithms.models.geometric.detector_faces import axis_faces, opposite_pairs
from algorithms.models.geometric.panoramic import FLATTEST
from calibrate.flight.program import NoCodeError, Step, run

#: Steps of an assembled array towards a direction; ten are usual, a few rows take more.
STEPS = 60
#: Largest variance that leaves a direction, and the bend's width over the noise, as the model has.
_WORST, _BEND = 0.1**2, 0.5
#: Powers of the temperature that an unknown compensation is followed by, and how closely.
_POWERS, _CLOSE = 4, 1e-9


def faces_steps(
    model: Any, signals: Floats, context: Mapping[str, Floats]
) -> tuple[list[Step], str]:
    """Return the steps from signals (N, K) of the calibration to a direction, and a word for them.

    NoCodeError if the model or a compensation is none that code is written for.
    """
    steps: list[Step] = []
    for stage in getattr(model, "compensations", ()):
        steps.append(_stage(stage, signals, context))
        signals = stage.transform(signals, context)
    last = getattr(model, "model", model)
    name = last.about.name
    if name not in _MODELS:
        raise NoCodeError(
            f"flight code is not written for the model {name}; choose another, such as "
            "--model trig (six faces) or --model assembled-faces"
        )
    steps += _MODELS[name](last)
    region = getattr(last, "hull_", None)
    if region is not None and len(region.facets) and np.isfinite(region.margin):
        steps.append(_cone(region))
    return steps, f"the model {name} itself"


def _cone(region: Any) -> Step:
    sides = len(region.facets)
    return Step(
        "cone",
        {
            "sides": sides,
            "normal": region.facets[:, :3],
            "offset": region.facets[:, 3],
            "margin": float(region.margin),
        },
        7 * sides,
    )


def _stage(stage: Any, signals: Floats, context: Mapping[str, Floats]) -> Step:
    name, count = stage.about.name, signals.shape[1]
    if name == "temperature":
        return _warmth(stage.coefficients_, stage.reference_k_)
    if name == "angular-loss":
        return Step(
            "angular_loss",
            {"faces": count, "gain": stage.gains_, "response": stage.response_},
            121 * count,
        )
    if name == "maximum-currents":
        plus, minus = axis_faces(stage.face_normals, name)
        return Step(
            "maximum_currents",
            {"plus": np.array(plus), "minus": np.array(minus), "full": stage.one_sun_},
            18,
        )
    if tuple(stage.about.context) == ("temperature_K",):
        return _drift(stage, signals, context)
    raise NoCodeError(f"flight code is not written for the compensation {name}")


def _warmth(coefficients: Floats, reference: float) -> Step:
    count = len(coefficients)
    constants = {"faces": count, "coefficient": coefficients, "reference": float(reference)}
    return Step("warmth", constants, 5 * count)


def _drift(stage: Any, signals: Floats, context: Mapping[str, Floats]) -> Step:
    """Return gains and offsets as polynomials of the temperature that do what a stage does."""
    kelvin = context["temperature_K"]
    low, high = float(kelvin.min()), float(kelvin.max())
    middle, half = (low + high) / 2.0, max((high - low) / 2.0, 1e-9)
    at = middle + half * np.cos(np.pi * (np.arange(_POWERS + 1) + 0.5) / (_POWERS + 1))
    one, two = np.percentile(signals, 10, axis=0), np.percentile(signals, 90, axis=0)
    two = np.where(two > one, two, one + 1.0)
    values = [
        stage.transform(np.tile(place, (len(at), 1)), {"temperature_K": at}) for place in (one, two)
    ]
    gains = (values[1] - values[0]) / (two - one)
    levels = values[0] - gains * one
    design = np.polynomial.chebyshev.chebvander((at - middle) / half, _POWERS)
    fits = np.stack([np.linalg.solve(design, numbers) for numbers in (gains, levels)])
    size = np.abs(fits).max(axis=(0, 2)) > 1e-12 * np.abs(fits).max()
    degree = max(int(np.flatnonzero(size)[-1]), 0)
    made = Step(
        "drift",
        {
            "faces": signals.shape[1], "degree": degree, "middle": middle, "half": half,
            "gain": fits[0, : degree + 1], "level": fits[1, : degree + 1],
        },
        signals.shape[1] * (4 * (degree + 1) + 2) + 3 * degree + 2,
    )  # fmt: skip
    exact = stage.transform(signals, context)
    off = np.abs(run((made,), signals, kelvin)[0] - exact)
    if not float(off.max()) <= _CLOSE * float(np.abs(exact).max()):
        raise NoCodeError(
            f"flight code is not written for the compensation {stage.about.name}: no gain and "
            "offset of each channel follows it"
        )
    return made


def _panoramic(model: Any) -> list[Step]:
    count = len(model.reference_)
    return [
        Step(
            "panoramic",
            {
                "faces": count,
                "normal": np.asarray(model.face_normals, dtype=np.float64),
                "reference": model.reference_,
                "least_cosine": float(np.cos(np.radians(model.largest_incidence_deg))),
                "by_signal": int(model.weighting == "signal"),
                "flattest": float(FLATTEST),
            },
            27 * count + 80,
            count + 1,
        )
    ]


def _panoramic_temperature(model: Any) -> list[Step]:
    fall = np.full(len(model.reference_), -model.coefficient_)
    return [_warmth(fall, model.reference_temperature_K), *_panoramic(model)]


def _pyramidal(model: Any) -> list[Step]:
    normals = np.asarray(model.face_normals, dtype=np.float64)
    weight = normals / (normals**2).sum(axis=0) * model.coefficients_[:, None]
    count = len(normals)
    constants = {"faces": count, "weight": weight, "dark_share": float(model.dark_fraction)}
    return [Step("pyramidal", constants, 10 * count + 12, 1)]


def _pyramidal_constant(model: Any) -> list[Step]:
    normals = np.asarray(model.face_normals, dtype=np.float64)
    rows = normals[:, :2]
    count = len(normals)
    constants = {
        "faces": count,
        "weight": rows / (rows**2).sum(axis=0) * model.coefficient_,
        "coefficient": float(model.coefficient_),
        "up": float(normals[0, 2]),
        "misfit": float(model.largest_misfit),
        "normal": rows,
    }
    return [Step("pyramidal_constant", constants, 13 * count + 12, count + 1)]


def _solar_panel(model: Any) -> list[Step]:
    normals = np.asarray(model.face_normals, dtype=np.float64)
    constants = {"faces": len(normals), "normal": normals}
    return [Step("weighted_normals", constants, 9 * len(normals) + 12, 1)]


def _basic(model: Any) -> list[Step]:
    plus, minus = axis_faces(model.face_normals, model.about.name)
    constants = {"plus": np.array(plus), "minus": np.array(minus)}
    return [Step("brighter_faces", constants, 24, 1)]


def _pairs(model: Any) -> dict[str, Any]:
    pairs = opposite_pairs(np.asarray(model.face_normals, dtype=np.float64))
    first, second = np.array(pairs).T
    return {"first": first, "second": second}


def _trig(model: Any) -> list[Step]:
    pairs = _pairs(model)
    constants = {
        **pairs,
        "bits": np.array([1, 2, 4]),
        "level": model.offsets_,
        "amplitude": np.sqrt((model.amplitudes_**2).sum(axis=1)),
        "inverse": np.linalg.inv(model._octants()),  # noqa: SLF001 - the model's own equations
    }
    return [Step("trig", constants, 54, 1)]


def _trig_averaged(model: Any) -> list[Step]:
    pairs = _pairs(model)
    normals = np.asarray(model.face_normals, dtype=np.float64)
    constants = {**pairs, "normal": normals[pairs["first"]], "curve": model.curves_}
    return [Step("trig_averaged", constants, 90, 4)]


def _signal_polynomial(model: Any) -> list[Step]:
    count, terms = len(model.middle_), len(model.powers_)
    degree = int(model.powers_.max())
    constants = {
        "faces": count,
        "terms": terms,
        "degree": degree,
        "middle": model.middle_,
        "half": np.where(model.half_range_ > 0, model.half_range_, 1.0),
        "power": model.powers_,
        "coefficients": model.coefficients_,
        "reach": 1.1 + float(model.extrapolation),
    }
    operations = count * (4 + 3 * degree) + terms * (count + 6) + 12
    return [Step("signal_polynomial", constants, operations, count + 1)]


def _assembled(model: Any) -> list[Step]:
    count = len(model.normals_)
    constants = {
        "faces": count,
        "steps": STEPS,
        "normal": model.normals_,
        "response": model.responses_,
        "dark": model.dark_,
        "noise": model.noise_,
        "width": _BEND * model.noise_,
        "level_spread": float(model.level_spread),
        "worst": _WORST,
    }
    a_step = 92 * count + 130
    return [
        Step("assembled_faces", constants, (STEPS + 1) * a_step + 150 * count + 150,
             (STEPS + 1) * (3 * count + 1) + 3)
    ]  # fmt: skip


_MODELS: dict[str, Callable[[Any], list[Step]]] = {
    "panoramic": _panoramic,
    "panoramic-temperature": _panoramic_temperature,
    "pyramidal": _pyramidal,
    "pyramidal-constant": _pyramidal_constant,
    "solar-panel": _solar_panel,
    "basic": _basic,
    "trig": _trig,
    "trig-averaged": _trig_averaged,
    "polynomial-signals": _signal_polynomial,
    "assembled-faces": _assembled,
}
