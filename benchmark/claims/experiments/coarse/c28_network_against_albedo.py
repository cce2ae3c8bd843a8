"""C28: a network trained on voltages in orbit, no albedo model (Soken2023).

Four photodiodes on orbits that no method was calibrated on, a week after the day of training:
`dnn` from another seed in every trial, `assembled-faces` that knows of no Earth, and the same with
the Earth's light taken off as the simulator's own albedo model has it, which is as good as such a
model can be. The data set has four faces, and the summation of Sun and Earth needs a cube's six.
"""

from __future__ import annotations

from functools import cache

from benchmark.assessment.networks import (
    Method,
    by_albedo_model,
    network_directions,
    parts,
    uncorrected_directions,
)
from benchmark.claims.benches import ratio, rms, separation
from benchmark.claims.experiment import Trial
from benchmark.datasets.standard import pd_albedo_orbit

PRESET = pd_albedo_orbit.PRESET


def trial(number: int) -> Trial:
    """Measure one seed of the network."""
    errors = {
        "uncorrected": _fix("uncorrected"),
        "albedo model": _fix("albedo model"),
        "dnn": _error(network_directions(number)),
    }
    values = {
        "corrects": ratio(errors["uncorrected"], errors["dnn"]),
        "model": ratio(errors["dnn"], errors["albedo model"]),
    }
    return Trial(values, {"rms error": (tuple(errors), list(errors.values()))})


@cache
def _fix(name: str) -> float:
    """Error of a method that has no seed."""
    return _error({"uncorrected": uncorrected_directions, "albedo model": by_albedo_model}[name])


def _error(method: Method) -> float:
    known, asked = parts(PRESET, "nominal")
    return rms(separation(method(PRESET.geometry, known, asked), asked.sun), asked.lit)
