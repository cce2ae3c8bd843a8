"""Kinds of files that measuring makes: calibrations, journals, records, exports, bundles."""

from __future__ import annotations

import random
import shutil
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from algorithms.calibration import saving
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.models.non_physical.polynomial import SurfacePolynomial
from algorithms.pipeline import Pipeline
from api.deposit import against_record, bundle
from api.deposit.verification import verify as verify_bundle
from benchmark.claims.ledger import ledger
from benchmark.claims.outcomes import RECORD as CLAIMS
from benchmark.contract import Cell
from benchmark.datasets import export, export_verification
from benchmark.datasets.pins import Pin
from benchmark.experiments.claims import Claims
from benchmark.metrics.score import METRICS
from benchmark.results import record_manifest
from benchmark.results.components import Components
from benchmark.results.journal import Journal
from benchmark.results.record import Record
from benchmark.results.store import PUBLISHED, Store
from benchmark.running.experiment import list_due, repeat_at_random
from files import manifest
from tools.faults.forging import forged_export
from tools.faults.forging_bundles import forged_bundle
from tools.faults.kind import OTHERS, Kind, RefusedError
from tools.faults.kinds import _read_files

TORN = (
    "ends sooner, as after a kill: nobody can tell the two apart, and what is not there is "
    "measured again"
)
#: Claims whose trials take a tenth of a second each.
_CLAIM = "C05"
_DATASET = "pd-slit"


def _calibration(folder: Path) -> list[Path]:
    draw = np.random.default_rng(1)
    sun = np.column_stack([draw.uniform(-0.5, 0.5, (200, 2)), np.ones(200)])
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    spots = 200.0 + 180.0 * sun[:, :2] / sun[:, 2:]
    pipeline = Pipeline(BasicCentroid(), SurfacePolynomial()).fit_features(spots, sun)
    saving.save(pipeline, folder / "calibration.json")
    return [folder / "calibration.json"]


def _read_calibration(folder: Path) -> Any:
    return saving.document(saving.load(folder / "calibration.json"))


def _journal(folder: Path) -> list[Path]:
    record = Record(Store(folder))
    sensor = {"version": 1, "detector": "PD", "mask": "Slit", "half_fov_deg": 30.0}
    sensor["conditions"] = {"c": "d"}
    known = Components(
        {"data": "h"},
        datasets={"d": sensor},
        extractors={"e": {"version": 1, "taxonomy": "BCM", "digest": "e"}},
        models={f"m{k}": {"version": 1, "taxonomy": "LSQ", "digest": f"m{k}"} for k in range(8)},
    )
    record.keep(known, pins=[Pin("d", "c", "test", 1, 9, "h", "hh", 9, 0.25, 0.2)])
    for k in range(8):
        row = {"status": "ok", **dict.fromkeys(METRICS), "rms_deg": 0.1 * k, "reason": ""}
        record.keep(known, scores={Cell("d", "c", "e", f"m{k}", 0): row})
    return [record.journal]


def _read_journal(folder: Path) -> Any:
    record = Record(Store(folder))
    return Journal(record.journal).read()


def _is_start(result: Any, reference: Any) -> bool:
    return bool(result == reference[: len(result)])


_SMALL = (
    *("pins.csv", "components.json", "curves.json", "claims.json", "error_budget.json"),
    "sweeps.json",
)


@cache
def _small_record(folder: Path) -> Path:
    """A record of one data set, as a runner older than manifests left it."""
    (folder / "scores").mkdir(parents=True)
    for name in (*_SMALL, f"scores/{_DATASET}.csv"):
        shutil.copy(PUBLISHED / name, folder / name)
    swept = (PUBLISHED / "sweeps.csv").read_text().splitlines(keepends=True)
    (folder / "sweeps.csv").write_text("".join(swept[:60]))
    return folder


def _unguarded(folder: Path) -> list[Path]:
    _small_record(folder)
    return sorted(path for path in folder.rglob("*") if path.is_file())


def _read_unguarded(folder: Path) -> Any:
    ledger(folder)
    return _read_files(folder)


