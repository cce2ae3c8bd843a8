"""The bundle an archive takes: facts and measurements with descriptors, licences and checksums.

A bundle is a directory and the same files as a zip beside it. It is a function of the survey's
tables, the published results and the version, so that building twice gives the same bytes.
"""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import survey_data
from api.deposit.crate import CRATE, crate
from api.deposit.identity import Identity, identity
from api.deposit.package import NAME, package
from api.deposit.readme import readme
from api.deposit.tables import MeasuredTable, measured_tables, read_descriptor
from benchmark.datasets.checksums import (
    CHECKSUMS,
    ChecksumFileError,
    contents,
    differences,
    read_checksums,
    write_checksums,
)
from benchmark.results.store import PUBLISHED
from survey_data.whole_files import replacing

DESCRIPTOR = "datapackage.json"
SURVEY = Path(survey_data.__file__).parent


class DepositError(ValueError):
    """A bundle cannot be built or is not one; the message names the file."""


@dataclass(frozen=True)
class Bundle:
    """What was built.

    Attributes
    ----------
    directory, archive : the bundle, and its zip
    files : paths in the bundle, sorted
    """

    directory: Path
    archive: Path
    files: tuple[str, ...]


def build(out: Path, *, survey: Path = SURVEY, published: Path = PUBLISHED) -> Bundle:
    """Build the bundle at `out` and its zip at `out`.zip, both or neither.

    Parameters
    ----------
    out : the directory to make; one that holds an earlier bundle is replaced
    survey : directory of the survey's tables and their datapackage.json
    published : directory of the published results

    Raises
    ------
    DepositError
        Where `out` holds anything but an earlier bundle, or the survey's tables have problems.
    FileNotFoundError
        Where there are no published results, or a licence is missing.
    ValueError
        Where a table cannot be read or has a column nothing is known of.
    """
    out = Path(os.path.abspath(out))  # noqa: PTH100 - resolve() would follow a symbolic link
    archive = out.with_name(f"{out.name}.zip")
    _require_ours(out)
    _require_our_archive(archive)
    problems = survey_data.validate(survey)
    if problems:
        raise DepositError(
            f"the survey's tables have {len(problems)} problems, the first: {problems[0]}; "
            "see `sunatlas survey check`"
        )
    who = identity()
    measured = measured_tables(published)
    out.parent.mkdir(parents=True, exist_ok=True)
    with replacing(out, archive) as (bundle, zipped):
        bundle.mkdir()
        _fill(bundle, who, survey, measured)
        _pack(bundle, zipped, who)
    return Bundle(out, archive, tuple(contents(out)))


def verify(directory: Path) -> list[tuple[str, str]]:
    """Check a bundle: (file, what is wrong with it); empty where all holds.

    Checksums first; where they hold, every table against the descriptor.

    Raises
    ------
    DepositError
        Where the directory is no bundle.
    ChecksumFileError
        Where the list of checksums cannot be read.
    """
    if not (directory / CHECKSUMS).is_file():
        raise DepositError(f"{directory}: not a bundle, it has no {CHECKSUMS}")
    wrong = differences(directory)
    if wrong:
        return wrong
    if not (directory / DESCRIPTOR).is_file():
        raise DepositError(f"{directory}: not a bundle, it has no {DESCRIPTOR}")
    return _invalid(directory / DESCRIPTOR)


def _invalid(descriptor: Path) -> list[tuple[str, str]]:
    from frictionless import Package  # noqa: PLC0415 - a second that building does without

    report = Package(str(descriptor)).validate()
    found = [(DESCRIPTOR, error.message) for error in report.errors]
    found += [(task.place, error.message) for task in report.tasks for error in task.errors]
    return found


def _fill(bundle: Path, who: Identity, survey: Path, measured: list[MeasuredTable]) -> None:
    described = read_descriptor(survey / DESCRIPTOR)
    for resource in described["resources"]:
        target = bundle / "survey" / resource["path"]
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((survey / resource["path"]).read_bytes())
    for table in measured:
        _write(bundle / "benchmark" / f"{table.name}.csv", table.text)
    descriptor = package(bundle, who, described, measured)
    _write_json(bundle / DESCRIPTOR, descriptor)
    _write(bundle / "LICENSE", who.code_licence)
    _write(bundle / "survey" / "LICENSE", who.data_licence)
    _write(bundle / "CITATION.cff", who.citation)
    _write(bundle / "README.md", readme(who, descriptor))
    resources = descriptor["resources"]
    _write_json(
        bundle / CRATE,
        crate(
            who,
            {name: (bundle / name).stat().st_size for name in contents(bundle)},
            {r["path"]: (r["title"], r["description"]) for r in resources},
            {r["path"]: r["licenses"][0]["name"] for r in resources},
            descriptor["keywords"],
        ),
    )
    write_checksums(bundle)


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8", newline="\n")


def _write_json(path: Path, document: Mapping[str, Any]) -> None:
    _write(path, json.dumps(document, indent=2, ensure_ascii=False) + "\n")


def _pack(bundle: Path, target: Path, who: Identity) -> None:
    moment = (who.released.year, who.released.month, who.released.day, 0, 0, 0)
    with zipfile.ZipFile(target, "w") as archive:
        for name in contents(bundle):
            entry = zipfile.ZipInfo(f"{NAME}-{who.version}/{name}", moment)
            entry.create_system = 3  # Unix, on every machine, for the permissions below
            entry.external_attr = 0o100644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, (bundle / name).read_bytes(), compresslevel=9)


def _require_ours(out: Path) -> None:
    if out.is_symlink() or (out.exists() and not out.is_dir()):
        raise DepositError(f"{out}: expected a directory or nothing; nothing was written")
    if not out.exists() or not any(out.iterdir()):
        return
    try:
        listed = {*read_checksums(out), CHECKSUMS}
        foreign = [name for name in contents(out) if name not in listed]
        ours = read_descriptor(out / DESCRIPTOR).get("name") == NAME
    except (FileNotFoundError, ChecksumFileError, ValueError):
        foreign, ours = contents(out), False
    if foreign or not ours:
        held = f"{foreign[0]}" if foreign else "another data package"
        raise DepositError(
            f"{out}: holds {held}, which is no part of an earlier bundle; choose an empty "
            "directory with --out; nothing was written"
        )


def _require_our_archive(archive: Path) -> None:
    if not archive.exists() and not archive.is_symlink():
        return
    if zipfile.is_zipfile(archive):
        with zipfile.ZipFile(archive) as packed:
            names = packed.namelist()
        if names and all(name.startswith(f"{NAME}-") for name in names):
            return
    raise DepositError(f"{archive}: not the zip of an earlier bundle; nothing was written")
