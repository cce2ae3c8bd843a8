"""C27: three ways to correct albedo on a cube, by how many faces Sun and Earth share (Frezza2022).

The photodiode cube in orbit. Maximum currents, Sun+Earth summation and the identification of Sun
and albedo inputs (SAIE) stand behind the same compensation of the faces' angular response, and
before the model that each ships with. A sample's problem type is the number of faces that truly get
both sunlight and more than 2 % of a Sun from the Earth, by the simulator's own light; types 0 to 2
are the solvable ones. SAIE takes the Sun's strength for known: for all three, signals are first
divided by the sunlight of the season, which any almanac tells. Errors are over samples that all
three answer: SAIE gives up the others.
"""

from __future__ import annotations

import numpy as np

from algorithms.chain import Chain
from algorithms.compensations.electronics.angular_loss import AngularLoss
from algorithms.compensations.interference.maximum_currents import MaximumCurrents
from algorithms.compensations.interference.sun_and_albedo_inputs import SunAndAlbedoInputs
from algorithms.compensations.interference.sun_and_earth import SunAndEarth
from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.multisensor_fusion import SixFaces
from algorithms.models.geometric.solar_panel import SolarPanels
from benchmark.claims.benches import ConditionView, ratio, rms, separation
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
    seen = ConditionView(pd_orbit.PRESET, "nominal", number)
    errors = {name: _errors(seen, method) for name, method in METHODS.items()}
    types = _problem_types(seen)
    answered = np.isfinite(list(errors.values())).all(axis=0)
    solvable = answered & (types < 3)
    values = {
        rule: ratio(rms(errors[name], solvable), rms(errors["SAIE"], solvable))
        for rule, name in (("maximum", "maximum currents"), ("summation", "Sun+Earth summation"))
    }
    lines = {
        name: (("0", "1", "2", "3"), [rms(found, answered & (types == k)) for k in range(4)])
        for name, found in errors.items()
    }
    return Trial(values, lines)


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
    scene = pd_orbit.PRESET.for_unit(seen.unit).scene("nominal", "test")
    normals = np.asarray(preset.geometry.face_normals)
    earth = np.asarray(scene.albedo) / np.maximum(scene.irradiance, 1e-12)[:, None]
    shared = (scene.sun @ normals.T > _DARK) & (earth > _DARK)
    return np.where(scene.irradiance > 0, shared.sum(axis=1), np.nan)
