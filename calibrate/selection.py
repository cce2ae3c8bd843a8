"""Choosing a model: every one that applies, by errors on runs or blocks of poses left out."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.calibration.blocks import folds
from algorithms.calibration.hull import Hull
from algorithms.chain import Scored
from algorithms.contract import (
    FeatureKind,
    Floats,
    Model,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.discovery import discover_chains
from calibrate.causes.light import LESS_LIGHT
from calibrate.conventions.channels import face_normals
from calibrate.conventions.findings import linear_map
from calibrate.readings import Readings
from calibrate.settings import Settings
from calibrate.terms.temperature import with_temperature

#: Networks, trained for minutes; tried with ``thorough``.
NETWORKS = frozenset({"ann", "dnn", "dnn-surface"})
#: Samples that models are compared on; more are thinned evenly for the comparison alone.
MOST_COMPARED = 6000
#: RMS over the directions' own spread from which a model explains no more than chance does.
_CHANCE = 0.5
#: Fewest runs that are left out one by one; with fewer, blocks of poses are.
_FEWEST_RUNS = 3
#: Samples of a run for it to be one that can be left out.
_FEWEST_OF_RUN = 20
#: What models say of readings that they cannot explain.
_APART = "do not belong together"
#: Families from the simplest to the most flexible: of two as good, the first is taken.
_FLEXIBILITY = (
    *("spm", "basic", "linear", "homography", "camera", "lsq", "pinhole", "qpd", "solar-panel"),
    *("trig", "trig-averaged", "pyramidal", "pyramidal-constant", "panoramic", "sigmoid"),
    *("assembled-faces", "polynomial-1d", "polynomial-2d", "polynomial-signals", "lut-polynomial"),
    *("fourier-balance", "lut"),
)


@dataclass(frozen=True)
class Candidate:
    """A model and how it did on what it had not seen."""

    name: str  # of the model, or of compensations and model
    rms_deg: float = float("nan")  # of samples left out
    spread_deg: float = float("nan")  # standard error of it over the folds
    worst_deg: float = float("nan")  # of the worst fold
    missing: float = float("nan")  # share of samples left out that were not answered
    parameters: int = 0  # that the fit names; 0 of tables
    seconds: float = float("nan")  # of one fit
    refused: str = ""  # why it cannot be fitted; empty where it can
    errors: Floats | None = field(default=None, repr=False)
    offsets: Floats | None = field(default=None, repr=False)
    deviation: Floats | None = field(default=None, repr=False)
    moved_deg: float = 0.0  # RMS of what its answers move by with a tenth less light


def geometry_of(readings: Readings, settings: Settings) -> SensorGeometry:
    """Return the drawing as stated, with what the readings themselves tell where it says nothing.

    Focal length and centre come from the slope of spots or balances over tangents, normals of faces
    from the light that each channel takes.
    """
    stated = settings.sensor.geometry()
    parameters: dict[str, Any] = {}
    if readings.kind is FeatureKind.SIGNALS:
        if stated.face_normals is None:
            normals, _ = face_normals(readings)
            parameters["face_normals"] = tuple(
                tuple(float(c) for c in one) for one in as_cube(normals)
            )
    elif (fit := linear_map(readings)) is not None:
        slope, offset = fit
        scale = float(np.sqrt(abs(np.linalg.det(slope)))) or 1.0
        if readings.kind is FeatureKind.SPOT:
            pitch = stated.pixel_pitch_mm or 1.0
            parameters |= {"pixel_pitch_mm": pitch, "focal_length_mm": scale * pitch}
            parameters["centre_px"] = (float(offset[0]), float(offset[1]))
        else:
            # s = 2 h tan / d: any h will do with the d that goes with it
            parameters |= {"focal_length_mm": 1.0}
            parameters |= {"aperture_width_mm": 2.0 / scale, "aperture_shape": "square"}
    known = {name for name in vars(stated) if getattr(stated, name) is not None}
    values = {name: getattr(stated, name) for name in known}
    return SensorGeometry(**{**parameters, **values})


def as_cube(normals: Floats) -> Floats:
    """Return normals (K, 3), turned to the nearest axes where all are a cube's within 10 deg."""
    nearest = np.zeros_like(normals)
    at = np.argmax(np.abs(normals), axis=1)
    nearest[np.arange(len(normals)), at] = np.sign(normals[np.arange(len(normals)), at])
    close = (normals * nearest).sum(axis=1) > np.cos(np.radians(10.0))
    if close.all() and len(np.unique(nearest, axis=0)) == len(normals) == 6:
        return nearest + 0.0
    return normals


