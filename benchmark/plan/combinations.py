"""What there is to measure: every compatible dataset, condition, extractor and model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

from algorithms.chain import Scored
from algorithms.contract import Extractor, FeatureKind, UnsuitableDesignError
from benchmark.contract import Cell, UnknownNameError
from benchmark.plan.parts import Parts, installed_parts, study_parts
from registry.taxonomy import Plan

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

Names = str | Iterable[str] | None


@dataclass(frozen=True, order=True)
class Exclusion:
    """A combination that is not measured, with the reason.

    `model` is empty where the extractor alone does not fit the dataset.
    """

    dataset: str
    extractor: str
    model: str
    reason: str


def cells(
    datasets: Names = None,
    conditions: Names = None,
    extractors: Names = None,
    models: Names = None,
    *,
    parts: Parts | None = None,
) -> list[Cell]:
    """Every compatible combination of the named things (None: all), in sorted order.

    A condition is taken from the datasets that have it.
    UnknownNameError for a name that is not installed, naming the nearest.
    """
    chosen = _Choice.of(parts or installed_parts(), datasets, conditions, extractors, models)
    return sorted(
        Cell(preset.name, condition, extractor.about.name, model.about.name)
        for preset in chosen.presets
        for extractor, model in _compatible(preset, chosen)
        for condition in preset.conditions
        if chosen.conditions is None or condition in chosen.conditions
    )


def _compatible(preset: Preset, chosen: _Choice) -> Iterator[tuple[type[Extractor], Scored]]:
    """Give the extractors that fit a dataset with each model that fits them and it."""
    fitting: dict[FeatureKind, list[Scored]] = {}  # models see the kind of feature alone
    for extractor in chosen.extractors:
        if _why_not_extractor(preset, extractor):
            continue
        if extractor.about.kind not in fitting:
            fitting[extractor.about.kind] = [
                model for model in chosen.models if not _why_not_model(preset, extractor, model)
            ]
        yield from ((extractor, model) for model in fitting[extractor.about.kind])


def list_exclusions(
    datasets: Names = None,
    extractors: Names = None,
    models: Names = None,
    *,
    parts: Parts | None = None,
) -> list[Exclusion]:
    """List the combinations `cells` leaves out, each with its reason, in sorted order."""
    chosen = _Choice.of(parts or installed_parts(), datasets, None, extractors, models)
    found = []
    for preset, extractor in product(chosen.presets, chosen.extractors):
        if reason := _why_not_extractor(preset, extractor):
            found.append(Exclusion(preset.name, extractor.about.name, "", reason))
            continue
        found.extend(
            Exclusion(preset.name, extractor.about.name, model.about.name, reason)
            for model in chosen.models
            if (reason := _why_not_model(preset, extractor, model))
        )
    return sorted(found)


def scorable_plan(*, parts: Parts | None = None) -> Plan:
    """Return what can be scored on each architecture: what a study's resolution is made from.

    By (detector, mask) every pipeline that `cells` plans, with the sorted names of its data sets.
    """
    chosen = _Choice.of(parts or installed_parts(), None, None, None, None)
    found: dict[tuple[str, str], dict[tuple[str, str], tuple[str, ...]]] = {}
    for preset in chosen.presets:
        pairs = found.setdefault((preset.detector, preset.mask), {})
        for extractor, model in _compatible(preset, chosen):
            pair = extractor.about.name, model.about.name
            pairs[pair] = (*pairs.get(pair, ()), preset.name)
    return found


def study_plans(*, parts: Parts | None = None) -> dict[str, Plan]:
    """Return by study what can be scored on its own sensor: `scorable_plan` of that alone."""
    known = parts or study_parts()
    found: dict[str, dict[str, Preset]] = {}
    for name, preset in known.presets.items():
        for study in getattr(preset, "follows", ()):
            found.setdefault(study, {})[name] = preset
    return {
        study: scorable_plan(parts=Parts(presets, known.extractors, known.models))
        for study, presets in sorted(found.items())
    }


@dataclass(frozen=True)
class _Choice:
    presets: Sequence[Preset]
    conditions: frozenset[str] | None
    extractors: Sequence[type[Extractor]]
    models: Sequence[Scored]

    @classmethod
    def of(
        cls, parts: Parts, datasets: Names, conditions: Names, extractors: Names, models: Names
    ) -> _Choice:
        presets = [parts.preset(name) for name in _list_items(datasets, parts.presets)]
        wanted = None if conditions is None else frozenset(_list_items(conditions, ()))
        known = {condition for preset in presets for condition in preset.conditions}
        for name in sorted(wanted or ()):
            if name not in known:
                raise UnknownNameError("condition", name, known)
        return cls(
            presets,
            wanted,
            [parts.extractor(name) for name in _list_items(extractors, parts.extractors)],
            [parts.model(name) for name in _list_items(models, parts.models)],
        )


def _list_items(names: Names, everything: Iterable[str]) -> list[str]:
    if names is None:
        return sorted(everything)
    return sorted({names} if isinstance(names, str) else set(names))


def _why_not_extractor(preset: Preset, extractor: type[Extractor]) -> str:
    if extractor.about.observation != preset.observation:
        return f"reads {extractor.about.observation}; the dataset has {preset.observation}"
    return _missing_design(preset, extractor) or _refusal(
        lambda: extractor.for_sensor(preset.geometry)
    )


def _why_not_model(preset: Preset, extractor: type[Extractor], model: Scored) -> str:
    kind, accepts = extractor.about.kind, model.about.accepts
    if kind not in accepts:
        return f"accepts {', '.join(sorted(accepts))}; the extractor gives {kind}"
    if missing := sorted(set(model.about.context) - set(preset.context_columns)):
        return f"reads the context's {', '.join(missing)}; the samples have none"
    return _missing_design(preset, model) or _refusal(
        lambda: model.for_sensor(preset.geometry, kind)
    )


def _missing_design(preset: Preset, implementation: type[Extractor] | Scored) -> str:
    needs = implementation.about.needs
    missing = [name for name in needs if getattr(preset.geometry, name) is None]
    return f"needs {', '.join(missing)}; the sensor has none" if missing else ""


def _refusal(build: Callable[[], object]) -> str:
    """Why an implementation does not fit a design that has all the fields it needs, or empty."""
    try:
        build()
    except UnsuitableDesignError as error:
        return str(error)
    except Exception:  # noqa: BLE001 - a defect: planned, so that its row says what failed
        return ""
    return ""
