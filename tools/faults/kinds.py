"""Kinds of files that people write or keep: facts, record, tables to import, bibliographies."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import survey_data
from benchmark.results import record_manifest, times
from benchmark.results.store import PUBLISHED, Store
from benchmark.running.experiment import RecordedExperiment, experiments
from survey_data import facts_manifest
from survey_data.descriptor import DATA_DIRECTORY
from tools.faults.kind import OFFERED, OTHERS, OWN, Kind, RefusedError


def _facts(folder: Path) -> list[Path]:
    names = (*facts_manifest.names(), "manifest.json")
    for name in names:
        (folder / name).parent.mkdir(exist_ok=True)
    return [Path(shutil.copyfile(DATA_DIRECTORY / name, folder / name)) for name in names]


def _read_facts(folder: Path) -> Any:
    problems = facts_manifest.changes(folder)
    if not (folder / "manifest.json").is_file():  # as for our own, which must have one
        raise RefusedError("manifest.json: the file is missing")
    if problems:
        raise RefusedError(str(problems[0]))
    tables = survey_data.load(folder)
    return {name: frame.to_csv() for name, frame in vars(tables).items()}


def _unguarded(folder: Path) -> Any:
    """Read tables without a manifest, as `survey check --data` does of others' tables."""
    if problems := survey_data.validate(folder):
        raise RefusedError(str(problems[0]))
    return {name: frame.to_csv() for name, frame in vars(survey_data.load(folder)).items()}


def _tables(folder: Path) -> list[Path]:
    return [path for path in _facts(folder) if path.name != "manifest.json" or path.unlink()]


def _record(folder: Path) -> list[Path]:
    shutil.copytree(PUBLISHED, folder, dirs_exist_ok=True)
    return sorted(path for path in folder.rglob("*") if path.is_file())


def _read_record(folder: Path) -> Any:
    record_manifest.require_unchanged(folder, required=True)
    return _read_files(folder)


def _read_files(folder: Path) -> Any:
    store = Store(folder)
    records = [
        kind.record for kind in experiments().values() if issubclass(kind, RecordedExperiment)
    ]
    kept = [record.read(folder) for record in records]
    return repr((store.rows(None), store.pins(), kept))


_OFFERED = (
    "Key,Title,Mask,Detector,Accuracy (deg),FOV\n"
    "Alvi2014,,Slit,CMOS,0.5,120\nBao2020,,V-Slit,CCD,0.01,60\nChang2008,,Lens,CMOS,0.1,90\n"
)


def _offered(folder: Path) -> list[Path]:
    (folder / "theirs.csv").write_text(_OFFERED)
    return [folder / "theirs.csv"]


def _workbook(folder: Path) -> list[Path]:
    from openpyxl import Workbook

    book = Workbook()
    for line in _OFFERED.splitlines():
        book.active.append([float(c) if c[:1].isdigit() else c for c in line.split(",")])
    book.save(folder / "theirs.xlsx")
    return [folder / "theirs.xlsx"]


def _plan(folder: Path, name: str) -> Any:
    plan = survey_data.import_table(folder / name)
    if plan.errors:
        raise RefusedError(str(plan.errors[0]))
    return plan.to_dict()


_BIBLIOGRAPHY = "".join(
    f"@article{{{key},\n title = {{Sun sensor {key}}},\n author = {{One, A. and Two, B.}},\n"
    f" year = {{{key[-4:]}}},\n journal = {{Sensors}},\n doi = {{10.1000/{key}}}\n}}\n"
    for key in ("Alvi2014", "Bao2020", "Chang2008")
)


def _bibliography(folder: Path) -> list[Path]:
    (folder / "survey.bib").write_text(_BIBLIOGRAPHY)
    return [folder / "survey.bib"]


def _read_bibliography(folder: Path) -> Any:
    return survey_data.import_bibliography(folder / "survey.bib").to_dict()


def _times(folder: Path) -> list[Path]:
    rows = [f"pd-slit,{name},lsq,3.5,0.7" for name in ("bcm", "voltage-balance", "peak")]
    (folder / times.TIMES).write_text("\n".join([",".join(times.COLUMNS), *rows, ""]))
    shutil.copy(PUBLISHED / times.MACHINE, folder)
    return [folder / times.TIMES, folder / times.MACHINE]


def _named(name: str) -> Callable[[Path], Any]:
    return lambda folder: _plan(folder, name)


GIVEN = (
    Kind("facts, with their manifest", 11, _facts, _read_facts),
    Kind("survey tables of others (`survey check --data`)", 8, _tables, _unguarded, OTHERS),
    Kind("published record, with its manifest", 11, _record, _read_record),
    Kind("table to import, CSV", 8, _offered, _named("theirs.csv"), OFFERED),
    Kind("table to import, XLSX", 9, _workbook, _named("theirs.xlsx"), OFFERED),
    Kind("bibliography", 3, _bibliography, _read_bibliography, OFFERED),
    Kind("running times", 2, _times, times.read_times, OWN),
)
