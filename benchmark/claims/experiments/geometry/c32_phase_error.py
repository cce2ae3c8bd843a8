"""C32: what compensating a code dial's fine phase and its structure removes (Fan2013).

The dials' reading by the drawing is compared with `periodic`, the study's model, which takes the
fine code's phase error out by one harmonic, and the structure. Of an angle's error the part at the
fine period is what four harmonics of the fine phase hold of it, as tangents, beside a cubic of both
tangents for what is slow. The plot, and no statistic, shows `fourier-phase` beside it, a series.
"""

from __future__ import annotations

import numpy as np

from algorithms.angles import angles_from_sun
from algorithms.contract import Floats
from algorithms.extractors.currents.dial_tracks import DialTracks
from algorithms.models.multiplex.dial_code import DialCode, dial_code, sun_from_fractions
from algorithms.models.multiplex.periodic import PeriodicCode
from algorithms.models.non_physical.fourier_phase import FourierPhase
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within, separation
from benchmark.claims.experiment import Trial
from benchmark.datasets.standard import pd_code_dial

#: Of the fine phase, turns.
EDGES = tuple(np.linspace(-0.5, 0.5, 13).tolist())
HARMONICS = 4


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(pd_code_dial.PRESET, unit=number)
    kind, sun = DialTracks.about.kind, seen.samples("test").sun
    signals = seen.features(DialTracks, "test")
    about = PeriodicCode.about
    design = dial_code(seen.preset.geometry, kind, about)
    contrast = PeriodicCode.for_sensor(seen.preset.geometry, kind).smallest_contrast
    places, phases = DialCode(**design, smallest_contrast=contrast).read(signals)
    said = {"drawing": sun_from_fractions(places, np.ones_like(places))}
    for model in (PeriodicCode, FourierPhase):
        fitted = seen.calibrate(DialTracks, model)
        said[model.about.name] = fitted.predict_features(signals, None)
    errors = {name: rms(separation(one, sun)) for name, one in said.items()}
    off = {
        name: (angles_from_sun(one) - angles_from_sun(sun))[:, ::-1] for name, one in said.items()
    }
    fine = {name: _fine_error(one, phases, sun) for name, one in off.items()}
    values = {
        "most": ratio(fine["periodic"], fine["drawing"]),
        "whole": ratio(errors["drawing"], errors["periodic"]),
    }
    turns = phases.ravel() / (2.0 * np.pi)
    lines = {
        name: (middles(EDGES), rms_within(one.ravel(), turns, EDGES)) for name, one in off.items()
    }
    return Trial(values, lines)


def _fine_error(off: Floats, phases: Floats, sun: Floats) -> float:
    """Mean square (deg^2) of the part of errors (N, 2) that goes with the fine phases (N, 2)."""
    tangents = sun[:, :2] / sun[:, 2:]
    x, y = tangents.T
    slow = [x**i * y**j for i in range(4) for j in range(4 - i)]
    parts = []
    for axis in range(2):
        good = np.isfinite(off[:, axis]) & np.isfinite(phases[:, axis])
        turns = [n * phases[:, axis] for n in range(1, HARMONICS + 1)]
        flatter = 1.0 / (1.0 + tangents[:, axis] ** 2)  # of an angle on its tangent
        fine = [flatter * wave(turn) for turn in turns for wave in (np.cos, np.sin)]
        table = np.column_stack([*slow, *fine])[good]
        found = np.linalg.lstsq(table, off[good, axis], rcond=None)[0]
        parts.append(float(np.mean((table[:, len(slow) :] @ found[len(slow) :]) ** 2)))
    return sum(parts) / 2.0
