"""A whole bundle of one table: what an upload needs, made in no time."""

from __future__ import annotations

import datetime as dt
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from api.deposit.crate import CRATE, crate
from api.deposit.deposit_tables import MeasuredTable
from api.deposit.forms import write_other_forms
from api.deposit.package import DESCRIPTOR, pack, package
from api.metadata.citation import authors
from api.metadata.identity import Identity, identity
from files.atomic import temporary_directory
from files.checksums import contents, sha256, write_checksums

ZIP = "bundle.zip"
PEOPLE = """\
authors:
  - family-names: Sommer
    given-names: Ada
    orcid: https://orcid.org/0009-0000-0012-3455
    affiliation: Institute of Light
repository-code: https://code.institute-of-light.org/sun/atlas
"""
NOWHERE = PEOPLE[: PEOPLE.index("repository-code")]
PLACEHOLDER = "authors:\n  - name: The Sun Sensor Atlas contributors\n"


def make(directory: Path, people: str = PEOPLE, readme: str = "# read me\n") -> Path:
    """Make a bundle and its zip; over an earlier one, whose files it has."""
    for name, content in _made(people, readme).items():
        path = directory.with_name(f"{directory.name}.zip") if name == ZIP else directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return directory


@cache
def _made(people: str, readme: str) -> Mapping[str, bytes]:
    """Return the contents of each file by its name."""
    with temporary_directory() as place:
        directory = _write(place / "bundle", people, readme)
        made = {
            path.relative_to(directory).as_posix(): path.read_bytes()
            for path in directory.rglob("*")
            if path.is_file()
        }
        return {**made, ZIP: (place / ZIP).read_bytes()}


def _write(directory: Path, people: str, readme: str) -> Path:
    citation = f"cff-version: 1.2.0\ntype: dataset\n{people}"
    who = Identity(
        "Sun Sensor Atlas",
        "0.1.0",
        "Facts and measurements.",
        authors(citation, "CITATION.cff"),
        dt.date(2026, 11, 21),
        citation,
        identity().code_licence,
        identity().data_licence,
    )
    for name in ("benchmark", "bibliography", "survey"):
        (directory / name).mkdir(parents=True)
    (directory / "benchmark" / "one.csv").write_text("name\na\n")
    schema = {"fields": [{"name": "name", "type": "string"}], "primaryKey": ["name"]}
    table = MeasuredTable("one", "One", "One table.", "", schema)
    survey = {"resources": [], "keywords": ["sun sensor"]}
    files = {
        DESCRIPTOR: json.dumps(package(directory, who, survey, [table])),
        "CITATION.cff": citation,
        "README.md": readme,
        "bibliography/studies.bib": "@misc{a,\n  title = {A},\n}\n",
        "bibliography/studies.ris": "TY  - GEN\nTI  - A\nER  - \n",
        "LICENSE": who.code_licence,
        "survey/LICENSE": who.data_licence,
        "bibliography/LICENSE": who.data_licence,
    }
    for name, text in files.items():
        (directory / name).write_text(text, "utf-8")
    write_other_forms(directory, json.loads(files[DESCRIPTOR]))
    described = {
        name: ((directory / name).stat().st_size, sha256(directory / name))
        for name in contents(directory)
    }
    document = crate(who, described, {}, ["sun sensor"])
    (directory / CRATE).write_text(json.dumps(document))
    write_checksums(directory)
    pack(directory, directory.with_name(ZIP), "sun-sensor-atlas-0.1.0", who.released)
    return directory
