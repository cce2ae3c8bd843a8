"""Whether a bundle is whole and says the truth of itself; nothing is fetched to find out.

A bundle may come from anywhere. Its descriptor is read strictly before anything acts on it: only
tables that lie in the bundle, described in place, by members that a bundle has; no address found in
it is ever asked.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError

from api.deposit.crate import CRATE, SPECIFICATION
from api.deposit.forms import Problem, of_forms
from api.deposit.package import DESCRIPTOR, FACTS, NAME, PROFILE
from api.metadata.fields import TABLE_SCHEMA
from files.checksums import CHECKSUMS, differences, read_checksums

#: Terms, without which a bundle does not go out.
_TERMS = ("LICENSE", *(f"{folder}/LICENSE" for folder in FACTS))


class _Member(BaseModel):
    """A part of a bundle's descriptor.

    Whatever else a descriptor may have points elsewhere or says how to read, and is refused.
    """

    model_config = ConfigDict(extra="forbid", strict=True)


class _Constraints(_Member):
    enum: list[Any] | None = None
    minimum: Any = None
    maximum: Any = None
    pattern: str | None = None
    required: bool | None = None
    unique: bool | None = None


class _Field(_Member):
    name: str
    type: str
    description: str = ""
    constraints: _Constraints | None = None


class _Schema(_Member):
    profile: Literal[TABLE_SCHEMA] = Field(TABLE_SCHEMA, alias="$schema")  # type: ignore[valid-type]
    fields_: list[_Field] = Field(alias="fields")
    missing_values: list[Any] = Field([], alias="missingValues")
    primary_key: list[Any] = Field([], alias="primaryKey")
    foreign_keys: list[Any] = Field([], alias="foreignKeys")
    unique_keys: list[Any] = Field([], alias="uniqueKeys")


class _File(_Member):
    """A resource; a table or any other file."""

    name: str
    title: str
    description: str
    path: str
    format: str | None = None
    mediatype: str | None = None
    bytes: int
    hash: str
    licenses: list[Any] = []


class _Table(_File):
    type: Literal["table"]
    format: Literal["csv"]
    encoding: Literal["utf-8"]
    schema_: _Schema = Field(alias="schema")


def _kind(resource: Any) -> str:
    named = isinstance(resource, dict) and str(resource.get("path")).endswith(".csv")
    return "table" if named or (isinstance(resource, dict) and "type" in resource) else "file"


_Resource = Annotated[
    Annotated[_Table, Tag("table")] | Annotated[_File, Tag("file")], Discriminator(_kind)
]


class _Package(_Member):
    profile: Literal[PROFILE] = Field(alias="$schema")  # type: ignore[valid-type]
    name: Literal[NAME]  # type: ignore[valid-type]
    title: str
    description: str
    version: str = Field(pattern=r"^[0-9][0-9A-Za-z.+-]{0,40}$")
    created: str = Field(pattern=r"^[0-9]{4}-[0-9]{2}-[0-9]{2}T00:00:00Z$")
    licenses: list[Any] = []
    contributors: list[Any]
    sources: list[Any]
    keywords: list[Any]
    resources: list[_Resource] = Field(min_length=1)


#: What cannot be seen in a bundle alone.
UNSEEN = (
    "Not seen so: a number that was changed in every form of its table before the checksums were "
    "made anew, and samples that no data set made. `sunatlas deposit verify` without --alone, by "
    "the version that made the bundle, holds each against the record and the data sets."
)


class NoBundleError(ValueError):
    """A directory is no bundle; the message says what it lacks."""


def verify(directory: Path) -> list[Problem]:
    """Check a bundle: (file, what is wrong with it); empty where all holds.

    Checksums first; where they hold, descriptor and crate against them; where these hold, every
    table against its description; at last its other forms.
    Whoever makes the bundle anew can change a number in all of them: `UNSEEN`.

    Raises
    ------
    NoBundleError
        Where the directory is no bundle.
    FileRefusedError
        Where the list of checksums cannot be read.
    """
    if not (directory / CHECKSUMS).is_file():
        raise NoBundleError(f"{directory}: not a bundle, it has no {CHECKSUMS}")
    if wrong := differences(directory):
        return wrong
    listed = read_checksums(directory)
    if DESCRIPTOR not in listed:
        raise NoBundleError(f"{directory}: not a bundle, it has no {DESCRIPTOR}")
    package = _document(directory / DESCRIPTOR)
    if isinstance(package, str):
        return [(DESCRIPTOR, package)]
    crate = _document(directory / CRATE) if CRATE in listed else "missing"
    wrong = [(DESCRIPTOR, text) for text in _of_package(package, directory, listed)]
    if isinstance(crate, str):
        return [*wrong, (CRATE, crate)]
    wrong += [(CRATE, text) for text in _of_crate(crate, directory, listed)]
    return (
        wrong
        or _of_tables(directory, package)
        or [
            (name, "missing; a bundle goes out with its terms")
            for name in _TERMS
            if name not in listed
        ]
        or of_forms(directory, package, listed)
    )


def _document(path: Path) -> dict[str, Any] | str:
    """Return the object that a JSON file holds, or what is wrong with it."""
    try:
        found = json.loads(path.read_text("utf-8"))
    except (ValueError, RecursionError) as error:
        return f"not JSON ({error})"
    return found if isinstance(found, dict) else "expected an object"


def _of_package(
    package: Mapping[str, Any], directory: Path, listed: Mapping[str, str]
) -> Iterator[str]:
    try:
        read = _Package.model_validate(package)
    except ValidationError as error:
        for one in error.errors(include_url=False):
            place = ".".join(str(part) for part in one["loc"] if part not in ("table", "file"))
            yield f"{place[:80]}: {one['msg']}; got {_short(one['input'])}"
        return
    seen: set[str] = set()
    for resource in read.resources:
        what = f"resource {resource.name[:80]}"
        if resource.name in seen:
            yield f"{what} stands there twice"
        seen.add(resource.name)
        if resource.path not in listed:
            yield f"{what}: path is {_short(resource.path)}; expected a file of {CHECKSUMS}"
            continue
        if resource.hash != f"sha256:{listed[resource.path]}":
            yield f"{what}: hash is not that of {resource.path} in {CHECKSUMS}"
        if resource.bytes != (directory / resource.path).stat().st_size:
            yield f"{what}: bytes are not those of {resource.path}"


def _of_crate(
    crate: Mapping[str, Any], directory: Path, listed: Mapping[str, str]
) -> Iterator[str]:
    graph = crate.get("@graph")
    entities = {e.get("@id"): e for e in graph or () if isinstance(e, dict)} if graph else {}
    about = entities.get(CRATE, {})
    if about.get("conformsTo") != {"@id": SPECIFICATION}:
        yield f"conformsTo is {_short(about.get('conformsTo'))}, expected {SPECIFICATION}"
    for path in sorted(listed.keys() - {CRATE}):
        entity = entities.get(path)
        if entity is None:
            yield f"{path} is not described"
        elif entity.get("sha256") != listed[path]:
            yield f"{path}: sha256 is not that of {CHECKSUMS}"
        elif entity.get("contentSize") != str((directory / path).stat().st_size):
            yield f"{path}: contentSize is not its size"
    described = {key for key, e in entities.items() if e.get("@type") == "File"}
    for name in sorted(described - listed.keys() - {CHECKSUMS}, key=str):
        yield f"{_short(name)} is described, but no file of the bundle"


class _Offline:
    """Stands where frictionless has its connection to the web."""

    def __getattr__(self, name: str) -> Any:
        raise ConnectionRefusedError("a bundle is verified offline")


def _of_tables(directory: Path, package: Mapping[str, Any]) -> list[Problem]:
    from frictionless import FrictionlessException, Package, system  # noqa: PLC0415 - a second

    # Profiles are checked above and left out: their addresses would be asked for.
    tables = [
        {**r, "schema": {n: member for n, member in r["schema"].items() if n != "$schema"}}
        for r in package["resources"]
        if r.get("type") == "table"
    ]
    with system.use_context(http_session=_Offline()):
        try:
            descriptor = {"name": package["name"], "resources": tables}
            report = Package.from_descriptor(descriptor, basepath=str(directory)).validate()
        except FrictionlessException as error:
            return [(DESCRIPTOR, " ".join(str(error).split()))]
    found = [(DESCRIPTOR, error.message) for error in report.errors]
    return found + [(task.place, error.message) for task in report.tasks for error in task.errors]


def _short(value: Any) -> str:
    return repr(value)[:80]
