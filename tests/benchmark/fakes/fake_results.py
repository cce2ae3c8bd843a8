"""Rows, pins and components as a store holds them, with numbers made up."""

from __future__ import annotations

from typing import Any

from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.metrics.score import METRICS
from benchmark.results.components import Components
from benchmark.results.modules import STAGES


def numbers(rms: float | None = 0.5, **more: Any) -> dict[str, Any]:
    """Return a score: nothing but an error and full availability."""
    plain = {
        **dict.fromkeys(METRICS),
        "rms_deg": rms,
        "rms_all_answers_deg": rms,
        "availability": 1.0,
    }
    return {"status": "ok", **plain, "reason": "", **more}


def cell(model: str = "m", dataset: str = "d", condition: str = "c", unit: int = 0) -> Cell:
    return Cell(dataset, condition, "e", model, unit)


def pin(split: str = "test", **more: Any) -> Pin:
    base: dict[str, Any] = {
        "dataset": "d", "condition": "c", "split": split, "version": 1, "n": 3,
        "data_hash": "h", "head_hash": "hh",
    }  # fmt: skip
    if split == "test":
        base |= {"observable": 2, "bound_deg": 0.25, "head_bound_deg": 0.2}
    return Pin(**{**base, **more})


def components(**digests: str) -> Components:
    """Return what `cell` and `pin` name; keywords give other digests by name, of stages too."""

    def facts(name: str, **more: Any) -> dict[str, Any]:
        return {"version": 1, **more, "digest": digest(name)}

    def digest(name: str) -> str:
        return digests.get(name, f"of {name}")

    def dataset(name: str) -> dict[str, Any]:
        conditions = {one: digest(name) + one for one in ("c", "c2", "other")}
        return {"version": 1, **sensor, "conditions": conditions}

    sensor: dict[str, Any] = {"detector": "PD", "mask": "Slit", "half_fov_deg": 30.0}
    return Components(
        {stage: digest(stage) for stage in STAGES},
        datasets={name: dataset(name) for name in ("c", "d", "other")},
        extractors={"e": facts("e", taxonomy="BCM")},
        models={name: facts(name, taxonomy="LSQ") for name in ("a", "b", "m", "z")},
        modules={"package.module": digest("module")},
    )


def copied(source, target):
    """Copy a record without the files of a run; return where it is."""
    for path in source.rglob("*.*"):
        if path.is_file() and ".sunatlas" not in path.parts:
            (target / path.relative_to(source)).parent.mkdir(parents=True, exist_ok=True)
            (target / path.relative_to(source)).write_bytes(path.read_bytes())
    return target
