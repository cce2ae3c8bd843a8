"""What results are made of: data sets, extractors, models, harness; facts and digests.

A stored number belongs to the components as they were when it was measured. One small file holds
a line for each, so that a change of one component is a change of one line, and tells which of the
numbers are out of date.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmark.contract import Cell, Preset
from benchmark.metrics.score import METRIC_VERSION
from benchmark.plan.parts import Parts
from benchmark.results.analyses import Analyses
from benchmark.results.closure import Sources
from benchmark.results.digests import dataset_digest, harness_digest, method_digest
from files.reading import FileRefusedError
from files.strict_json import read_json, require_members, require_type

#: Layout of the stored files; raised when a field changes its meaning.
SCHEMA_VERSION = 2

#: What a cell's key is made of, in order.
KEYED = ("harness", "dataset", "extractor", "model")

Facts = Mapping[str, Any]
_KINDS = ("datasets", "extractors", "models")


class ComponentsError(ValueError):
    """The file of components cannot be read, or lacks one that a result names."""


@dataclass(frozen=True)
class Components:
    """Facts by name; each has the ``digest`` of its code and parameters.

    Attributes
    ----------
    harness
        Digest of the code between data and numbers.
    datasets
        With version, detector, mask and half field of view.
    extractors, models
        With version and value of the taxonomy.
    metric
        Version of the metric that the numbers are by.
    """

    harness: str = ""
    datasets: Mapping[str, Facts] = field(default_factory=dict)
    extractors: Mapping[str, Facts] = field(default_factory=dict)
    models: Mapping[str, Facts] = field(default_factory=dict)
    metric: int = METRIC_VERSION

    def cell_key(self, cell: Cell) -> str:
        """Everything a cell's numbers depend on, in one word; ComponentsError naming what lacks."""
        return "-".join(
            (
                self.harness,
                self.digest("datasets", cell.dataset),
                self.digest("extractors", cell.extractor),
                self.digest("models", cell.model),
            )
        )

    def changed(self, key: str, cell: Cell) -> tuple[str, ...]:
        """Return which of `KEYED` are not as in a key that the cell had (`cell_key`)."""
        before, now = (one.split("-") for one in (key, self.cell_key(cell)))
        if len(before) != len(KEYED):  # of no layout that is known
            return KEYED
        return tuple(name for name, one, two in zip(KEYED, before, now, strict=True) if one != two)

    def digest(self, kind: str, name: str) -> str:
        """Return the digest of a component; ComponentsError where there is none."""
        found: Mapping[str, Facts] = getattr(self, kind)
        if name not in found:
            raise ComponentsError(f"a result names {name!r}, which is not among the {kind}")
        return str(found[name]["digest"])

    def update(self, other: Components) -> Components:
        """Return these with what `other` has in their place."""
        kinds = {kind: {**getattr(self, kind), **getattr(other, kind)} for kind in _KINDS}
        return Components(other.harness, **kinds, metric=other.metric)

    def only(self, cells: Iterable[Cell]) -> Components:
        """Return what these cells are of."""
        wanted = list(cells)
        return Components(
            self.harness,
            datasets=_name_of(self.datasets, (cell.dataset for cell in wanted)),
            extractors=_name_of(self.extractors, (cell.extractor for cell in wanted)),
            models=_name_of(self.models, (cell.model for cell in wanted)),
            metric=self.metric,
        )

    def differences(self, other: Components) -> list[tuple[str, str, str]]:
        """Return (component, digest here, digest there) of what is not alike; empty for none."""
        here, there = self.harness, other.harness
        found = [] if here == there else [("harness", here, there)]
        for kind in _KINDS:
            ours, theirs = getattr(self, kind), getattr(other, kind)
            for name in sorted(ours.keys() | theirs.keys()):
                one, two = (known.get(name, {}).get("digest", "") for known in (ours, theirs))
                if one != two:
                    found.append((f"{kind}/{name}", one, two))
        return found

    def text(self) -> str:
        """Spell these as the file has it: a line a component, sorted."""
        lines = [
            f'"schema": {SCHEMA_VERSION}',
            f'"metric": {self.metric}',
            f'"harness": {json.dumps(self.harness)}',
        ]
        for kind in _KINDS:
            facts = sorted(getattr(self, kind).items())
            listed = ",\n".join(f"{json.dumps(name)}: {_format_value(one)}" for name, one in facts)
            lines.append(f'"{kind}": {{\n{listed}\n}}' if listed else f'"{kind}": {{}}')
        return "{\n" + ",\n".join(lines) + "\n}\n"

    @classmethod
    def read(cls, path: Path) -> Components:
        """Return what a file holds; none where there is no file.

        Raises
        ------
        ComponentsError
            For another layout, or another metric than this one.
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
            layout = {"schema": int, "metric": int, "harness": str, **dict.fromkeys(_KINDS, dict)}
            require_members(held, path, layout)
            kinds: dict[str, Any] = {kind: held[kind] for kind in _KINDS}
            for kind, facts in kinds.items():
                for name, one in facts.items():
                    _require_facts(path, kind, name, one)
        except FileRefusedError as error:
            raise ComponentsError(str(error)) from error
        return cls(harness=held["harness"], **kinds, metric=metric)


def current(parts: Parts) -> Components:
    """Return the components as the code is now.

    Parameters
    ----------
    parts
        Data sets and implementations.
    """
    sources = Sources()
    found = Components(
        harness=harness_digest(sources),
        datasets={name: _of_dataset(one, sources) for name, one in parts.presets.items()},
        extractors={name: _of_method(one, sources) for name, one in parts.extractors.items()},
        models={name: _of_method(one, sources) for name, one in parts.models.items()},
    )
    Analyses.shared().keep()
    return found


#: What the file says of a component of each kind.
_MEMBERS: Mapping[str, Mapping[str, type | tuple[type, ...]]] = {
    "datasets": {
        "version": int,
        "detector": str,
        "mask": str,
        "half_fov_deg": (int, float, type(None)),
        "digest": str,
    },
    "extractors": {"version": int, "taxonomy": str, "digest": str},
    "models": {"version": int, "taxonomy": str, "digest": str},
}


def _require_facts(path: Path, kind: str, name: str, facts: Any) -> None:
    """Raise FileRefusedError, naming the component, for facts that are not of its kind."""
    require_type(facts, dict, path, f"{kind}/{name}")
    expected = _MEMBERS[kind]
    for member, types in expected.items():
        if member not in facts:
            raise FileRefusedError(path, f"{kind}/{name}: the member {member!r} is missing")
        require_type(facts[member], types, path, f"{kind}/{name}/{member}")
    if unknown := sorted(facts.keys() - expected.keys()):
        raise FileRefusedError(path, f"{kind}/{name}: unknown member {unknown[0]!r}")


def _of_dataset(preset: Preset, sources: Sources) -> Facts:
    return {
        "version": preset.version,
        "detector": preset.detector,
        "mask": preset.mask,
        "half_fov_deg": preset.geometry.half_fov_deg,
        "digest": dataset_digest(preset, sources),
    }


def _of_method(method: Any, sources: Sources) -> Facts:
    return {
        "version": method.about.version,
        "taxonomy": method.about.taxonomy,
        "digest": method_digest(method, sources),
    }


def _name_of(facts: Mapping[str, Facts], names: Iterable[str]) -> dict[str, Facts]:
    wanted = set(names)
    return {name: known for name, known in facts.items() if name in wanted}


def _format_value(facts: Facts) -> str:
    return json.dumps(facts, sort_keys=False, ensure_ascii=False, allow_nan=False)
