"""Elements of a DCC: XML with PTB's names, in the order that its schema asks for."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from xml.etree.ElementTree import Element, SubElement

#: Version of the schema (https://ptb.de/dcc/v3.1.2/dcc.xsd, with D-SI 2.1) that is written.
SCHEMA_VERSION = "3.1.2"
DCC, SI, XSI = (
    "https://ptb.de/dcc",
    "https://ptb.de/si",
    "http://www.w3.org/2001/XMLSchema-instance",
)
#: Coverage factor of the expanded uncertainties, and its coverage probability.
COVERAGE_FACTOR, COVERAGE = 2.0, 0.95
#: Characters that XML 1.0 has no place for.
_UNWRITABLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def dcc(parent: Element, name: str, text: str | None = None, **attributes: str) -> Element:
    """Return a new element of the DCC below another, with a text if there is one."""
    made = SubElement(parent, f"{{{DCC}}}{name}", attributes)
    if text is not None:
        made.text = _UNWRITABLE.sub("?", text)
    return made


def content(parent: Element, name: str, *texts: str) -> Element:
    """Return an element of texts, in English."""
    made = dcc(parent, name)
    for text in texts:
        dcc(made, "content", text, lang="en")
    return made


def software(parent: Element, versions: Iterable[tuple[str, str]]) -> None:
    """Add software by name and version."""
    for name, version in versions:
        made = dcc(parent, "software")
        content(made, "name", name)
        dcc(made, "release", version)


def identification(parent: Element, issuer: str, value: str, name: str) -> None:
    """Add what identifies a thing: who gave the name, and the name."""
    made = dcc(parent, "identification")
    dcc(made, "issuer", issuer)
    dcc(made, "value", value)
    content(made, "name", name)


def contact(parent: Element, tag: str, name: str) -> Element:
    """Return an element of a person or an organisation, of which `place` says where it is."""
    made = dcc(parent, tag)
    content(made, "name", name)
    return made


def place(parent: Element, mail: str, address: str, country: str) -> None:
    """Add where a contact is reached."""
    dcc(parent, "eMail", mail)
    made = dcc(parent, "location")
    dcc(made, "countryCode", country)
    content(made, "further", address)


def quantity(
    parent: Element, name: str, value: float, unit: str, uncertainty: float | None = None
) -> None:
    """Add a number with its unit in D-SI, and its expanded uncertainty where it is known."""
    made = dcc(parent, "quantity")
    content(made, "name", name)
    real = SubElement(made, f"{{{SI}}}real")
    _si(real, "value", repr(float(value)))
    _si(real, "unit", unit)
    if uncertainty is not None:
        expanded = _si(real, "expandedUnc")
        _si(expanded, "uncertainty", repr(float(uncertainty)))
        _si(expanded, "coverageFactor", repr(COVERAGE_FACTOR))
        _si(expanded, "coverageProbability", repr(COVERAGE))
        _si(expanded, "distribution", "normal")


def quantities(parent: Element, name: str, values: Sequence[float], unit: str) -> None:
    """Add numbers of one unit."""
    made = dcc(parent, "quantity")
    content(made, "name", name)
    real = SubElement(made, f"{{{SI}}}realListXMLList")
    _si(real, "valueXMLList", _numbers(values))
    _si(real, "unitXMLList", unit)


def _si(parent: Element, name: str, text: str | None = None) -> Element:
    made = SubElement(parent, f"{{{SI}}}{name}")
    made.text = text
    return made


def _numbers(values: Sequence[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
