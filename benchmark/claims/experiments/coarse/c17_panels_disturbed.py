"""C17: degradation, interference and albedo on body-mounted solar panels (Nurgizat2021).

`solar-panel` is calibrated once on new panels in clean light, and then tested on the same Suns
with one thing changed: panels that lost 20 % of their current with 5 % from panel to panel, stray
light of 5 % of sunlight (1 % from sample to sample), and the sunlit Earth in view.
"""

from __future__ import annotations

from dataclasses import replace

from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.solar_panel import SolarPanels
from benchmark.claims.benches import ConditionView, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.datasets.standard import pva_maskless_panels
from benchmark.simulator.light.environment import Irradiance

NOMINAL = pva_maskless_panels.PRESET.condition("nominal")
STRAY = replace(NOMINAL, irradiance=Irradiance(stray=0.05, stray_spread=0.01))
PRESET = replace(
    pva_maskless_panels.PRESET,
    setups={**pva_maskless_panels.PRESET.setups, "stray-light": STRAY},
)
DISTURBANCES = {"degradation": "aged", "interference": "stray-light", "albedo": "albedo"}


def trial(number: int) -> Trial:
    """Measure one unit."""
    new = ConditionView(PRESET, "nominal", number)
    calibrated = new.calibrate(DirectSignals, SolarPanels)
    clean = rms(new.errors_of(calibrated, DirectSignals))
    disturbed = {
        name: rms(ConditionView(PRESET, condition, number).errors_of(calibrated, DirectSignals))
        for name, condition in DISTURBANCES.items()
    }
    values = {name: ratio(error, clean) for name, error in disturbed.items()}
    line = (("none", *disturbed), [clean, *disturbed.values()])
    return Trial(values, {"solar-panel": line})
