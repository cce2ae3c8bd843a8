"""A certificate holds what was found, in the order that PTB's schema 3.1.2 asks for."""

from __future__ import annotations

import datetime as dt
from xml.etree import ElementTree as ET

import bench
import numpy as np
import pytest

from calibrate import calibration
from calibrate.report.certificate import certificate
from calibrate.roles import guess
from calibrate.settings import CertificateSettings
from calibrate.table import read_table

#: Children of each element that is written, in their order; those that end in ``?`` may be missing,
#: in ``*`` be many. Of dcc.xsd 3.1.2 and SI_Format.xsd 2.1, which are not bundled.
CHILDREN = {
    "digitalCalibrationCertificate": "administrativeData measurementResults",
    "administrativeData": "dccSoftware coreData items calibrationLaboratory respPersons customer "
    "statements?",
    "dccSoftware": "software*",
    "software": "name release",
    "name": "content*",
    "description": "content*",
    "declaration": "content*",
    "further": "content*",
    "coreData": "countryCodeISO3166_1 usedLangCodeISO639_1 mandatoryLangCodeISO639_1 "
    "uniqueIdentifier identifications? beginPerformanceDate endPerformanceDate performanceLocation",
    "identifications": "identification*",
    "identification": "issuer value name?",
    "items": "item*",
    "item": "name manufacturer identifications",
    "manufacturer": "name",
    "calibrationLaboratory": "contact",
    "contact": "name eMail location",
    "customer": "name eMail location",
    "location": "countryCode further",
    "respPersons": "respPerson*",
    "respPerson": "person mainSigner?",
    "person": "name",
    "statements": "statement*",
    "statement": "declaration",
    "measurementResults": "measurementResult*",
    "measurementResult": "name usedMethods? results",
    "usedMethods": "usedMethod*",
    "usedMethod": "name description?",
    "results": "result*",
    "result": "name description? data",
    "data": "list? quantity*",
    "list": "quantity*",
    "quantity": "name? real? realListXMLList?",
    "real": "value unit expandedUnc?",
    "expandedUnc": "uncertainty coverageFactor coverageProbability distribution?",
    "realListXMLList": "valueXMLList unitXMLList expandedUncXMLList?",
}
NAMES = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}
#: Elements of D-SI; all others are of the DCC.
SI = {
    *("real", "value", "unit", "expandedUnc", "uncertainty", "coverageFactor"),
    *("coverageProbability", "distribution", "realListXMLList", "valueXMLList", "unitXMLList"),
}


def require_order(element):
    space, name = element.tag.removeprefix("{").split("}")
    children = [child.tag.split("}")[1] for child in element]
    if name == "value" and space == NAMES["dcc"]:
        assert not children
    else:
        assert space == NAMES["si" if name in SI else "dcc"], name
    left = list(children)
    for wanted in CHILDREN.get(name, "").split():
        plain = wanted.rstrip("*?")
        count = 0
        while left and left[0] == plain:
            left.pop(0)
            count += 1
        assert count <= 1 or wanted.endswith("*"), (name, plain)
        assert count >= 1 or wanted.endswith("?") or name == "data", (name, plain)
    assert left == [], (name, children)
    for child in element:
        require_order(child)


def number(root, name):
    for quantity in root.iter(f"{{{NAMES['dcc']}}}quantity"):
        if quantity.findtext("dcc:name/dcc:content", "", NAMES) == name:
            return quantity
    raise AssertionError(name)


@pytest.fixture(scope="module")
def camera(tmp_path_factory):
    path = tmp_path_factory.mktemp("certificate") / "bench.csv"
    angles = np.random.default_rng(1001).uniform(-50.0, 50.0, (441, 2))
    bench.write(path, bench.HEADER, bench.spots(bench.sun_of(angles), 1), angles)
    settings = guess(read_table(path))
    stated = CertificateSettings(
        laboratory="Bench & <Sons>", country="FI", serial="7", end=dt.date(2026, 1, 2)
    )
    return calibration.calibrate(
        [path], settings.model_copy(update={"certificate": stated}), models=("pinhole",)
    )


def test_elements_are_in_the_order_of_the_schema(camera):
    require_order(ET.fromstring(certificate(camera, "sunatlas calibrate bench.csv")))


def test_numbers_are_those_that_were_found(camera):
    root = ET.fromstring(certificate(camera))
    error = number(root, "RMS error of samples left out of the fit")
    assert float(error.findtext(".//si:value", "", NAMES)) == camera.chosen.rms_deg
    assert error.findtext(".//si:unit", "", NAMES) == r"\degree"
    uncertainty = float(error.findtext(".//si:uncertainty", "", NAMES))
    assert uncertainty == 2 * camera.chosen.spread_deg
    focal = number(root, "focal_length_x")
    stated = camera.model.quality_.parameter("focal_length_x")
    assert float(focal.findtext(".//si:value", "", NAMES)) == stated.value
    assert float(focal.findtext(".//si:uncertainty", "", NAMES)) == 2 * stated.deviation
    rings = number(root, "RMS error").findtext(".//si:valueXMLList", "", NAMES).split()
    edges = number(root, "outer edge of the ring").findtext(".//si:valueXMLList", "", NAMES)
    assert edges == "10.0 20.0 30.0 40.0 50.0 60.0 70.0"[: len(edges)]
    assert len(rings) == len(edges.split())
    inner = camera.readings.sun[:, 2] > np.cos(np.radians(10.0))
    error = np.sqrt(np.nanmean(camera.chosen.errors[inner] ** 2))
    assert float(rings[0]) == pytest.approx(error, rel=1e-12)


def test_who_and_what_are_stated_and_the_rest_is_said_to_be_unknown(camera):
    text = certificate(camera, "a\x01b")
    root = ET.fromstring(text)
    held = {element.text for element in root.iter()}
    assert {"Bench & <Sons>", "FI", "7", "2026-01-02", camera.digest, "a?b"} <= held
    assert root.findtext(".//dcc:customer/dcc:name/dcc:content", "", NAMES) == "not stated"
    assert root.findtext(".//dcc:customer/dcc:location/dcc:countryCode", "", NAMES) == "ZZ"
    assert "sun-sensor-atlas" in held
    assert any((one or "").startswith("Verdict: good") for one in held)
