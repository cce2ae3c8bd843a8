"""Whether a bundle is whole and says the truth of itself; nothing is fetched to find out.

A bundle may come from anywhere. Its descriptor is read strictly before anything acts on it: only
tables that lie in the bundle, described in place, by members that a bundle has; no address found in
it is ever asked.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from api.deposit.crate import CRATE, SPECIFICATION
from api.deposit.forms import of_forms, of_terms
from api.deposit.limits import excess_size, unfit_names
from api.deposit.package import DESCRIPTOR, NAME, PROFILE
from api.metadata.fields import TABLE_SCHEMA
from files.checksums import CHECKSUMS, contents, differences, read_checksums

Problem = tuple[str, str]

#: Members that a bundle's descriptor has; whatever else a descriptor may have points elsewhere or
#: says how to read, and is refused.
_PACKAGE = {
    "$schema": str,
    "name": str,
    "title": str,
    "description": str,
    "version": str,
    "created": str,
    "licenses": list,
    "contributors": list,
    "sources": list,
    "keywords": list,
    "resources": list,
}
_RESOURCE = {
    "name": str,
    "type": str,
    "title": str,
    "description": str,
    "path": str,
    "format": str,
    "mediatype": str,
    "encoding": str,
    "bytes": int,
    "hash": str,
    "licenses": list,
    "schema": dict,
}
_SCHEMA = {
    "$schema": str,
    "fields": list,
    "missingValues": list,
    "primaryKey": list,
    "foreignKeys": list,
    "uniqueKeys": list,
}
_FIELD = {"name": str, "type": str, "description": str, "constraints": dict}
_CONSTRAINTS = {"enum", "minimum", "maximum", "pattern", "required", "unique"}
_VERSION = re.compile(r"[0-9][0-9A-Za-z.+-]{0,40}")
_CREATED = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}T00:00:00Z")

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

    Sizes and names first, then checksums; where they hold, descriptor and crate against them; where
    these hold, every table against its description; at last its other forms and its licences.
    Whoever makes the bundle anew can change a number in all of them: `UNSEEN`.

    Raises
    ------
    NoBundleError
        Where the directory is no bundle.
    ChecksumFileError
        Where the list of checksums cannot be read.
    """
    if not (directory / CHECKSUMS).is_file():
        raise NoBundleError(f"{directory}: not a bundle, it has no {CHECKSUMS}")
    names = contents(directory)
    if (large := excess_size(directory, names)) is not None:
        return [large]
    if wrong := [*unfit_names(names), *differences(directory)]:
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
        or [*of_terms(directory, package, crate, listed), *of_forms(directory, package, listed)]
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
    yield from _members("the package", package, _PACKAGE)
    for name, expected in (("$schema", PROFILE), ("name", NAME)):
        if package.get(name) != expected:
            yield f"{name} is {_short(package.get(name))}, expected {expected}"
    for name, pattern in (("version", _VERSION), ("created", _CREATED)):
        if not pattern.fullmatch(str(package.get(name))):
            yield f"{name} is {_short(package.get(name))}, expected as {pattern.pattern}"
    resources = package.get("resources")
    if not isinstance(resources, list) or not resources:
        yield "no resources"
        return
    seen: set[str] = set()
    for number, resource in enumerate(resources, start=1):
        if not isinstance(resource, dict):
            yield f"resource {number} is {_short(resource)}, expected an object"
            continue
        named = resource.get("name")
        what = f"resource {named if isinstance(named, str) else number}"
        if str(named) in seen:
            yield f"{what} stands there twice"
        seen.add(str(named))
        yield from _of_resource(what, resource, directory, listed)


def _of_resource(
    what: str, resource: Mapping[str, Any], directory: Path, listed: Mapping[str, str]
) -> Iterator[str]:
    yield from _members(what, resource, _RESOURCE)
    path = resource.get("path")
    if not isinstance(path, str) or path not in listed:
        yield f"{what}: path is {_short(path)}, expected a file that {CHECKSUMS} lists"
        return
    if resource.get("hash") != f"sha256:{listed[path]}":
        yield f"{what}: hash is not that of {path} in {CHECKSUMS}"
    if resource.get("bytes") != (directory / path).stat().st_size:
        yield f"{what}: bytes are not those of {path}"
    if resource.get("type") == "table":
        yield from _of_table(what, resource)
    elif "type" in resource or "schema" in resource or path.endswith(".csv"):
        yield f"{what}: expected a table with its schema"


def _of_table(what: str, resource: Mapping[str, Any]) -> Iterator[str]:
    if (resource.get("format"), resource.get("encoding")) != ("csv", "utf-8"):
        yield f"{what}: expected format csv, encoding utf-8"
    schema = resource.get("schema")
    if not isinstance(schema, dict):
        yield f"{what}: schema is {_short(schema)}, expected an object"
        return
    yield from _members(f"{what}, schema", schema, _SCHEMA)
    if schema.get("$schema", TABLE_SCHEMA) != TABLE_SCHEMA:
        yield f"{what}, schema: $schema is {_short(schema['$schema'])}, expected {TABLE_SCHEMA}"
    fields = schema.get("fields")
    for field in fields if isinstance(fields, list) else [fields]:
        if not isinstance(field, dict):
            yield f"{what}, schema: a field is {_short(field)}, expected an object"
            continue
        yield from _members(f"{what}, a field", field, _FIELD)
        if unknown := set(field.get("constraints") or ()) - _CONSTRAINTS:
            yield f"{what}, a field: constraint {_short(min(unknown))} is none of a bundle's"


def _members(what: str, found: Mapping[str, Any], known: Mapping[str, type]) -> Iterator[str]:
    for name, value in found.items():
        if name not in known:
            yield f"{what}: {_short(name)} is no member of a bundle's descriptor"
        elif not isinstance(value, known[name]) or isinstance(value, bool):
            yield f"{what}: {name} is {_short(value)}, expected {known[name].__name__}"


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