def applicable(
    readings: Readings, geometry: SensorGeometry, *, thorough: bool = False
) -> dict[str, Scored]:
    """Return the models, alone and behind compensations, that read such features and context."""
    found = {}
    for name, scored in discover_chains().items():
        about = scored.about
        if readings.kind not in about.accepts or not set(about.context) <= set(readings.context):
            continue
        if any(getattr(geometry, need) is None for need in about.needs) or "kalman" in name:
            continue
        if about.context and "temperature_K" not in about.context:
            continue
        if not thorough and any(part in NETWORKS for part in name.split(" + ")):
            continue
        found[name] = scored
    if "temperature_K" in readings.context:
        found |= with_temperature(found, readings.kind)
    return found


def fold_of(readings: Readings) -> tuple[NDArray[np.int64], str]:
    """Return the fold (N,) in which each sample is left out, -1 for never, and a word for folds."""
    counts = np.bincount(readings.run)
    if (counts >= _FEWEST_OF_RUN).sum() >= _FEWEST_RUNS:
        return readings.run, "runs"
    return folds(readings.sun), "blocks of poses"


def compare(
    readings: Readings,
    geometry: SensorGeometry,
    models: Mapping[str, Scored],
    tick: Callable[[str], None] = lambda _: None,
) -> list[Candidate]:
    """Return every model's errors on samples left out, the smallest first, refused ones last.

    Settings of a model (orders, smoothing) are chosen inside each fit, from its samples alone.
    """
    used = readings.thinned(MOST_COMPARED)
    fold, _ = fold_of(used)
    judged = _inside(used, fold)
    found = []
    for name, scored in models.items():
        tick(name)
        found.append(judged_on_folds(name, scored, used, geometry, fold, judged))
    return sorted(found, key=lambda one: (bool(one.refused), one.rms_deg + _unanswered(one)))


def choose(candidates: Sequence[Candidate]) -> tuple[Candidate, str]:
    """Return the simplest candidate within one standard error of the best, and why.

    UnusableDataError if no model could be fitted: what they said.
    """
    usable = [one for one in candidates if not one.refused]
    if not usable:
        raise UnusableDataError(f"no model can be calibrated on these readings: {_why(candidates)}")
    answering = [one for one in usable if one.missing <= min(o.missing for o in usable) + 0.02]
    answering = [one for one in answering if one.moved_deg <= one.rms_deg] or answering
    best = min(answering, key=lambda one: one.rms_deg)
    limit = best.rms_deg + best.spread_deg
    near = [one for one in answering if one.rms_deg <= max(limit, best.rms_deg * 1.001)]
    simplest = min(near, key=lambda one: (_flexibility(one.name), one.rms_deg))
    if simplest is best:
        return best, f"smallest error on {_left_out(best)} samples left out"
    return simplest, (
        f"simplest within one standard error ({best.spread_deg:.2g} deg) of the best, "
        f"{best.name} ({best.rms_deg:.4g} deg)"
    )


def _why(refused: Sequence[Candidate]) -> str:
    """Return why no model can be fitted, in a sentence: one that suits the sensor says so first."""
    said = list(dict.fromkeys(one.refused for one in refused))
    apart = [one for one in said if _APART in one]
    if apart:  # in our own words where there are some: those of models are longer
        short = (one for one in apart if one.startswith("errs "))
        return next(short, f"readings and directions {_APART}: chance explains them as well")
    more = f"; and {len(said) - 2} more" if len(said) > 2 else ""
    return "; ".join(said[:2]) + more or "no model applies"


def explained(candidate: Candidate, readings: Readings) -> Candidate:
    """Refuse a candidate that explains no more of where the light was than chance does."""
    middle = readings.sun.mean(axis=0)
    spread = float(np.degrees(np.sqrt(np.mean(((readings.sun - middle) ** 2).sum(axis=1)))))
    if candidate.refused or candidate.rms_deg <= _CHANCE * spread:
        return candidate
    return Candidate(
        candidate.name,
        refused=f"errs {candidate.rms_deg:.3g} deg where directions spread over {spread:.3g} deg: "
        "readings and directions do not belong together",
    )


def fitted(scored: Scored, readings: Readings, geometry: SensorGeometry) -> Model:
    """Return the model fitted to all samples; UnusableDataError where they do not settle it."""
    made = scored.for_sensor(geometry, readings.kind)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return made.fit(readings.features, readings.sun, readings.context)


@dataclass(frozen=True)
class Settled:
    """A model whose settings are those that another fit chose: orders are not chosen again."""

    scored: Scored
    settings: Mapping[str, Any]

    @property
    def about(self) -> Any:
        """Of the model."""
        return self.scored.about

    def for_sensor(self, geometry: SensorGeometry, kind: FeatureKind) -> Any:
        """Return it unfitted, with the settings."""
        made = self.scored.for_sensor(geometry, kind)
        last = getattr(made, "model", made)
        for name, value in self.settings.items():
            if getattr(last, name, value) is None:
                setattr(last, name, value)
        return made


