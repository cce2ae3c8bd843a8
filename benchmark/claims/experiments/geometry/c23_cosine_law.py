"""C23: incidence from one photodiode's signal, by the cosine law and by Kelly's (Yousefian2017).

One photodiode of the cube, of Kelly's response, is turned from 0 to 85 deg off the Sun, whose
strength is known (the law's alpha_s). Its reading at normal incidence, the mean of 25, is the unit
of signal. Each law turns every reading into an angle. The second method needs no sensor: the angle
by the cosine law of a noiseless Kelly signal, over incidences spaced evenly.
"""

from __future__ import annotations

import numpy as np

from algorithms.compensations.electronics.angular_loss import KELLY
from algorithms.contract import Floats
from benchmark.claims.benches import middles, ratio, rms, rms_within
from benchmark.claims.experiment import Trial
from benchmark.datasets.standard import pd_maskless_cube
from benchmark.seeds import generator
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene

EDGES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0)
#: Number of the face towards +z.
_FACE = 4
_SAMPLES, _NORMAL = 4000, 25
_UNIT = np.array(KELLY) / sum(KELLY)


def trial(number: int) -> Trial:
    """Measure one photodiode of its own gain and noise."""
    from algorithms.models.physics_informed.faces_kernel import invert  # noqa: PLC0415 - Numba

    setup = pd_maskless_cube.PRESET.condition("nominal")
    rng = generator("claims", "C23", number, "incidence")
    incidence = EDGES_DEG[-1] * rng.random(_SAMPLES)
    incidence[:_NORMAL] = 0.0
    turn = 2.0 * np.pi * rng.random(_SAMPLES)
    across = np.sin(np.radians(incidence))
    sun = np.column_stack(
        [across * np.cos(turn), across * np.sin(turn), np.cos(np.radians(incidence))]
    )
    _, stray = setup.irradiance.draw(_SAMPLES, generator("claims", "C23", number, "light"))
    pattern = setup.sensor.fixed_pattern("claims", "C23", number)
    streams = NoiseStreams.named("claims", "C23", number)
    readings = setup.sensor.observe(Scene(sun, np.ones(_SAMPLES), stray), pattern, streams)
    signal = readings[_NORMAL:, _FACE] / readings[:_NORMAL, _FACE].mean()
    seen = incidence[_NORMAL:]
    cosine = np.degrees(np.arccos(np.clip(signal, 0.0, 1.0))) - seen
    kelly = np.degrees(np.arccos(np.clip(invert(signal, _UNIT), 0.0, 1.0))) - seen
    lines = {
        name: (middles(EDGES_DEG), rms_within(off, seen, EDGES_DEG))
        for name, off in (("cosine law", cosine), ("Kelly cosine", kelly))
    }
    oblique = seen >= 50.0
    values = {**_by_band(cosine, seen), "kelly": ratio(rms(cosine, oblique), rms(kelly, oblique))}
    return Trial(values, lines, _closed_form())


def _by_band(off: Floats, incidence: Floats) -> dict[str, float]:
    def band(low: float, high: float) -> float:
        return rms(off, (low <= incidence) & (incidence < high))

    return {
        "strongly": ratio(band(50.0, 80.0), band(0.0, 50.0)),
        "fails": ratio(band(80.0, 85.0), band(50.0, 60.0)),
    }


def _closed_form() -> dict[str, float]:
    incidence = np.arange(0.005, 85.0, 0.01)
    signal = np.polyval(_UNIT[::-1], np.cos(np.radians(incidence)))
    return _by_band(np.degrees(np.arccos(np.minimum(signal, 1.0))) - incidence, incidence)
