"""What results are made of: data sets, extractors, models, code of stages; facts and digests.

A stored number belongs to the components as they were when it was measured. One small file holds
a line for each, so that a change of one component is a change of one line, and tells which of the
numbers are out of date.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, Field

from benchmark.contract import ON_BENCH, Cell
from benchmark.metrics.score import METRIC_VERSION
from benchmark.plan.parts import Parts
from benchmark.results.digests import (
    DIGITS,
    condition_digests,
    method_digest,
    method_modules,
    modules_of_preset,
    stage_digests,
)
from benchmark.results.modules import STAGES, reached
from files.reading import FileRefusedError, read_json, require_type

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

#: Layout of the stored files; raised when a field changes its meaning.
SCHEMA_VERSION = 3

#: What a cell's key is made of, in order, with the stage that is the first to depend on it.
KEYED: Mapping[str, str] = {
    "code of data": "data",
    "dataset": "data",
    "code of features": "features",
    "extractor": "features",
    "code of predictions": "predictions",
    "model": "predictions",
    "code of scores": "scores",
}

Facts = Mapping[str, Any]
_KINDS = ("datasets", "extractors", "models")


class ComponentsError(ValueError):
    """The file of components cannot be read, or lacks one that a result names."""


@dataclass(frozen=True)
class Components:
    """Facts by name, with digests of code and parameters.

    Attributes
    ----------
    stages
        Digest of the code that makes each stage (`benchmark.results.modules.STAGES`) of data,
        extractors and models.
    datasets
        With version, detector, mask, half field of view, and a digest of each condition.
    extractors, models
        With version and value of the taxonomy.
    modules
        Digests of all modules that these import: which of them is why a component has changed.
    metric
        Version of the metric that the numbers are by.
    """

    stages: Mapping[str, str] = field(default_factory=dict)
    datasets: Mapping[str, Facts] = field(default_factory=dict)
    extractors: Mapping[str, Facts] = field(default_factory=dict)
    models: Mapping[str, Facts] = field(default_factory=dict)
    modules: Mapping[str, str] = field(default_factory=dict)
    metric: int = METRIC_VERSION

    def cell_key(self, cell: Cell) -> str:
        """Everything a cell's numbers depend on, in one word; ComponentsError naming what lacks."""
        return self.stage_key("scores", cell)

    def stage_key(self, stage: str, cell: Cell) -> str:
        """Everything a stage of a cell depends on, in one word: a beginning of `cell_key`.

        What the stages before know nothing of, extractor and model, may be of any name.
        """
        key = [self.stages.get("data", ""), self.condition_digest(cell.dataset, cell.condition)]
        if stage != "data":
            key += self.stages.get("features", ""), self.digest("extractors", cell.extractor)
        if stage in ("predictions", "scores"):
            key += self.stages.get("predictions", ""), self.digest("models", cell.model)
        if stage == "scores":
            key.append(self.stages.get("scores", ""))
        return "-".join(key)

    def pin_key(self, dataset: str, condition: str) -> str:
        """Everything that data under a condition depend on, in one word."""
        return self.stage_key("data", Cell(dataset, condition, "", ""))

    def changed_parts(self, key: str, cell: Cell) -> tuple[str, ...]:
        """Return which of `KEYED` are not as in a key that the cell had (`cell_key`)."""
        before, now = (one.split("-") for one in (key, self.cell_key(cell)))
        if len(before) != len(KEYED):  # of no layout that is known
            return tuple(KEYED)
        return tuple(name for name, one, two in zip(KEYED, before, now, strict=True) if one != two)

    def digest(self, kind: str, name: str) -> str:
        """Return the digest of a component, of a data set those of all its conditions.

        ComponentsError where there is none.
        """
        facts = self._facts(kind, name)
        return str(
            facts["digest"] if kind != "datasets" else " ".join(facts["conditions"].values())
        )

    def condition_digest(self, dataset: str, condition: str) -> str:
        """Return the digest of a data set under a condition; empty under one that it has not."""
        digests: Mapping[str, str] = self._facts("datasets", dataset)["conditions"]
        return digests.get(self.condition_read(dataset, condition), "")

    def condition_read(self, dataset: str, condition: str) -> str:
        """Return whose readings a condition is about: the first one's on drawn benches, or for "".

        Raises as `condition_digest`.
        """
        if condition not in ("", ON_BENCH):
            return condition
        return next(iter(self._facts("datasets", dataset)["conditions"]), "")

    def _facts(self, kind: str, name: str) -> Facts:
        found: Mapping[str, Facts] = getattr(self, kind)
        if name not in found:
            raise ComponentsError(f"a result names {name!r}, which is not among the {kind}")
        return found[name]

    def update(self, other: Components) -> Components:
        """Return these with what `other` has in their place."""
        kinds = {kind: {**getattr(self, kind), **getattr(other, kind)} for kind in _KINDS}
        modules = {**self.modules, **other.modules}
        return Components(other.stages, **kinds, modules=modules, metric=other.metric)

    def only(self, cells: Iterable[Cell]) -> Components:
        """Return what these cells are of."""
        wanted = list(cells)
        return Components(
            self.stages,
            datasets=_name_of(self.datasets, (cell.dataset for cell in wanted)),
            extractors=_name_of(self.extractors, (cell.extractor for cell in wanted)),
            models=_name_of(self.models, (cell.model for cell in wanted)),
            modules=self.modules,
            metric=self.metric,
        )

    def changed_modules(self, before: Components) -> list[str]:
        """List the modules of these that are new, or other than before."""
        return [name for name, digest in self.modules.items() if before.modules.get(name) != digest]

    def differences(self, other: Components) -> list[tuple[str, str, str]]:
        """Return (component, digest here, digest there) of what is not alike; empty for none."""
        here, there = self._digests(), other._digests()
        return [
            (name, one, two)
            for name in dict.fromkeys((*here, *sorted(there.keys() - here.keys())))
            if (one := here.get(name, "")) != (two := there.get(name, ""))
        ]

    def _digests(self) -> dict[str, str]:
        found = {f"stages/{name}": digest for name, digest in self.stages.items()}
        found |= {f"modules/{name}": digest for name, digest in self.modules.items()}
        for name, facts in sorted(self.datasets.items()):
            for condition, digest in facts["conditions"].items():
                found[f"datasets/{name}/{condition}"] = digest
        for kind in ("extractors", "models"):
            known: Mapping[str, Facts] = getattr(self, kind)
            found.update((f"{kind}/{name}", known[name]["digest"]) for name in sorted(known))
        return found

    def text(self) -> str:
        """Spell these as the file has it: a line a component, sorted."""
        lines = [
            f'"schema": {SCHEMA_VERSION}',
            f'"metric": {self.metric}',
        ]
        for kind in ("stages", *_KINDS, "modules"):
            facts = [(name, getattr(self, kind)[name]) for name in _in_order(getattr(self, kind))]
            listed = ",\n".join(f"{json.dumps(name)}: {_format_value(one)}" for name, one in facts)
            lines.append(f'"{kind}": {{\n{listed}\n}}' if listed else f'"{kind}": {{}}')
        return "{\n" + ",\n".join(lines) + "\n}\n"

    @classmethod
    def read(cls, path: Path) -> Components:
        """Return what a file holds; none where there is no file.

        ComponentsError for another layout, or another metric than this one.
        """
        try:
            held = read_json(path)
        except FileNotFoundError:
            return cls()
        except FileRefusedError as error:
            raise ComponentsError(str(error)) from error
        metric = held.get("metric") if isinstance(held, dict) else None
        if (
            not isinstance(held, dict)
            or held.get("schema") != SCHEMA_VERSION
            or isinstance(metric, bool)
            or metric != METRIC_VERSION
        ):
            raise ComponentsError(
                f"{path}: expected schema {SCHEMA_VERSION} and metric {METRIC_VERSION}; delete "
                "the directory and run `sunatlas leaderboard update`"
            )
        try:
            require_type(held, _File, path)
        except FileRefusedError as error:
            raise ComponentsError(str(error)) from error
        kinds = {kind: held[kind] for kind in _KINDS}
        return cls(held["stages"], **kinds, modules=held.get("modules", {}), metric=metric)


