"""Whether a bundle is what the facts and the published record make, not only whole in itself.

Checksums in a bundle are made by whoever made it. What it says is held against the bundle that this
software builds of its own tables, and its samples against the data sets; nothing is fetched.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

from api.deposit import bundle as building
from api.deposit.bundle import Sources, fill
from api.deposit.code_archive import write_code_as_in
from api.deposit.database import DATABASE
from api.deposit.deposit_tables import measured_tables, read_descriptor
from api.deposit.forms import FOLDER as FORMS
from api.deposit.forms import Problem, unlike, write_other_forms
from api.deposit.frames import FOLDER, sample
from api.deposit.package import DESCRIPTOR
from api.metadata.identity import identity
from benchmark import datasets
from benchmark.contract import SPLITS
from benchmark.datasets.export import ExportError, read_card
from benchmark.datasets.export_verification import verify as verify_export
from benchmark.datasets.pins import Pin, Place
from benchmark.progress import ProgressCallback, silent
from benchmark.results.store import PUBLISHED, Store
from files.atomic import temporary_directory
from files.checksums import contents
from files.reading import FileRefusedError


def differences(
    bundle: Path,
    *,
    survey: Path = building.SURVEY,
    published: Path = PUBLISHED,
    frames: Sequence[str] | None = None,
    anew: bool = True,
    progress: ProgressCallback = silent,
) -> list[Problem]:
    """Say in what a bundle that is whole (`verification.verify`) is not the one built here.

    Parameters
    ----------
    bundle : its directory
    survey, published : tables and results that it is held against
    frames : data sets whose samples it should have; all by default
    anew : make the samples again, which takes minutes; see `export_verification.verify`
    progress : called as ``progress(done, total, what)`` in data sets

    Raises
    ------
    CodeArchiveError, FileNotFoundError, ValueError
        As `bundle.build` of what it is held against.
    """
    who = identity()
    said = read_descriptor(bundle / DESCRIPTOR).get("version")
    if said != who.version:
        return [(DESCRIPTOR, f"of version {said!r}; here is {who.version}: verify it with its own")]
    names = datasets.names() if frames is None else frames
    pins = Store(published).pins()
    wrong = list(_of_frames(bundle, names, pins, anew, progress))
    if wrong:
        return wrong
    with temporary_directory() as temporary:
        made = temporary / "bundle"
        made.mkdir()
        if (bundle / FOLDER).is_dir():
            shutil.copytree(bundle / FOLDER, made / FOLDER)
        write_code_as_in(bundle, made)
        rows = [row for name in names for row in sample(made, name)]
        fill(
            made,
            who,
            Sources(survey, published, measured_tables(published)),
            rows,
            other_forms=partial(_as_in, bundle),
        )
        return list(_unlike(bundle, made))


def _of_frames(
    bundle: Path,
    names: Sequence[str],
    pins: Mapping[Place, Pin],
    anew: bool,
    progress: ProgressCallback,
) -> Iterator[Problem]:
    """Verify the samples of every data set as exports."""
    folder = bundle / FOLDER
    there = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    for name in sorted(there ^ set(names)):
        yield f"{FOLDER}/{name}", "no data set of this bundle" if name in there else "missing"
    for done, name in enumerate(names if there == set(names) else ()):
        progress(done, len(names), name)
        try:
            asked = read_card(folder / name).get("exported")
            conditions = list(datasets.get(name).conditions[:1])
            should = {"conditions": conditions, "splits": list(SPLITS), "first_samples": None}
            if asked != should:
                yield f"{FOLDER}/{name}/card.json", f"exported is {asked}, expected {should}"
            for file, text in verify_export(folder / name, pins=pins, anew=anew):
                yield f"{FOLDER}/{name}/{file}", text
        except (ExportError, FileRefusedError) as error:
            yield f"{FOLDER}/{name}", str(error).removeprefix(f"{folder / name}: ")
    progress(len(names), len(names), "")


def _as_in(bundle: Path, made: Path, descriptor: Mapping[str, Any]) -> None:
    """Write Parquet and SQLite; take the bundle's own where another library packed the same."""
    write_other_forms(made, descriptor)
    for path in [*(made / FORMS).iterdir(), made / DATABASE]:
        theirs = bundle / path.relative_to(made)
        if theirs.is_file() and not unlike(theirs, path):
            shutil.copyfile(theirs, path)


def _unlike(bundle: Path, made: Path) -> Iterator[Problem]:
    """Name each file that differs, and where it does; files of digests last and only alone."""
    there, should = set(contents(bundle)), set(contents(made))
    for name in sorted(there ^ should):
        yield name, "no file of this bundle" if name in there else "missing"
    others = False
    for name in sorted(there & should, key=lambda name: (name in building.OF_DIGESTS, name)):
        one, other = (bundle / name).read_bytes(), (made / name).read_bytes()
        if one == other or (others and name in building.OF_DIGESTS):
            continue
        others = True
        yield name, _where(name, one, other)


def _where(name: str, one: bytes, other: bytes) -> str:
    """Say where a file differs from the one built here."""
    if name.endswith((".parquet", ".sqlite")):
        return "holds other tables than the CSV of this bundle"
    lines = zip_longest(one.split(b"\n"), other.split(b"\n"), fillvalue=b"")
    for number, (deposited, built) in enumerate(lines, start=1):
        if deposited != built:
            said, should = (part.decode("utf-8", "replace")[:80] for part in (deposited, built))
            return f"row {number} is {said!r}; built of facts and record here it is {should!r}"
    return "ends otherwise"
