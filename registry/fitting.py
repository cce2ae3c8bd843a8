"""Which of a plan's pipelines are a study's: its own methods, or the nearest that there are.

A compensation that the study states is a stage of its pipelines: where a chain holds more of them
ahead of the same model, the model alone is left out. One that is stated beside no model that it is
planned ahead of runs ahead of the model of its equation, else ahead of the simplest. One that its
model carries out itself runs with that (`compensated_models.csv`). A model that the study carries
out in a way of its own runs so, where an implementation does (`method_variants.csv`).

The standard projection is run with its constants fitted (`FITTED`), as the survey describes a
geometric calibration (model:geo), but for a study that states that it takes them from its drawing.
What a study only compares is no model of its compensations.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

from registry.catalogue import Catalogue
from registry.fidelity.particulars import DRAWN, MethodVariant
from registry.studies import Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Architecture, Pair, Plan

if TYPE_CHECKING:
    from algorithms.chain import Scored

SIMPLEST: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "model": ("SPM", "Linear", "Basic"),
        "extractor": ("BCM", "PPE", "Voltage balance", "Direct", "ESCM"),
    }
)
"""For "None", and last of what stands in for a method: the plain reading of a spot, of a balance,
of single signals; a plain extractor for each kind of detector and feature."""

KIN: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"Neural network": ("Polynomial",), "LUT": ("Polynomial",)}
)
"""By category of models, what stands in before the simplest: a curve fitted to the same data."""

FITTED: Mapping[str, tuple[str, ...]] = MappingProxyType({"spm": ("pinhole", "lsq")})
"""What runs instead of an implementation that takes its constants from the drawing, where they are
fitted: the first of them that there is behind the same compensations."""

COMPENSATIONS = "Physics-Informed"
"""The category whose models compensate: without them the study's model runs bare."""


@dataclass(frozen=True)
class ChosenMethod:
    """A method by name, the stated values that it runs, and what it stands in for.

    ``replaces`` is a stated value that nothing runs here, or "None" where the study states none;
    empty where the method is the study's own. ``unsaid`` is a value whose kind the study does not
    state, where one of its kinds is run; ``variant`` the study's way to carry the method out that
    this is of, ``other_variant`` one that it is not of.
    """

    name: str
    runs: tuple[str, ...]
    replaces: str = ""
    unsaid: str = ""
    variant: MethodVariant | None = None
    other_variant: MethodVariant | None = None


@dataclass(frozen=True)
class FittedPipeline:
    """A pipeline of the plan that stands for a study's methods, and where it is scored."""

    extractor: ChosenMethod
    model: ChosenMethod
    datasets: tuple[str, ...]
    stages: tuple[str, ...]