def current(parts: Parts) -> Components:
    """Return the components as the code is now."""
    methods = (*parts.extractors.values(), *parts.models.values())
    made_of = {module for preset in parts.presets.values() for module in modules_of_preset(preset)}
    made_of.update(module for method in methods for module in method_modules(method))
    modules = reached(*STAGES.values(), *sorted(made_of))
    return Components(
        stages=stage_digests(),
        datasets={name: _of_dataset(one) for name, one in parts.presets.items()},
        extractors={name: _of_method(one) for name, one in parts.extractors.items()},
        models={name: _of_method(one) for name, one in parts.models.items()},
        modules={name: digest[:DIGITS] for name, digest in modules.items()},
    )


class _DataSet(BaseModel, extra="forbid"):
    version: int
    detector: str
    mask: str
    half_fov_deg: float | None
    conditions: dict[str, str]


class _Method(BaseModel, extra="forbid"):
    version: int
    taxonomy: str
    digest: str


class _File(BaseModel, extra="forbid"):
    layout: int = Field(alias="schema")
    metric: int
    stages: dict[str, str]
    datasets: dict[str, _DataSet]
    extractors: dict[str, _Method]
    models: dict[str, _Method]
    modules: dict[str, str] = {}  # stores written before 0.2.0 have none


def _of_dataset(preset: Preset) -> Facts:
    return {
        "version": preset.version,
        "detector": preset.detector,
        "mask": preset.mask,
        "half_fov_deg": preset.geometry.half_fov_deg,
        "conditions": condition_digests(preset),
    }


def _of_method(method: Any) -> Facts:
    return {
        "version": method.about.version,
        "taxonomy": method.about.taxonomy,
        "digest": method_digest(method),
    }


def _name_of(facts: Mapping[str, Facts], names: Iterable[str]) -> dict[str, Facts]:
    wanted = set(names)
    return {name: known for name, known in facts.items() if name in wanted}


def _in_order(known: Mapping[str, Any]) -> list[str]:
    """List names sorted, but stages as they follow each other."""
    return sorted(
        known, key=lambda name: (list(STAGES).index(name) if name in STAGES else -1, name)
    )


def _format_value(value: Facts | str) -> str:
    return json.dumps(value, sort_keys=False, ensure_ascii=False, allow_nan=False)
