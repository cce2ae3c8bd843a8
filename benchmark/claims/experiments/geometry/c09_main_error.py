"""C09: what errors of the standard projection model come from (deBoer2013).

A digital sensor behind one round hole, as the study's: `cmos-single-aperture` has the pixels of the
TNO miniDSS (deBoer2013). Of every unit the squared error that its misalignment adds (tilts,
rotation, offsets of the mask) is set beside what its focal length adds and beside all that is left
without either. On the same unit without misalignment, which would hide it, a table fitted to the
model's errors says whether one is needed, and 80 deg C whether temperature has to be compensated:
dark current, and a spacer of aluminium that lengthens. The model is the drawing's and needs no
calibration; the table is given true directions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, replace
from functools import partial

from algorithms.contract import FeatureKind
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.models.lut.lookup_table import ErrorTable
from benchmark.claims.benches import ConditionView, ratio, rms, separation
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.alterations import assemble, misalign
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import cmos_single_aperture
from benchmark.simulator.optics.assembly import Assembly

PARTS = ("misalignment", "focal length", "neither", "table", "80 deg C", "and aluminium")
#: Of aluminium, over the 60 K from room temperature to the condition ``hot``.
_LENGTHENS = 60.0 * 23.1e-6


@dataclass(frozen=True)
class _Parts:
    """RMS errors in degrees of one unit: with one error of assembly alone, and with none.

    Of the unit without any: by the model, by a table on top of it, at 80 deg C, and there on a
    spacer of aluminium.
    """

    misalignment: float
    focal_length: float
    neither: float
    table: float
    dark: float
    expansion: float


def trial(number: int) -> Trial:
    """Measure one unit."""
    parts = _parts(with_true_directions(cmos_single_aperture.PRESET), number)
    return Trial(statistics(parts), {"spm": (PARTS, list(astuple(parts)))})


def statistics(parts: _Parts) -> Mapping[str, float]:
    """Give the rules' statistics."""
    rest = parts.neither**2
    off, long = (max(one**2 - rest, 0.0) for one in (parts.misalignment, parts.focal_length))
    return {
        "main": math.sqrt(ratio(off, max(long, rest))),
        "table": ratio(parts.neither, parts.table),
        "dark": ratio(parts.dark, parts.neither),
        "expansion": ratio(parts.expansion, parts.neither),
    }


def _parts(preset: Preset, unit: int) -> _Parts:
    seen = _seen(preset, unit, _align)
    return _Parts(
        misalignment=_drawing(_seen(preset, unit, _as_long_as_drawn)),
        focal_length=_drawing(_seen(preset, unit, partial(misalign, times=0.0))),
        neither=_drawing(seen),
        table=rms(seen.errors(ThresholdedCentroid, ErrorTable)),
        dark=_drawing(_seen(preset, unit, _align, "hot")),
        expansion=_drawing(_seen(preset, unit, partial(_longer, preset), "hot")),
    )


def _seen(
    preset: Preset,
    unit: int,
    change: Callable[[Assembly], Assembly],
    condition: str = "nominal",
) -> ConditionView:
    """Return the unit with other errors of assembly than it was built with."""
    return ConditionView(assemble(preset.for_unit(unit), change, condition), condition)


def _as_long_as_drawn(assembly: Assembly) -> Assembly:
    return replace(assembly, focal_length_error_mm=0.0)


def _align(assembly: Assembly) -> Assembly:
    return _as_long_as_drawn(misalign(assembly, times=0.0))


def _longer(preset: Preset, assembly: Assembly) -> Assembly:
    longer_mm = _LENGTHENS * (preset.geometry.focal_length_mm or math.nan)
    return replace(_align(assembly), focal_length_error_mm=longer_mm)


def _drawing(seen: ConditionView) -> float:
    """RMS error of the model by the drawing, which learns nothing from what it is fitted to."""
    tested, found = seen.samples("test"), seen.features(ThresholdedCentroid, "test")
    geometry = seen.preset.geometry_for(seen.condition)
    model = StandardProjection.for_sensor(geometry, FeatureKind.SPOT).fit(found, tested.sun)
    return rms(separation(model.predict(found), tested.sun))
