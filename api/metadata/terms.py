"""Licences and relations by the addresses that machines know them by."""

from __future__ import annotations

from collections.abc import Mapping

LICENCES: Mapping[str, str] = {
    "MIT": "https://spdx.org/licenses/MIT",
    "CC-BY-4.0": "https://spdx.org/licenses/CC-BY-4.0",
}
SCHEMA = "https://schema.org/"
LD_JSON = "application/ld+json"
LINKSET = "application/linkset+json"
