"""What stands on a board beside methods: two controls, and what a bench adds to every error."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.datasets.benches import aligned_bench_deg
from benchmark.metrics.separation import separation_deg, store
from benchmark.seeds import generator
from benchmark.simulator.light.sun_disc import tangent_axes

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.metrics.bounds import Bound

BORESIGHT = (0.0, 0.0, 1.0)

#: What alignment leaves of a bench that errs by one rotation alone is the rounding of the fit.
_ROTATION_ROUNDING_DEG = 1e-9


def board_facts(
    preset: Preset, condition: str, sun: Floats, bound: Bound
) -> dict[str, float | None]:
    """Return the numbers of a test split that a board states once, by their names in a pin.

    Returns
    -------
    dict
        ``bound_unit_deg`` (root mean square of the bound with the unit unknown), ``bench_deg`` and
        ``bench_aligned_deg`` (fixed error of the calibration's bench, and what alignment leaves of
        it), ``boresight_deg`` (error of always answering boresight) and ``oracle_deg`` (error of
        the truth with Gaussian noise of the bound); None where there is none. All over observable
        samples.
    """
    seen = np.asarray(bound.observable, dtype=np.bool_)
    unit = bound.unit_angle_deg
    aligned = aligned_bench_deg(preset, condition, sun)
    return {
        "bound_unit_deg": None if unit is None else _rms(np.asarray(unit)[seen]),
        "bench_deg": store(preset.reference_error_deg(condition)),
        "bench_aligned_deg": store(aligned if aligned > _ROTATION_ROUNDING_DEG else 0.0),
        "boresight_deg": _rms(separation_deg(np.tile(BORESIGHT, (len(sun), 1)), sun)[seen]),
        "oracle_deg": _rms(_find(separation_deg(oracle(preset, condition, sun, bound), sun))),
    }


def oracle(preset: Preset, condition: str, sun: Floats, bound: Bound) -> Floats:
    """Return the truth (N, 3) moved by Gaussian noise as large as the bound; NaN without one."""
    noise = generator(preset.name, preset.version, condition, "oracle").standard_normal(
        (len(sun), 2)
    )
    known = np.asarray(bound.observable, dtype=np.bool_) & np.isfinite(bound.angle_deg)
    size = np.radians(np.where(known, bound.angle_deg, np.nan)) / math.sqrt(2.0)
    first, second = tangent_axes(sun)
    moved = sun + size[:, None] * (noise[:, :1] * first + noise[:, 1:] * second)
    return cast("Floats", moved / np.linalg.norm(moved, axis=1, keepdims=True))


def _find(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return values[np.isfinite(values)]


def _rms(values: NDArray[np.float64]) -> float | None:
    return store(math.sqrt(float(np.mean(values**2)))) if len(values) else None
