"""The bundle an archive takes: facts and measurements with descriptors, licences and checksums.

A bundle is a directory and the same files as a zip beside it. It is a function of the survey's
tables, the published results and the version, so that building twice gives the same bytes.
"""

from __future__ import annotations

import csv
import json
import os
import zipfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import survey_data
from api.citations import bibtex, ris
from api.deposit.code_archive import archive_of, write_code
from api.deposit.crate import CRATE, crate
from api.deposit.deposit_tables import MeasuredTable, frames_table, measured_tables, read_descriptor
from api.deposit.forms import write_other_forms
from api.deposit.frames import write_frames
from api.deposit.package import BIBLIOGRAPHY, DESCRIPTOR, FACTS, NAME, pack, package
from api.deposit.readme import readme
from api.metadata.bundled import documents
from api.metadata.citation import of_dataset
from api.metadata.codemeta import NAME as CODEMETA
from api.metadata.codemeta import codemeta_text
from api.metadata.errors import write_errors
from api.metadata.identity import Identity, identity
from benchmark import datasets
from benchmark.progress import ProgressCallback, silent
from benchmark.results.store import PUBLISHED, Store
from files.atomic import replace_all, require_replaceable
from files.checksums import CHECKSUMS, contents, read_checksums, sha256, write_checksums
from files.manifest import manifest_digest
from files.reading import FileRefusedError
from survey_data.descriptor import file_name
from survey_data.editions import editions

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


#: Files that tell checksums of the others.
OF_DIGESTS = frozenset({CHECKSUMS, CRATE, DESCRIPTOR})


@dataclass(frozen=True)
class Sources:
    """What a bundle is made of: directories of tables and of results, and the measured tables."""

    survey: Path
    published_folder: Path
    measured_tables: list[MeasuredTable]


def build(
    out: Path,
    *,
    survey: Path = SURVEY,
    published: Path = PUBLISHED,
    frames: Sequence[str] | None = None,
    code: Path | None = None,
    progress: ProgressCallback = silent,
) -> Bundle:
    """Build the bundle at `out` and its zip at `out`.zip, both or neither.

    Parameters
    ----------
    out : the directory to make; one that holds an earlier bundle is replaced
    survey : directory of the survey's tables and their datapackage.json
    published : directory of the published results
    frames : data sets of which samples go along; all by default
    code : source distribution that goes along; made of this checkout by default
    progress : called as ``progress(done, total, what)`` in data sets, then tables and zip

    Raises
    ------
    DepositError
        Where `out` holds anything but an earlier bundle, or the survey's tables have problems.
    CodeArchiveError
        Where there is no code to put in.
    FileNotFoundError
        Where there are no published results, or a licence or CITATION.cff is missing.
    UnreplaceableError
        Where `out` is the root of a file system.
    ValueError
        Where a table cannot be read or has a column nothing is known of.
    """
    out = Path(os.path.abspath(out))  # noqa: PTH100 - resolve() would follow a symbolic link
    require_replaceable(out)
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
    sources = Sources(survey, published, measured_tables(published))
    pins = Store(published).pins()
    names = datasets.names() if frames is None else frames
    total = len(names) + 2
    with replace_all(out, archive) as (bundle, zipped):
        bundle.mkdir()
        write_code(bundle, code)
        exported = write_frames(
            bundle, names, pins, lambda done, _, what: progress(done, total, what)
        )
        progress(len(names), total, "tables")
        fill(bundle, who, sources, exported)
        progress(len(names) + 1, total, "zip")
        pack(bundle, zipped, f"{NAME}-{who.version}", who.released)
    progress(total, total, "")
    return Bundle(out, archive, tuple(contents(out)))


def fill(
    bundle: Path,
    who: Identity,
    sources: Sources,
    exported: Sequence[Mapping[str, Any]],
    *,
    other_forms: Callable[[Path, Mapping[str, Any]], None] = write_other_forms,
) -> None:
    """Write all of a bundle beside the samples and the code that lie in it.

    Parameters
    ----------
    bundle : its directory
    who : name, version and terms
    sources : what it is made of
    exported : of each file of samples what `frames.write_frames` says
    other_forms : writes the tables in other forms than CSV
    """
    described = read_descriptor(sources.survey / DESCRIPTOR)
    for resource in described["resources"]:
        target = bundle / "survey" / resource["path"]
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((sources.survey / resource["path"]).read_bytes())
    measured = [*sources.measured_tables, *([frames_table(exported)] if exported else [])]
    for table in measured:
        _write(bundle / "benchmark" / f"{table.name}.csv", table.text)
    errors = write_errors(bundle, sources.published_folder)
    descriptor = package(
        bundle, who, described, measured, exported, errors=errors, code=archive_of(bundle)
    )
    _write_json(bundle / DESCRIPTOR, descriptor)
    other_forms(bundle, descriptor)
    for name, document in documents(bundle, who, descriptor).items():
        _write_json(bundle / name, document)
    _write_bibliography(bundle)
    _write(bundle / "LICENSE", who.code_licence)
    for folder in FACTS:
        _write(bundle / folder / "LICENSE", who.data_licence)
    record, facts = manifest_digest(sources.published_folder), editions(sources.survey)
    _write(bundle / "CITATION.cff", of_dataset(who.citation, record, facts))
    _write(bundle / CODEMETA, codemeta_text(who.citation))
    _write(bundle / "README.md", readme(who, descriptor))
    # The crate tells the checksum of every other file, so that a list of all comes after it, and
    # neither of the two stands in the other's way: the list has the crate, the crate not the list.
    files = {
        name: ((bundle / name).stat().st_size, sha256(bundle / name)) for name in contents(bundle)
    }
    resources = descriptor["resources"]
    _write_json(
        bundle / CRATE,
        crate(
            who,
            files,
            {r["path"]: (r["title"], r["description"]) for r in resources},
            descriptor["keywords"],
        ),
    )
    write_checksums(bundle)


def _write_bibliography(bundle: Path) -> None:
    for table, name in (("studies", "studies"), ("extension_studies", "unmapped-studies")):
        path = bundle / "survey" / file_name(table)
        with path.open(encoding="utf-8", newline="") as file:
            studies = list(csv.DictReader(file))
        _write(bundle / BIBLIOGRAPHY / f"{name}.bib", bibtex(studies))
        _write(bundle / BIBLIOGRAPHY / f"{name}.ris", ris(studies))


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8", newline="\n")


def _write_json(path: Path, document: Mapping[str, Any]) -> None:
    _write(path, json.dumps(document, indent=2, ensure_ascii=False) + "\n")


def _require_ours(out: Path) -> None:
    if out.is_symlink() or (out.exists() and not out.is_dir()):
        raise DepositError(f"{out}: expected a directory or nothing; nothing was written")
    if not out.exists() or not any(out.iterdir()):
        return
    try:
        listed = {*read_checksums(out), CHECKSUMS}
        foreign = [name for name in contents(out) if name not in listed]
        ours = read_descriptor(out / DESCRIPTOR).get("name") == NAME
    except (FileNotFoundError, FileRefusedError, ValueError):
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
    with suppress(zipfile.BadZipFile, OSError), zipfile.ZipFile(archive) as packed:
        names = packed.namelist()
        if names and all(name.startswith(f"{NAME}-") for name in names):
            return
    raise DepositError(f"{archive}: not the zip of an earlier bundle; nothing was written")