class PipelinesOfStudy:
    """The plan's pipelines by a study's methods.

    Names of the plan that the catalogue does not have are passed over. `is_own`: the plan is that
    of one study's own sensor.
    """

    def __init__(
        self, plan: Plan, catalogue: Catalogue, facts: Facts, *, is_own: bool = False
    ) -> None:
        self.catalogue = catalogue
        self.facts = facts
        self.is_own = is_own
        self.plan: Plan = {
            architecture: {
                pair: datasets
                for pair, datasets in pairs.items()
                if pair[0] in catalogue.extractors and pair[1] in catalogue.models
            }
            for architecture, pairs in plan.items()
        }
        self._stages = {name: stages(scored) for name, scored in catalogue.models.items()}

    def on_own(self, plan: Plan | None) -> PipelinesOfStudy:
        """Return the same on the plan of a study's own sensor; itself where there is none."""
        if plan is None:
            return self
        return PipelinesOfStudy(plan, self.catalogue, self.facts, is_own=True)

    def pipelines_by_architecture(
        self, study: Study, architectures: Iterable[Architecture]
    ) -> dict[Architecture, list[FittedPipeline]]:
        """Return the pipelines of a study on each architecture.

        Methods are its own where any fit on one of the architectures. Else one of them is the
        nearest that does: the extractor, for the model is what a calibration is about; then the
        model; then both.
        """
        places = list(dict.fromkeys(architectures))
        for near in ((), ("extractor",), ("model",), ("extractor", "model")):
            found = {place: self._on(study, place, near) for place in places}
            if any(found.values()):
                return found
        return {place: [] for place in places}

    def count_own_methods(self, study: Study, architecture: Architecture) -> int:
        """Return how many of a study's own methods run on an architecture."""
        pairs = self.plan.get(architecture, {})
        extractors = {self.catalogue.extractors[e].about.taxonomy for e, _ in pairs}
        models = {value for _, m in pairs for value in self._stages[m]}
        stated = (v for v in study.of("extractor") if v != NO_IMPLEMENTATION_STATED)
        return sum(v in extractors for v in stated) + sum(
            not models.isdisjoint(self.kinds("model", v)) for v in study.of("model")
        )

    def kinds(self, attribute: str, value: str) -> tuple[str, ...]:
        """Return the values that run for a stated one: itself, and a parent's kinds."""
        return self.catalogue.taxonomy.kinds(attribute, value)

    def _on(self, study: Study, place: Architecture, near: Collection[str]) -> list[FittedPipeline]:
        pairs = self.plan.get(place, {})
        models = self._nearest_models if "model" in near else self._own_models
        found = [] if "model" in near else self._variants(study, pairs)
        return found + self._usual(study, pairs, models, near)

    def _usual(
        self,
        study: Study,
        pairs: Mapping[Pair, Sequence[str]],
        models: Callable[[Study, Sequence[str]], list[ChosenMethod]],
        near: Collection[str],
    ) -> list[FittedPipeline]:
        """Return the pipelines of the first extractors that any model fits."""
        for group in self._extractors(study, near="extractor" in near):
            found = [
                FittedPipeline(
                    *(extractor, model, tuple(pairs[extractor.name, model.name])),
                    self._stages_of(study)[model.name],
                )
                for extractor in group
                for model in models(study, [m for e, m in pairs if e == extractor.name])
            ]
            if found:
                return found
        return []

    def _variants(self, study: Study, pairs: Mapping[Pair, Sequence[str]]) -> list[FittedPipeline]:
        """Return the pipelines that carry out models as the study does."""
        found = []
        for value in study.of("model"):
            variant = self.facts.variant(study.key, value)
            if variant is None:
                continue
            runs = (variant.extractor,) if variant.extractor in study.of("extractor") else ()
            within = self._carried_out(study, value)
            extractors = {one.name for one in self._extractors_of(variant.extractor)}
            found += [
                FittedPipeline(
                    ChosenMethod(extractor, runs, variant=variant),
                    ChosenMethod(model, (value, *within), variant=variant),
                    tuple(datasets),
                    self._stages[model],
                )
                for (extractor, model), datasets in pairs.items()
                if extractor in extractors and self._is_of(model, variant)
            ]
        return found

    def _is_of(self, model: str, variant: MethodVariant) -> bool:
        """Say whether an implementation carries a model out as a study does."""
        about = self.catalogue.models[model].about
        read = {
            self.catalogue.extractors[one.name].about.kind
            for one in self._extractors_of(variant.extractor)
        }
        return (
            self._stages[model] == (variant.runs_as,)
            and variant.context in ("", *about.context)
            and not read.isdisjoint(about.accepts)
        )

    def _carried_out(self, study: Study, model: str) -> tuple[str, ...]:
        """Return the compensations of a study that one of its models carries out itself."""
        within = self.facts.within
        return tuple(v for v in study.of("model") if model in within(study.key, v))

    def _extractors(self, study: Study, *, near: bool) -> list[list[ChosenMethod]]:
        """Return the extractors to try, group after group until one fits."""
        own = [v for v in study.of("extractor") if v != NO_IMPLEMENTATION_STATED]
        if near:
            return [
                self._extractors_of(other, replaces=value)
                for value in own
                for other in self._stand_ins("extractor", value)
                if other not in own
            ]
        stated = [chosen for value in own for chosen in self._extractors_of(value)]
        if len(own) == len(study.of("extractor")):
            return [stated]
        return [stated] * bool(own) + [
            self._extractors_of(simple, replaces=NO_IMPLEMENTATION_STATED)
            for simple in SIMPLEST["extractor"]
            if simple not in own
        ]

    def _extractors_of(self, value: str, replaces: str = "") -> list[ChosenMethod]:
        runs = () if replaces else (value,)
        return [
            ChosenMethod(cls.about.name, runs, replaces)
            for kind in self.kinds("extractor", value)
            for cls in self.catalogue.extractors_for(kind)
        ]

    def _own_models(self, study: Study, planned: Sequence[str]) -> list[ChosenMethod]:
        """Return of what is planned what the study states, with all its compensations that fit."""
        of = {
            kind: value
            for value in study.of("model")
            if value != NO_IMPLEMENTATION_STATED and not self.facts.within(study.key, value)
            for kind in self._kinds_of(study, value)
        }
        known = self._stages_of(study)
        usable = {
            name: known[name]
            for name in planned
            if name in known and all(stage in of for stage in known[name][:-1])
        }
        compared = {v for v in set(of.values()) if study.role("model", v) == "compared"}
        usable = {
            name: own
            for name, own in usable.items()
            if len(own) == 1 or of.get(own[-1]) not in compared
        }
        behind_stated = {
            model for value in set(of.values()) for model in self.facts.behind(study.key, value)
        }
        whole = _with_most_stages(
            {
                n: own
                for n, own in usable.items()
                if own[-1] in of or (len(own) > 1 and own[-1] in behind_stated)
            }
        )
        found = [
            self._chosen_method(study, name, of) for name in whole if not self._repeats(study, name)
        ]
        covered = {stage for own in whole.values() for stage in own}
        behind = {n: own for n, own in usable.items() if own[-1] not in of and len(own) > 1}
        for compensation in (kind for kind in of if kind not in covered):
            ahead = {n: own for n, own in behind.items() if compensation in own[:-1]}
            for name in _with_most_stages(_simplest(ahead)):
                chosen = self._chosen_method(study, name, of, NO_IMPLEMENTATION_STATED)
                if chosen not in found:
                    found.append(chosen)
        if NO_IMPLEMENTATION_STATED in study.of("model") and not found:
            bare = {name: own for name, own in usable.items() if len(own) == 1}
            simplest = [n for n, own in _simplest(bare).items() if own[0] in SIMPLEST["model"]]
            found = [ChosenMethod(name, (), NO_IMPLEMENTATION_STATED) for name in simplest]
        return found

    def _nearest_models(self, study: Study, planned: Sequence[str]) -> list[ChosenMethod]:
        """Return of what is planned what stands nearest to each model of the study.

        A compensation is no model to stand in for where the study states another.
        """
        known = self._stages_of(study)
        bare = {n: known[n] for n in planned if n in known and len(known[n]) == 1}
        of = [v for v in study.of("model") if v != NO_IMPLEMENTATION_STATED]
        category = self.catalogue.taxonomy.category
        models = [v for v in of if category("model", v) != COMPENSATIONS] or of
        found: list[ChosenMethod] = []
        for value in models:
            for other in self._stand_ins("model", value):
                names = [n for n, own in bare.items() if own[0] == other]
                if names:
                    found += [ChosenMethod(name, (), value) for name in names]
                    break
        return found

    def _stand_ins(self, attribute: str, value: str) -> tuple[str, ...]:
        """Return the values that may stand for one, nearest first.

        Those of its category, the simplest of them first; its kin; the simplest of all.
        """
        taxonomy = self.catalogue.taxonomy
        category = taxonomy.category(attribute, value)
        simplest = SIMPLEST[attribute]
        family = [
            v for v in taxonomy.values(attribute) if taxonomy.category(attribute, v) == category
        ]
        if attribute == "model" and category == COMPENSATIONS:
            family = []
        order = (
            *(v for v in simplest if v in family),
            *family,
            *KIN.get(category, ()),
            *simplest,
        )
        return tuple(v for v in dict.fromkeys(order) if v != value)

    def _chosen_method(
        self, study: Study, name: str, of: Mapping[str, str], replaces: str = ""
    ) -> ChosenMethod:
        own = self._stages_of(study)[name]
        run = [of[stage] for stage in own if stage in of]
        unsaid = next((of[s] for s in own if of.get(s, s) != s), "")
        missed = next(filter(None, (self.facts.variant(study.key, value) for value in run)), None)
        if missed and self._is_of(name, missed):
            missed = None
        carried = [v for value in run for v in self._carried_out(study, value)]
        return ChosenMethod(
            name, tuple(dict.fromkeys((*run, *carried))), replaces, unsaid, None, missed
        )

    def _stages_of(self, study: Study) -> Mapping[str, tuple[str, ...]]:
        """Return the stages of models as they run for a study: projections with fitted constants.

        A study of the least-squares model has both, that and what it is a refinement of.
        """
        if "LSQ" in study.of("model") or self.facts.calibration(study.key) == DRAWN:
            return self._stages
        return self._fitted_stages

    @cached_property
    def _fitted_stages(self) -> Mapping[str, tuple[str, ...]]:
        found = dict(self._stages)
        for name, own in self._stages.items():
            ahead, end = name[: -len(name.split(" + ")[-1])], name.split(" + ")[-1]
            fitted = [ahead + form for form in FITTED.get(end, ()) if ahead + form in found]
            if fitted:
                found[fitted[0]] = own
                del found[name]
        return found

    def _kinds_of(self, study: Study, value: str) -> tuple[str, ...]:
        """Return the kinds that run for a model of a study: the one of its variant, if any."""
        kinds = self.kinds("model", value)
        variant = self.facts.variant(study.key, value)
        return (variant.runs_as,) if variant and variant.runs_as in kinds else kinds

    def _repeats(self, study: Study, name: str) -> bool:
        """Say whether a model stands among the study's variants already."""
        variants = (self.facts.variant(study.key, value) for value in study.of("model"))
        return any(self._is_of(name, variant) for variant in variants if variant)


def stages(scored: Scored) -> tuple[str, ...]:
    """Return the taxonomy values of a model's stages: its compensations, and itself last."""
    from algorithms.chain import Chain  # noqa: PLC0415 - loads NumPy

    if isinstance(scored, Chain):
        return tuple(stage.about.taxonomy for stage in scored.stages)
    return (scored.about.taxonomy,)


def _with_most_stages(found: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Leave out what lacks a compensation that another has ahead of the same model."""
    return {
        name: own
        for name, own in found.items()
        if not any(other[-1] == own[-1] and set(other) > set(own) for other in found.values())
    }


def _simplest(found: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Keep what has the simplest model behind; all of it where none is simple."""
    for simple in SIMPLEST["model"]:
        kept = {name: own for name, own in found.items() if own[-1] == simple}
        if kept:
            return kept
    return dict(found)
