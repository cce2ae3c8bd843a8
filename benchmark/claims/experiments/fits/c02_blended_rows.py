"""C02: polynomials blended between rows of a table beside the plain table (He2013).

`cmos-n-slit` is the study's sensor: a CMOS array behind an N of slits, a field of +-64 degrees,
refraction in the glass. It is calibrated at every whole degree, as the study's table is, and given
the true directions, so that a node of the table is a pose, or nearly. The plain table is `lut`,
which interpolates between the four nodes around; the other is `lut-polynomial` with the study's
8th degree. Both choose their smoothing by the same calibration samples, as they ship. A third line
shows the table without smoothing: every node as it was measured.
"""

from __future__ import annotations

from dataclasses import replace

from algorithms.extractors.profiles.centroid import ProfileThresholdedCentroid
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.lookup_table import ErrorTable
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Line, Trial
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.standard import cmos_n_slit

DEGREE = 8
#: Weight of roughness that only fills nodes without samples.
NO_SMOOTHING = 1e-3
EDGES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 72.0)
#: Poses at whole degrees over the field.
PRESET = replace(
    with_true_directions(cmos_n_slit.PRESET),
    directions=AngleField(64.0, steps=129, test_samples=2000),
)


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen, extractor = ConditionView(PRESET, unit=number), ProfileThresholdedCentroid
    kind = extractor.about.kind
    table = ErrorTable.for_sensor(seen.preset.geometry, kind)
    rows = BlendedPolynomials.for_sensor(seen.preset.geometry, kind)
    found = {
        "plain table (lut)": seen.errors(extractor, table),
        "blended polynomials (lut-polynomial)": seen.errors(
            extractor, replace(rows, degree=DEGREE)
        ),
        "plain table, not smoothed": seen.errors(extractor, replace(table, smoothing=NO_SMOOTHING)),
    }
    places = seen.incidence_deg()
    lines: dict[str, Line] = {
        name: (middles(EDGES_DEG), rms_within(errors, places, EDGES_DEG))
        for name, errors in found.items()
    }
    plain, blended, _ = map(rms, found.values())
    return Trial({"refines": ratio(plain, blended)}, lines)
