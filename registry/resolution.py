"""From a study to what can be run of it: its pipelines, and a reason for everything that cannot.

What is decided here, because the mapping does not say it:

- The mapping gives a study's values, not which belong together; every combination of them that
  fits is a pipeline. A value that fits nowhere is a gap, a combination that does not fit is not.
- A compensation (OCM, SECM, ICM ...) runs ahead of the models that the study states beside it, else
  ahead of the simplest one, and then the pipeline says so in ``assumed``.
- A parent value (ECM, ICM: kind not stated) runs as each implemented kind.
- "None" (the survey maps no model, or no extractor) is no gap: the study is run with the simplest
  implementation that fits, `SIMPLEST_MODELS` or `SIMPLEST_EXTRACTORS`.
- In both cases the pipeline says so in ``assumed``: its score is not the study's own method.
- An empty cell is a gap and nothing is assumed for it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from registry import catalogue as implementations
from registry import studies as registered
from registry.catalogue import Catalogue
from registry.studies import Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED

if TYPE_CHECKING:
    from algorithms.chain import Scored
    from algorithms.contract import Extractor

State = Literal["complete", "partial", "none"]
Architecture = tuple[str, str]  # (detector, mask)

ESSENTIAL = ("detector", "mask", "extractor", "model")

READOUTS: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "PD": frozenset({"currents"}),
        "QPD": frozenset({"currents"}),
        "PSD": frozenset({"currents"}),
        "OI": frozenset({"currents"}),
        "LTF": frozenset({"currents"}),
        "PVA": frozenset({"currents"}),
        "PDA": frozenset({"currents", "profiles", "frames"}),
        "CCD": frozenset({"profiles", "frames"}),
        "CMOS": frozenset({"profiles", "frames"}),
        "Event": frozenset({"events"}),
    }
)
"""What each detector of the taxonomy gives an extractor to read (`Observation` values)."""

SIMPLEST_MODELS = ("SPM", "Linear", "Basic")
"""For model "None": the plain reading of a spot, of a balance, of single signals."""

SIMPLEST_EXTRACTORS = ("BCM", "PPE", "Voltage balance", "Direct", "ESCM")
"""For extractor "None": a plain one for each kind of detector and feature."""


@dataclass(frozen=True)
class RunnablePipeline:
    """An extractor and a model, by name, on one of the study's architectures.

    ``assumed`` maps an attribute to what the study states for it where that is not what runs:
    "None", or a parent whose kind is not stated.
    """

    detector: str
    mask: str
    extractor: str
    model: str
    extractor_taxonomy: str
    model_taxonomy: str
    assumed: Mapping[str, str] = field(default_factory=dict, hash=False)

    def to_dict(self) -> dict[str, object]:
        """As in the HTTP answer, without the datasets, which the registry does not know."""
        return {
            "detector": self.detector,
            "mask": self.mask,
            "extractor": self.extractor,
            "model": self.model,
            "extractor_taxonomy": self.extractor_taxonomy,
            "model_taxonomy": self.model_taxonomy,
            "assumed": dict(self.assumed),
        }


@dataclass(frozen=True)
class Gap:
    """Something of a study that cannot be run, and why.

    ``attribute`` is one of the study's (value "" if its cell is empty), or "architecture" with
    the value "detector + mask".
    """

    attribute: str
    value: str
    reason: str

    def to_dict(self) -> dict[str, str]:
        """As in the HTTP answer."""
        return {"attribute": self.attribute, "value": self.value, "reason": self.reason}


@dataclass(frozen=True)
class Resolution:
    """What can be run of a study.

    ``state`` is complete (pipelines and no gap), partial (pipelines and gaps) or none.
    """

    study: str
    state: State
    pipelines: tuple[RunnablePipeline, ...]
    gaps: tuple[Gap, ...]

    def to_dict(self) -> dict[str, object]:
        """As in the HTTP answer."""
        return {
            "key": self.study,
            "state": self.state,
            "pipelines": [pipeline.to_dict() for pipeline in self.pipelines],
            "gaps": [gap.to_dict() for gap in self.gaps],
        }


def resolve(
    study: Study | str,
    architectures: Collection[Architecture] | None = None,
    *,
    catalogue: Catalogue | None = None,
    facts: Facts | None = None,
) -> Resolution:
    """Every runnable pipeline of a study and every gap.

    A pipeline is runnable if its detector gives what its extractor reads (`READOUTS`), its model
    reads what its extractor gives (`kind` in `accepts`), and, where `architectures` is given, its
    (detector, mask) is among them. A value that is in no pipeline is in a gap, unless all there is
    to combine it with is in gaps.

    Parameters
    ----------
    study : Study or str
        A study or its key; InvalidValueError for an unknown key.
    architectures : collection of (detector, mask), optional
        What the caller can simulate; everything if None.
    catalogue, facts : optional
        What is implemented and the studies; ours and the survey's by default.
    """
    known = facts or registered.facts()
    found = known.study(study) if isinstance(study, str) else study
    return _resolve(found, architectures, catalogue or implementations.catalogue())


def resolve_all(
    architectures: Collection[Architecture] | None = None,
    *,
    catalogue: Catalogue | None = None,
    facts: Facts | None = None,
) -> dict[str, Resolution]:
    """`resolve` of every study, by key."""
    known = facts or registered.facts()
    available = catalogue or implementations.catalogue()
    pairs = None if architectures is None else frozenset(architectures)
    return {key: _resolve(study, pairs, available) for key, study in known.studies.items()}


def _resolve(
    study: Study, architectures: Collection[Architecture] | None, catalogue: Catalogue
) -> Resolution:
    gaps = [
        Gap(attribute, "", "the mapping states no value")
        for attribute in ESSENTIAL
        if not study.of(attribute)
    ]
    extractors = _extractor_options(study, catalogue, gaps)
    models = _model_options(study, catalogue, gaps)
    detectors = study.of("detector")
    fitting = {
        detector: [
            (e, m, extractor, model)
            for e in extractors
            for m in models
            for extractor, model in _fitting_pairs(detector, e, m)
        ]
        for detector in detectors
    }
    if detectors and extractors and models:
        gaps += _compatibility_gaps(detectors, extractors, models, fitting)
    pairs = [(d, m) for d in detectors for m in study.of("mask")]
    simulated = [p for p in pairs if architectures is None or p in architectures]
    gaps += _architecture_gaps(pairs, simulated)
    pipelines = tuple(
        RunnablePipeline(
            detector=detector,
            mask=mask,
            extractor=extractor.about.name,
            model=model.about.name,
            extractor_taxonomy=extractor.about.taxonomy,
            model_taxonomy=model.about.taxonomy,
            assumed=MappingProxyType(_assumed(e, m, extractor, model, study.of("model"))),
        )
        for detector, mask in simulated
        for e, m, extractor, model in fitting[detector]
    )
    state: State = "none" if not pipelines else "partial" if gaps else "complete"
    return Resolution(study.key, state, pipelines, tuple(gaps))


@dataclass(frozen=True)
class _ExtractorOption:
    stated: str
    classes: tuple[type[Extractor], ...]


@dataclass(frozen=True)
class _ModelOption:
    stated: str
    classes: tuple[Scored, ...]


_Pair = tuple["type[Extractor]", "Scored"]
_Fitting = Mapping[
    str, Sequence[tuple[_ExtractorOption, _ModelOption, "type[Extractor]", "Scored"]]
]


def _extractor_options(
    study: Study, catalogue: Catalogue, gaps: list[Gap]
) -> list[_ExtractorOption]:
    """Return what implements each extractor of the study; add a gap for each without."""
    options = []
    for stated in study.of("extractor"):
        values = _values_to_run(study, "extractor", stated, SIMPLEST_EXTRACTORS, catalogue)
        classes = tuple(cls for value in values for cls in catalogue.extractors_for(value))
        if classes:
            options.append(_ExtractorOption(stated, classes))
        else:
            gaps.append(_not_implemented("extractor", stated, values))
    return options


def _model_options(study: Study, catalogue: Catalogue, gaps: list[Gap]) -> list[_ModelOption]:
    """Return what implements each model of the study; add a gap for each without."""
    options = []
    for stated in study.of("model"):
        values = _values_to_run(study, "model", stated, SIMPLEST_MODELS, catalogue)
        found = tuple(cls for value in values for cls in catalogue.models_for(value))
        classes = _behind_compensations(found, study.of("model"))
        if classes:
            options.append(_ModelOption(stated, classes))
        else:
            gaps.append(_not_implemented("model", stated, values))
    return options


def _behind_compensations(
    classes: tuple[Scored, ...], stated: Collection[str]
) -> tuple[Scored, ...]:
    """Keep of the chains those with a model that the study states, else with the simplest."""
    for behind in (set(stated), set(SIMPLEST_MODELS)):
        kept = tuple(cls for cls in classes if _model_behind(cls) in behind)
        if kept:
            return kept
    return classes


def _model_behind(cls: Scored) -> str:
    """Taxonomy value of what gives the directions."""
    behind = getattr(cls, "model", None)  # a chain holds one, a model's class does not
    return str((behind or cls).about.taxonomy)


def _values_to_run(
    study: Study, attribute: str, stated: str, simplest: tuple[str, ...], catalogue: Catalogue
) -> tuple[str, ...]:
    """Return the values that stand for one stated; for "None", of those not stated as well."""
    if stated == NO_IMPLEMENTATION_STATED:
        return tuple(value for value in simplest if value not in study.of(attribute))
    return catalogue.taxonomy.kinds(attribute, stated)


def _not_implemented(attribute: str, stated: str, values: tuple[str, ...]) -> Gap:
    if values == (stated,):
        return Gap(attribute, stated, f"no {attribute} implements {stated}")
    return Gap(attribute, stated, f"no {attribute} implements any of {', '.join(values)}")


def _fitting_pairs(
    detector: str, extractors: _ExtractorOption, models: _ModelOption
) -> list[_Pair]:
    """Return the pairs that fit; for "None" only the first that does for each counterpart."""
    fitting = [
        (extractor, model)
        for extractor in extractors.classes
        for model in models.classes
        if _reads(extractor, detector) and extractor.about.kind in model.about.accepts
    ]
    if extractors.stated == NO_IMPLEMENTATION_STATED:
        by_name = {model.about.name: (e, model) for e, model in reversed(fitting)}
        fitting = list(by_name.values())[::-1]
    if models.stated == NO_IMPLEMENTATION_STATED:
        by_name = {e.about.name: (e, model) for e, model in reversed(fitting)}
        fitting = list(by_name.values())[::-1]
        if extractors.stated == NO_IMPLEMENTATION_STATED:
            fitting = fitting[:1]
    return fitting


def _reads(extractor: type[Extractor], detector: str) -> bool:
    return str(extractor.about.observation) in READOUTS.get(detector, ())


def _assumed(
    e: _ExtractorOption,
    m: _ModelOption,
    extractor: type[Extractor],
    model: Scored,
    stated_models: Collection[str],
) -> dict[str, str]:
    assumed: dict[str, str] = {}
    if extractor.about.taxonomy != e.stated:
        assumed["extractor"] = e.stated
    behind = _model_behind(model)
    if model.about.taxonomy != m.stated or (
        behind != model.about.taxonomy and behind not in stated_models
    ):
        assumed["model"] = m.stated
    return assumed


def _compatibility_gaps(
    detectors: Sequence[str],
    extractors: Sequence[_ExtractorOption],
    models: Sequence[_ModelOption],
    fitting: _Fitting,
) -> list[Gap]:
    """Return a gap for every implemented value and every detector that fits nothing."""
    gaps = []
    used_extractors = {row[0].stated for rows in fitting.values() for row in rows}
    used_models = {row[1].stated for rows in fitting.values() for row in rows}
    readable = _join(sorted({r for d in detectors for r in READOUTS.get(d, ())}))
    given = _join(sorted({str(cls.about.kind) for e in extractors for cls in e.classes}))
    read = _join(
        sorted({str(kind) for m in models for cls in m.classes for kind in cls.about.accepts})
    )
    observed = _join(sorted({str(cls.about.observation) for e in extractors for cls in e.classes}))
    for e in extractors:
        if e.stated in used_extractors:
            continue
        if not any(_reads(cls, d) for cls in e.classes for d in detectors):
            reads = _join(sorted({str(cls.about.observation) for cls in e.classes}))
            reason = f"reads {reads}; {_join(detectors)} gives {readable or 'nothing known'}"
        else:
            gives = _join(sorted({str(cls.about.kind) for cls in e.classes}))
            reason = f"gives {gives} features; the study's implemented models read {read}"
        gaps.append(Gap("extractor", e.stated, reason))
    for m in models:
        if m.stated not in used_models:
            reads = _join(sorted({str(kind) for cls in m.classes for kind in cls.about.accepts}))
            reason = (
                f"reads {reads} features; the study's implemented extractors give {given} "
                f"from {observed}, its detectors {readable or 'nothing known'}"
            )
            gaps.append(Gap("model", m.stated, reason))
    for detector in detectors:
        if not fitting[detector]:
            gives = _join(sorted(READOUTS.get(detector, ()))) or "nothing known"
            reason = (
                f"gives {gives}; no implemented extractor of the study that fits one of its "
                f"models reads that (they read {observed})"
            )
            gaps.append(Gap("detector", detector, reason))
    return gaps


def _architecture_gaps(
    pairs: Sequence[Architecture], simulated: Sequence[Architecture]
) -> list[Gap]:
    """Return a gap for every architecture not simulated, unless others show both its parts."""
    shown = {("detector", d) for d, _ in simulated} | {("mask", m) for _, m in simulated}
    return [
        Gap("architecture", f"{detector} + {mask}", "no dataset simulates this architecture")
        for detector, mask in pairs
        if (detector, mask) not in simulated
        and not {("detector", detector), ("mask", mask)} <= shown
    ]


def _join(words: Sequence[str]) -> str:
    return " or ".join(words)
