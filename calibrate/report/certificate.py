"""A calibration as a digital calibration certificate (DCC), the metrologists' XML."""

from __future__ import annotations

import datetime as dt
import re
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from calibrate.calibration import Calibration
from calibrate.documents import versions
from calibrate.report.page import COVERAGE_FACTOR, templates
from calibrate.settings import NO_COUNTRY, UNSTATED

#: Version of the schema (https://ptb.de/dcc/v3.1.2/dcc.xsd, with D-SI 2.1) that is written.
SCHEMA_VERSION = "3.1.2"
#: Units of parameters as D-SI has them; it has no pixel.
UNITS = {
    "": r"\one",
    "px": r"\one",
    "deg": r"\degree",
    "mm": r"\milli\metre",
    "1/rad": r"\radian\tothe{-1}",
    "1/rad^2": r"\radian\tothe{-2}",
}
_DEGREE = UNITS["deg"]
#: Edges of the rings that errors are told in, degrees from the boresight.
_RINGS_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 90.0, 180.0)
_FEWEST_IN_RING = 10
_UNSIGNED = (
    "Made by software from the data named above and not signed. Traceability and accreditation are "
    "those of whoever issues it."
)
#: Characters that XML 1.0 has no place for.
_UNWRITABLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class _Quantity(NamedTuple):
    """A number with its unit in D-SI and its 1-sigma, if known, or a list of numbers."""

    name: str
    value: float | list[float]
    unit: str = _DEGREE
    deviation: float | None = None


class _Result(NamedTuple):
    """Quantities, single or in columns of one length, under a name."""

    name: str
    description: str
    quantities: list[_Quantity]
    columns: list[_Quantity] = []  # noqa: RUF012 - never changed


def certificate(found: Calibration, command: str = "") -> str:
    """Return a calibration as a digital calibration certificate of PTB's schema, version 3.1.2.

    `command` was called. Who calibrated what for whom is taken from the settings' section
    ``certificate``; what is not stated there is written as such, and countries as ZZ. Uncertainties
    have the coverage factor 2.
    """
    stated = found.settings.certificate
    today = dt.datetime.now(dt.UTC).date()
    text = (
        templates()
        .get_template("certificate.xml")
        .render(
            found=found,
            stated=stated,
            command=command,
            schema=SCHEMA_VERSION,
            versions=versions(),
            begin=stated.begin or stated.end or today,
            end=stated.end or stated.begin or today,
            unstated=UNSTATED,
            no_country=NO_COUNTRY,
            statements=_statements(found),
            results=[_errors(found), *_rings(found), *_parameters(found)],
            factor=COVERAGE_FACTOR,
        )
    )
    return _UNWRITABLE.sub("?", text.lstrip())


def _statements(found: Calibration) -> list[str]:
    return [
        f"Verdict: {found.verdict.word}. {found.verdict.reason}.",
        _UNSIGNED,
        *(one.found + ("" if one in found.applied else " (not applied)") for one in found.findings),
    ]


def _errors(found: Calibration) -> _Result:
    chosen = found.chosen
    quantities = [
        _Quantity(
            "RMS error of samples left out of the fit",
            float(chosen.rms_deg),
            deviation=float(chosen.spread_deg),
        ),
        _Quantity("RMS residual of samples fitted", float(found.residual_deg)),
    ]
    if np.isfinite(found.noise_deg):
        quantities.append(_Quantity("RMS noise of single samples", float(found.noise_deg)))
    floor = float(found.settings.bench.floor_deg)
    quantities += [
        _Quantity("RMS error of the bench's directions, as stated", floor),
        _Quantity("samples fitted", float(len(found.readings)), UNITS[""]),
        _Quantity("samples left out as wrong", float(len(found.excluded)), UNITS[""]),
    ]
    description = "RMS angles, of all samples that were fitted"
    return _Result("Errors of directions", description, quantities)


def _rings(found: Calibration) -> list[_Result]:
    """Return the errors of samples left out by their angle from the boresight."""
    errors = np.asarray(found.chosen.errors)
    readings = found.readings.thinned(len(errors))
    off = np.degrees(np.arccos(np.clip(readings.sun[:, 2], -1.0, 1.0)))
    sigma = found.deviation_deg(readings.features, dict(readings.context))
    known = np.isfinite(errors) & np.isfinite(sigma)
    edges, rms, stated = [], [], []
    for low, high in pairwise(_RINGS_DEG):
        ring = known & (low <= off) & (off < high)
        if ring.sum() >= _FEWEST_IN_RING:
            edges.append(high)
            rms.append(float(np.sqrt(np.mean(errors[ring] ** 2))))
            stated.append(COVERAGE_FACTOR * float(np.sqrt(np.mean(sigma[ring] ** 2))))
    if not edges:
        return []
    columns = [
        _Quantity("outer edge of the ring", edges),
        _Quantity("RMS error", rms),
        _Quantity("expanded uncertainty of a direction, k = 2", stated),
    ]
    description = (
        "of samples left out, in rings; expanded uncertainty of a direction along a tangent axis"
    )
    return [_Result("Errors by angle from the boresight", description, [], columns)]


def _parameters(found: Calibration) -> list[_Result]:
    last = getattr(found.model, "model", found.model)
    stages: tuple[Any, ...] = (*getattr(found.model, "compensations", ()), last)
    quantities = [
        _Quantity(
            one.name if one.unit in {"", "deg", "mm"} else f"{one.name} in {one.unit}",
            float(one.value),
            UNITS.get(one.unit, UNITS[""]),
            None if one.deviation is None or not np.isfinite(one.deviation) else one.deviation,
        )
        for stage in stages
        if hasattr(stage, "quality_")
        for one in stage.quality_.parameters
        if np.isfinite(one.value)
    ]
    if not quantities:
        return []
    return [_Result("Parameters of the model", f"of {found.chosen.name}", quantities)]