def settled(scored: Scored, model: Model) -> Any:
    """Return a model with the settings that a fit of it chose."""
    last = getattr(model, "model", model)
    return Settled(scored, dict(last.settings())) if hasattr(last, "settings") else scored


def unbounded(model: Any) -> Any:
    """Return a copy of a fitted chain that answers beyond its hull."""
    if hasattr(model, "compensations"):
        return replace(
            model,
            compensations=tuple(unbounded(stage) for stage in model.compensations),
            model=unbounded(model.model),
        )
    copied = object.__new__(type(model))
    vars(copied).update(vars(model))
    if "hull_" in vars(copied):
        vars(copied)["hull_"] = Hull(np.empty((0, 3)))
    return copied


def numbers_in(model: Any) -> int:
    """Count the parameters that a fit names; 0 of tables and networks."""
    stages = [*getattr(model, "compensations", ()), getattr(model, "model", model)]
    return sum(len(stage.quality_.parameters) for stage in stages if hasattr(stage, "quality_"))


def deviation_of(model: Model, features: Floats, context: Mapping[str, Floats]) -> Floats:
    """Return the 1-sigma (N,) that a fitted chain states, degrees; ones where it states none."""
    stages = getattr(model, "compensations", ())
    for stage in stages:
        features = stage.transform(features, context)
    last = getattr(model, "model", model)
    if not hasattr(last, "deviation_deg"):
        return np.ones(len(features))
    return np.asarray(last.deviation_deg(features, context))


def _inside(used: Readings, fold: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which samples (N,) are left out once, and then lie inside the readings that are kept.

    All models are judged by the same samples: one that answers beyond its hull gains nothing.
    """
    judged = fold >= 0
    if used.features.shape[1] != 2:
        return judged
    for number in np.unique(fold[judged]):
        out = fold == number
        try:
            hull = Hull.around(used.features[~out], "comparison")
        except UnusableDataError:
            continue
        judged[out] = hull.outside(used.features[out]) <= 0.0
    return judged


def judged_on_folds(  # noqa: PLR0917 - what a comparison shares
    name: str,
    scored: Scored,
    used: Readings,
    geometry: SensorGeometry,
    fold: NDArray[np.int64],
    judged: NDArray[np.bool_],
) -> Candidate:
    """Return a model's errors on each fold's samples, of which some are judged, by the others."""
    predicted = np.full((len(used), 3), np.nan)
    deviation = np.full(len(used), np.nan)
    seconds, rms = [], []
    try:
        for number in range(int(fold.max()) + 1):
            out = fold == number
            if not out.any():
                continue
            start = time.perf_counter()
            model = fitted(scored, used.only(~out), geometry)
            seconds.append(time.perf_counter() - start)
            test = used.only(out)
            predicted[out] = model.predict(test.features, test.context)
            deviation[out] = deviation_of(model, test.features, test.context)
            error = separation_deg(predicted[out], test.sun)[judged[out]]
            rms.append(float(np.sqrt(np.nanmean(error**2))) if np.isfinite(error).any() else np.nan)
        whole = fitted(scored, used, geometry)
    except (UnusableDataError, UnsuitableDesignError, ValueError) as error:
        return Candidate(name, refused=str(error))
    errors = separation_deg(predicted, used.sun)
    answered = np.isfinite(errors) & judged
    if not answered.any():
        return Candidate(name, refused="no sample left out was answered")
    folds_ = np.array([value for value in rms if np.isfinite(value)])
    spread = float(np.std(folds_, ddof=1) / np.sqrt(len(folds_))) if len(folds_) > 1 else 0.0
    return Candidate(
        name,
        float(np.sqrt(np.mean(errors[answered] ** 2))),
        spread,
        float(folds_.max()),
        1.0 - float(answered.sum() / judged.sum()),
        numbers_in(whole),
        float(np.median(seconds)),
        "",
        np.where(judged, errors, np.nan),
        predicted - used.sun,
        deviation,
        _moved_deg(whole, used),
    )


def _moved_deg(model: Model, used: Readings) -> float:
    """Return the RMS, degrees, of what answers move by with less light; 0 of what measures none."""
    if used.kind is not FeatureKind.SIGNALS:
        return 0.0
    less = (model.predict(light * used.features, used.context) for light in (1.0, 1.0 - LESS_LIGHT))
    moved = separation_deg(*less)
    known = np.isfinite(moved)
    return float(np.sqrt(np.mean(moved[known] ** 2))) if known.any() else 0.0


def _unanswered(one: Candidate) -> float:
    return 0.0 if one.missing <= 0.05 else 1000.0 * one.missing


def _flexibility(name: str) -> int:
    last = name.rsplit(" + ", maxsplit=1)[-1]
    return _FLEXIBILITY.index(last) if last in _FLEXIBILITY else len(_FLEXIBILITY)


def _left_out(one: Candidate) -> int:
    return 0 if one.errors is None else int(np.isfinite(one.errors).sum())
