"""C27: which samples SAIE solves, by how many faces Sun and Earth share (Frezza2022).

The photodiode cube in orbit, without drift, of which the survey does not speak here. A sample's
problem type is the number of faces that truly get both sunlight and more than 2 % of a Sun from the
Earth, by the simulator's own light. The survey states which types have a solution: none or one
shared face by the currents alone, two with a magnetometer, three none; on this orbit there are no
samples of type 3. The rules ask for the share that is answered. The plot shows the error of SAIE
beside those of maximum currents and Sun+Earth summation, all behind the same compensation of the
faces' angular response and before the model that each ships with, over samples that all three
answer; no rule compares them, as the survey does not. SAIE takes the Sun's strength for known:
signals are first divided by the sunlight of the season, which any almanac gives.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Chain
from algorithms.compensations.electronics.angular_loss import AngularLoss
from algorithms.compensations.interference.maximum_currents import MaximumCurrents
from algorithms.compensations.interference.sun_and_albedo_inputs import SunAndAlbedoInputs
from algorithms.compensations.interference.sun_and_earth import SunAndEarth
from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.multisensor_fusion import SixFaces
from algorithms.models.geometric.solar_panel import SolarPanels
from benchmark.claims.benches import ConditionView, rms, separation
from benchmark.claims.experiment import Trial
from benchmark.datasets.standard import pd_orbit

METHODS = {
    "maximum currents": Chain((AngularLoss, MaximumCurrents), SolarPanels),
    "Sun+Earth summation": Chain((AngularLoss, SunAndEarth), SixFaces),
    "SAIE": Chain((AngularLoss, SunAndAlbedoInputs), SixFaces),
}
#: Of a Sun: what SAIE's tolerance takes for dark.
_DARK = 0.02


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(pd_orbit.PRESET, "stable", number)
    errors = {name: _errors(seen, method) for name, method in METHODS.items()}
    types = _problem_types(seen)
    solved = np.isfinite(errors["SAIE"])
    values = {
        "currents": _share(solved, types <= 1),
        "magnetometer": _share(solved, types == 2),
    }
    answered = np.isfinite(list(errors.values())).all(axis=0)
    lines = {
        name: (("0", "1", "2"), [rms(found, answered & (types == k)) for k in range(3)])
        for name, found in errors.items()
    }
    return Trial(values, lines)


def _share(solved: NDArray[np.bool_], among: NDArray[np.bool_]) -> float:
    """Share of the samples among some that is answered; NaN without samples."""
    return float(solved[among].mean()) if among.any() else math.nan


def _errors(seen: ConditionView, method: Chain) -> Floats:
    flight = pd_orbit.PRESET.flight
    season = flight.leg("test").sunlight / flight.leg("calibration").sunlight
    samples = seen.samples("test")
    pipeline = seen.calibrate(DirectSignals, method)
    signals = seen.features(DirectSignals, "test") / season
    return separation(pipeline.predict_features(signals, samples.context), samples.sun)


def _problem_types(seen: ConditionView) -> Floats:
    """Faces (N,) that Sun and Earth share; NaN in eclipse."""
    preset = seen.preset.for_unit(seen.unit)
    scene = pd_orbit.PRESET.for_unit(seen.unit).scene("stable", "test")
    normals = np.asarray(preset.geometry.face_normals)
    earth = np.asarray(scene.albedo) / np.maximum(scene.irradiance, 1e-12)[:, None]
    shared = (scene.sun @ normals.T > _DARK) & (earth > _DARK)
    return np.where(scene.irradiance > 0, shared.sum(axis=1), np.nan)
