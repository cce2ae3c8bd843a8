"""`certificate`: the results of a calibration as XML, with uncertainties and their origin."""

from __future__ import annotations

import datetime as dt
from itertools import pairwise
from xml.etree.ElementTree import Element, indent, register_namespace, tostring

import numpy as np

from calibrate.calibration import Calibration
from calibrate.certificate.elements import (
    COVERAGE_FACTOR,
    DCC,
    SCHEMA_VERSION,
    SI,
    XSI,
    contact,
    content,
    dcc,
    identification,
    place,
    quantities,
    quantity,
    software,
)
from calibrate.documents import versions
from calibrate.settings import NO_COUNTRY, UNSTATED, CertificateSettings

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


def certificate(found: Calibration, command: str = "") -> str:
    """Return a calibration as a digital calibration certificate of PTB's schema, version 3.1.2.

    Parameters
    ----------
    found : Calibration
    command : str
        What was called.

    Returns
    -------
    str
        XML. Who calibrated what for whom is taken from the settings' section ``certificate``; what
        is not stated there is written as such, and countries as ZZ. Uncertainties have the coverage
        factor 2.
    """
    stated = found.settings.certificate
    for prefix, space in (("dcc", DCC), ("si", SI), ("xsi", XSI)):
        register_namespace(prefix, space)
    root = Element(f"{{{DCC}}}digitalCalibrationCertificate", {"schemaVersion": SCHEMA_VERSION})
    root.set(f"{{{XSI}}}schemaLocation", f"{DCC} {DCC}/v{SCHEMA_VERSION}/dcc.xsd")
    _administrative(dcc(root, "administrativeData"), found, stated, command)
    result = dcc(dcc(root, "measurementResults"), "measurementResult")
    content(result, "name", "Calibration of a sun sensor")
    method = dcc(dcc(result, "usedMethods"), "usedMethod")
    content(method, "name", f"model {found.chosen.name}")
    content(method, "description", f"{found.why}; models compared: {len(found.candidates)}")
    results = dcc(result, "results")
    _errors(results, found)
    _rings(results, found)
    _parameters(results, found)
    indent(root, " ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, "unicode") + "\n"


def _administrative(
    part: Element, found: Calibration, stated: CertificateSettings, command: str
) -> None:
    software(dcc(part, "dccSoftware"), versions().items())
    core = dcc(part, "coreData")
    dcc(core, "countryCodeISO3166_1", stated.country)
    dcc(core, "usedLangCodeISO639_1", "en")
    dcc(core, "mandatoryLangCodeISO639_1", "en")
    dcc(core, "uniqueIdentifier", stated.identifier or f"sunatlas-{found.digest}")
    names = dcc(core, "identifications")
    identification(names, "other", found.digest, "SHA-256 of the data, first 32 digits")
    identification(names, "other", ", ".join(found.sources), "files of the data")
    if command:
        identification(names, "other", command, "command")
    today = dt.datetime.now(dt.UTC).date()
    begin, end = stated.begin or stated.end or today, stated.end or stated.begin or today
    dcc(core, "beginPerformanceDate", begin.isoformat())
    dcc(core, "endPerformanceDate", end.isoformat())
    dcc(core, "performanceLocation", "other")
    item = dcc(dcc(part, "items"), "item")
    content(item, "name", stated.item)
    content(dcc(item, "manufacturer"), "name", stated.manufacturer)
    identification(dcc(item, "identifications"), "manufacturer", stated.serial, "serial number")
    laboratory = contact(dcc(part, "calibrationLaboratory"), "contact", stated.laboratory)
    place(laboratory, stated.mail, stated.address, stated.country)
    person = dcc(dcc(part, "respPersons"), "respPerson")
    content(dcc(person, "person"), "name", stated.person)
    dcc(person, "mainSigner", "true")
    place(contact(part, "customer", stated.customer), UNSTATED, UNSTATED, NO_COUNTRY)
    statements = dcc(part, "statements")
    for text in (
        f"Verdict: {found.verdict.word}. {found.verdict.reason}.",
        _UNSIGNED,
        *(one.found + ("" if one in found.applied else " (not applied)") for one in found.findings),
    ):
        content(dcc(statements, "statement"), "declaration", text)


def _errors(results: Element, found: Calibration) -> None:
    data = _result(results, "Errors of directions", "RMS angles, of all samples that were fitted")
    chosen = found.chosen
    quantity(
        data, "RMS error of samples left out of the fit", chosen.rms_deg, _DEGREE,
        COVERAGE_FACTOR * chosen.spread_deg,
    )  # fmt: skip
    quantity(data, "RMS residual of samples fitted", found.residual_deg, _DEGREE)
    if np.isfinite(found.noise_deg):
        quantity(data, "RMS noise of single samples", found.noise_deg, _DEGREE)
    floor = found.settings.bench.floor_deg
    quantity(data, "RMS error of the bench's directions, as stated", floor, _DEGREE)
    quantity(data, "samples fitted", len(found.readings), UNITS[""])
    quantity(data, "samples left out as wrong", len(found.excluded), UNITS[""])


def _rings(results: Element, found: Calibration) -> None:
    """Add the errors of samples left out by their angle from the boresight."""
    errors = np.asarray(found.chosen.errors)
    step = max(-(-len(found.readings) // len(errors)), 1)
    readings = found.readings.only(np.arange(0, len(found.readings), step))
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
        return
    data = _result(
        results,
        "Errors by angle from the boresight",
        "of samples left out, in rings; expanded uncertainty of a direction along a tangent axis",
    )
    rings = dcc(data, "list")
    quantities(rings, "outer edge of the ring", edges, _DEGREE)
    quantities(rings, "RMS error", rms, _DEGREE)
    quantities(rings, "expanded uncertainty of a direction, k = 2", stated, _DEGREE)


def _parameters(results: Element, found: Calibration) -> None:
    stages = (
        *getattr(found.model, "compensations", ()),
        getattr(found.model, "model", found.model),
    )
    fitted = [
        one
        for stage in stages
        if hasattr(stage, "quality_")
        for one in stage.quality_.parameters
        if np.isfinite(one.value)
    ]
    if not fitted:
        return
    data = _result(results, "Parameters of the model", f"of {found.chosen.name}")
    for one in fitted:
        name = one.name if one.unit in {"", "deg", "mm"} else f"{one.name} in {one.unit}"
        deviation = one.deviation
        known = deviation is not None and np.isfinite(deviation)
        quantity(
            data, name, one.value, UNITS.get(one.unit, UNITS[""]),
            COVERAGE_FACTOR * deviation if known else None,
        )  # fmt: skip


def _result(results: Element, name: str, description: str) -> Element:
    made = dcc(results, "result")
    content(made, "name", name)
    content(made, "description", description)
    return dcc(made, "data")
