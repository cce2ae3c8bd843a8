"""Under which licence each file of a bundle stands: facts under CC BY 4.0, all else under MIT."""

from __future__ import annotations

from api.deposit.readme import BIBLIOGRAPHY

#: Folders of facts.
FACTS = ("survey", BIBLIOGRAPHY)


def terms(name: str) -> str:
    """Return the SPDX identifier of the licence of a file, by its path in the bundle."""
    return "CC-BY-4.0" if name.partition("/")[0] in FACTS and "/" in name else "MIT"
