"""C44: the black sun's centre in nine regions of the image (Saleem2019).

The nominal camera of `cmos-lens`, with its distortion, looks at Suns whose centres fall anywhere in
the image but for a rim of 20 px, where the black disc or its halo would be cut. Truth is the place
on the detector where the Sun's centre falls, so that no calibration enters. Of errors from so few
frames the largest of nine is by chance 1.3 to 1.5 times the smallest where all are alike.
"""

from __future__ import annotations

import numpy as np

from algorithms.extractors.frames.cameras.black_sun import BlackSunCentroid
from benchmark.claims.benches import middles, ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import error_px
from benchmark.datasets.standard.cmos_lens import PRESET
from benchmark.seeds import generator
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.black_sun import BlackSunSensor

SKETCH = Sketch()

#: Frames of each region.
FRAMES = 16
RIM_PX = 20.0
#: Of the distance from the centre, share of the half image.
EDGES = (0.0, 0.25, 0.5, 0.75, 1.0, 1.2)
_STRAY = 2e-4


def trial(number: int) -> Trial:
    """Measure one draw of places, fixed pattern and noise."""
    sensor = PRESET.condition("nominal").sensor
    if not isinstance(sensor, BlackSunSensor):
        raise TypeError(f"{PRESET.name} has no black Sun; got {type(sensor).__name__}")
    size = sensor.camera.detector.columns
    thirds = np.linspace(RIM_PX, size - 1.0 - RIM_PX, 4)
    rng = generator("claims", "C44", number, "places")
    places = np.concatenate(
        [
            np.column_stack([rng.uniform(thirds[i], thirds[i + 1], FRAMES) for i in (column, row)])
            for row in range(3)
            for column in range(3)
        ]
    )
    scene = Scene(sensor.camera.sun_of(places), np.ones(len(places)), np.full(len(places), _STRAY))
    noise = NoiseStreams(
        *(generator("claims", "C44", number, name) for name in ("noise", "counts"))
    )
    frames = sensor.observe(scene, sensor.fixed_pattern("claims", "C44", number), noise)
    found = BlackSunCentroid.for_sensor(PRESET.geometry).extract(frames)
    regions = (slice(k, k + FRAMES) for k in range(0, len(found), FRAMES))
    each = np.array([error_px(found[region], places[region]) for region in regions])
    worst = float(each.max())
    values = {"sub-pixel": worst, "anywhere": ratio(worst, float(each.min()))}
    half = (size - 1) / 2.0
    away = np.hypot(*(places - half).T) / half
    part = np.digitize(away, EDGES) - 1
    along = [error_px(found[part == k], places[part == k]) for k in range(len(EDGES) - 1)]
    return Trial(values, {"bscm": (middles(EDGES), along)})