def _export(folder: Path) -> list[Path]:
    export.export(_DATASET, folder / "out", conditions=["nominal"], n=6, pins=Store().pins())
    return sorted(path for path in (folder / "out").rglob("*") if path.is_file())


def _verify(folder: Path) -> Any:
    if wrong := export_verification.verify(folder / "out", pins=Store().pins()):
        raise RefusedError(": ".join(wrong[0]))
    return []


def _forged_export(rng: random.Random, folder: Path) -> str:
    return forged_export(rng, folder / "out")


def _bundle(folder: Path) -> list[Path]:
    record = _small_record(folder.parent / "record of the bundle")
    bundle.build(folder / "bundle", published=record, frames=(_DATASET,))
    _built_tables(record)  # once, for all processes
    return sorted(path for path in (folder / "bundle").rglob("*") if path.is_file())


@cache
def _built_tables(record: Path) -> Any:
    return against_record.measured_tables(record)


def _read_bundle(folder: Path) -> Any:
    record = folder.parent / "record of the bundle"
    tables = _built_tables(record)
    against_record.measured_tables = lambda _published: tables  # type: ignore[assignment]
    wrong = verify_bundle(folder / "bundle") or against_record.differences(
        folder / "bundle", published=record, frames=(_DATASET,)
    )
    if wrong:
        raise RefusedError(": ".join(wrong[0]))
    return []


def _forged_bundle(rng: random.Random, folder: Path) -> str:
    return forged_bundle(rng, folder / "bundle")


def _outcome(folder: Path) -> list[Path]:
    CLAIMS.write({_CLAIM: CLAIMS.read()[_CLAIM]}, folder)
    manifest.rewrite_manifest(folder, record_manifest.names(folder))
    return [folder / CLAIMS.name]


def _read_outcome(folder: Path) -> Any:
    record_manifest.require_unchanged(folder, required=True)
    experiment = Claims(folder)
    if reason := dict(list_due(experiment)).get(_CLAIM):
        raise RefusedError(f"{CLAIMS.name}: {_CLAIM}: {reason}")
    for cell, text in repeat_at_random(experiment, 1, 0):
        raise RefusedError(f"{CLAIMS.name}: {cell}: {text}")
    return []


def _forged_outcome(rng: random.Random, folder: Path) -> str:
    """Change a number, a name or a digest of an outcome, and its manifest with it."""
    rows = CLAIMS.read(folder)
    document = rows[_CLAIM]
    what = rng.choice(["values", "values", "values", "lines", "lines", "code", "plan", "name"])
    plan, code = document["key"].split()
    if what == "code":
        document["key"] = f"{plan} {'0' * 32}"
    elif what == "plan":
        document["key"] = f"{'0' * 32} {code}"
    elif what == "name":
        held = document[rng.choice(["values", "lines"])]
        key = rng.choice(list(held))
        held[f"{key} forged"] = held.pop(key)
    elif what == "values":
        numbers = rng.choice(list(document["values"].values()))
        numbers[rng.randrange(len(numbers))] *= rng.choice([1.001, -1, 1000])
    else:
        line = rng.choice(list(document["lines"].values()))
        part = line[rng.choice(["median", "low", "high"])]
        at = rng.choice([k for k, value in enumerate(part) if value])
        part[at] *= rng.choice([1.001, 2.0])
    CLAIMS.write(rows, folder)
    manifest.rewrite_manifest(folder, record_manifest.names(folder))
    return f"forged: {what}"


MEASURED = (
    Kind("saved calibration", 7, _calibration, _read_calibration),
    Kind("journal of a run", 6, _journal, _read_journal, TORN, _is_start),
    Kind("record without a manifest", 8, _unguarded, _read_unguarded, OTHERS),
    Kind("export of a data set", 7, _export, _verify),
    Kind("export, forged with all its digests", 8, _export, _verify, forge=_forged_export),
    Kind("bundle", 4, _bundle, _read_bundle),
    Kind("bundle, forged with all its digests", 4, _bundle, _read_bundle, forge=_forged_bundle),
    Kind(
        "claim's outcome, forged with its digests",
        4,
        *(_outcome, _read_outcome),
        forge=_forged_outcome,
    ),
)
