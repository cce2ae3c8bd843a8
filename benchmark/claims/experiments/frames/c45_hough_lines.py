"""C45: the blooming line found by votes, in noise and with pixels missing (Liu2016).

The camera of `ccd-lens`, whose saturated Sun spills charge along its columns, looks at Suns
anywhere in the image but for a rim of 40 px. `hough-lines` finds the line and the Sun on it. Truth
is the place on the detector where the Sun's centre falls, so that no calibration enters. Missing
pixels read the converter's pedestal; noise is added as shares of its range. The plot has the
thresholded centroid beside it, which takes the line for a part of the Sun.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.frames.cameras.hough import HoughLines
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import error_px
from benchmark.datasets.standard.ccd_lens import PRESET
from benchmark.seeds import generator
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.blooming import BloomingSensor

SKETCH = Sketch()

MISSING = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4)
NOISES = (0.01, 0.02, 0.05, 0.1)
_FRAMES, _RIM_PX, _STRAY = 100, 40.0, 0.02


def trial(number: int) -> Trial:
    """Measure one draw of Suns, fixed pattern, noise and missing pixels."""
    sensor = PRESET.condition("nominal").sensor
    if not isinstance(sensor, BloomingSensor):
        raise TypeError(f"{PRESET.name} has no blooming lines; got {type(sensor).__name__}")
    pixels = sensor.camera.detector
    rng = generator("claims", "C45", number)
    places = rng.uniform(_RIM_PX, pixels.columns - 1.0 - _RIM_PX, (_FRAMES, 2))
    scene = Scene(sensor.camera.sun_of(places), np.ones(_FRAMES), np.full(_FRAMES, _STRAY))
    streams = NoiseStreams(
        *(generator("claims", "C45", number, name) for name in ("noise", "counts"))
    )
    seen = sensor.observe(scene, sensor.fixed_pattern("claims", "C45", number), streams)
    light, full = np.asarray(seen, dtype=np.float64), float(2**pixels.bits - 1)
    noise, lot = rng.standard_normal(light.shape), rng.random(light.shape)

    def frames(share: float, missing: float) -> Floats:
        loud = np.clip(light + share * full * noise, 0.0, full)
        return np.where(lot < missing, pixels.offset_dn, loud)

    methods = [m.for_sensor(PRESET.geometry) for m in (HoughLines, ThresholdedCentroid)]
    gaps = [[m.extract(frames(0.0, missing)) for missing in MISSING] for m in methods]
    loud = [[m.extract(frames(share, 0.0)) for share in NOISES] for m in methods]
    (voted, _), (voted_loud, _) = (
        [[error_px(one, places) for one in along] for along in kind] for kind in (gaps, loud)
    )
    at = MISSING.index(0.2)
    return Trial(
        {
            "gaps": ratio(voted[at], voted[0]),
            "noise": ratio(voted_loud[-1], voted_loud[0]),
            "found": 1.0 - float(np.isnan(gaps[0][at]).any(axis=1).mean()),
        },
        {
            f"{name}{what}": (across, [error_px(one, places) for one in along])
            for what, across, kind in (
                ("", MISSING, gaps),
                (", no gaps, noise across", NOISES, loud),
            )
            for name, along in zip(("hough-lines", "bctm"), kind, strict=True)
        },
    )
