"""What the project is called, its version, its licences, how to cite it.

In a checkout the files at the repository's root say so; in an installed package, which has no
such files beside it, the distribution's metadata does.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from functools import cache
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

import yaml

from api.metadata.citation import Author
from api.metadata.citation import authors as authors_of

DISTRIBUTION = "sun-sensor-atlas"
ROOT = Path(__file__).resolve().parents[2]


class MissingFileError(FileNotFoundError):
    """A file the project cannot go out without is neither in the checkout nor in the package."""


@dataclass(frozen=True)
class Identity:
    """Name, version and terms of the project.

    Attributes
    ----------
    title : name for people
    version : of the distribution
    summary : one sentence
    authors : as CITATION.cff names them
    released : date of this version
    citation : text of CITATION.cff (Citation File Format 1.2.0)
    code_licence, data_licence : texts, MIT and CC BY 4.0
    """

    title: str
    version: str
    summary: str
    authors: tuple[Author, ...]
    released: date
    citation: str
    code_licence: str
    data_licence: str


@cache
def identity() -> Identity:
    """Say who the running code is.

    Raises
    ------
    MissingFileError
        Where a licence or CITATION.cff is not found.
    CitationError
        Where the authors in CITATION.cff cannot be read.
    """
    number, summary = _project()
    citation = _licence("CITATION.cff")
    return Identity(
        title="Sun Sensor Atlas",
        version=number,
        summary=summary,
        authors=authors_of(citation, "CITATION.cff"),
        released=date.fromisoformat(str(yaml.safe_load(citation)["date-released"])),
        citation=citation,
        code_licence=_licence("LICENSE"),
        data_licence=_licence("survey_data/LICENSE"),
    )


def version() -> str:
    """Return the version of the running code; licences are not looked for."""
    return _project()[0]


def _checkout() -> bool:
    return (ROOT / "pyproject.toml").is_file()


def _installed() -> Distribution | None:
    try:
        return distribution(DISTRIBUTION)
    except PackageNotFoundError:
        return None


def _project() -> tuple[str, str]:
    """Return version and summary."""
    # The checkout first: an editable installation's metadata are those of the day it was made.
    if _checkout():
        project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
        return project["version"], project["description"]
    installed = _installed()
    if installed is None:
        raise MissingFileError(f"neither {ROOT / 'pyproject.toml'} nor an installed {DISTRIBUTION}")
    return installed.metadata["Version"], installed.metadata["Summary"]


def _licence(name: str) -> str:
    # survey_data/LICENSE is package data, beside this package in a checkout and in a wheel alike.
    path = ROOT / name
    if path.is_file() and (_checkout() or "/" in name):
        return path.read_text("utf-8")
    installed = _installed()
    text = installed.read_text(f"licenses/{name}") if installed else None
    if text is None:
        raise MissingFileError(f"no {name} at {ROOT} or in the metadata of {DISTRIBUTION}")
    return text


LICENCES: Mapping[str, str] = {
    "MIT": "https://spdx.org/licenses/MIT",
    "CC-BY-4.0": "https://spdx.org/licenses/CC-BY-4.0",
}
SCHEMA = "https://schema.org/"
LD_JSON = "application/ld+json"
LINKSET = "application/linkset+json"
